// What preparing many small solids costs, stage by stage, and how it grows: boxes and prisms, about 14
// triangles a solid, file reading excluded. Prints the median of several runs for each size, and the slope
// over the sizes (1 is linear). `--single N` measures one solid of about N facets instead.
#include "preprocess/preprocess.h"
#include "tests/oracle/convex_families.h"
#include "tests/support/mesh_of.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

namespace {

using namespace chamfer;

/// `triangles` in all: boxes (12) and, every fourth solid, a hexagonal prism (20), side by side on a grid.
TriangleMesh manySolids(std::size_t triangles) {
  const TriangleMesh kinds[2] = {meshOf(oracle::box(1, 0.8, 0.4)), meshOf(oracle::prism(6, 0.7))};
  TriangleMesh mesh;
  const auto side = std::size_t(std::ceil(std::sqrt(double(triangles) / 14)));
  for (std::size_t i = 0; mesh.triangles.size() < triangles; ++i) {
    const TriangleMesh& kind = kinds[i % 4 == 3];
    const Vector3 at{3.0 * double(i % side), 3.0 * double(i / side), 0};
    const auto base = std::uint32_t(mesh.positions.size());
    for (const Point3& p : kind.positions)
      mesh.positions.push_back(p + at);
    for (const auto& t : kind.triangles)
      mesh.triangles.push_back({base + t[0], base + t[1], base + t[2]});
  }
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    mesh.faceOfTriangle.push_back(t);
  return mesh;
}

/// A sphere of rings of quadrilaterals, each a facet: strictly convex, simple at no vertex.
TriangleMesh facetedBall(std::size_t facets) {
  const auto rings = std::size_t(std::sqrt(double(facets) / 2)), sides = 2 * rings;
  TriangleMesh mesh;
  mesh.positions.push_back({0, 0, 1});
  for (std::size_t i = 1; i < rings; ++i)
    for (std::size_t j = 0; j < sides; ++j) {
      const double polar = M_PI * double(i) / double(rings), around = 2 * M_PI * double(j) / double(sides);
      mesh.positions.push_back(
          {std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around), std::cos(polar)});
    }
  mesh.positions.push_back({0, 0, -1});
  const auto last = std::uint32_t(mesh.positions.size() - 1), n = std::uint32_t(sides);
  for (std::uint32_t j = 0; j < n; ++j) {
    const std::uint32_t k = (j + 1) % n;
    mesh.triangles.push_back({0, 1 + j, 1 + k});
    for (std::uint32_t i = 0; i + 2 < rings; ++i) {
      const std::uint32_t a = 1 + i * n + j, b = 1 + i * n + k, c = a + n, d = b + n;
      mesh.triangles.push_back({a, c, d});
      mesh.triangles.push_back({a, d, b});
    }
    mesh.triangles.push_back({last, last - n + k, last - n + j});
  }
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    mesh.faceOfTriangle.push_back(t);
  return mesh;
}

struct Run {
  double seconds;
  PreprocessReport report;
  std::size_t bytes;
};

Run median(const TriangleMesh& mesh, const PreprocessOptions& options, unsigned runs) {
  std::vector<Run> all;
  for (unsigned i = 0; i < runs; ++i) {
    const auto start = std::chrono::steady_clock::now();
    const PreprocessResult result = preprocess(mesh, options);
    all.push_back({std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
                   result.report, serializedSize(*result.rounding)});
  }
  std::nth_element(all.begin(), all.begin() + runs / 2, all.end(),
                   [](const Run& a, const Run& b) { return a.seconds < b.seconds; });
  return all[runs / 2];
}

void print(std::size_t triangles, const Run& r) {
  const StageTimes& t = r.report.times;
  std::printf("%10zu %9zu %9.4f   %9.4f %9.4f %9.4f %9.4f %9.4f %9.4f   %6.1f\n", triangles, r.report.solids,
              r.seconds, t.components, t.facets, t.convexity, t.core, t.detection, t.pack,
              double(r.bytes) / double(r.report.roundedEdges));
}

} // namespace

int main(int argc, char** argv) {
  std::vector<std::size_t> sizes{27600, 276000, 2760000};
  std::size_t single = 0;
  unsigned runs = 5;
  PreprocessOptions options;
  options.radius.value = 0.05;
  CLI::App app{"Times chamferprep's stages on many small solids, or on one large one."};
  app.add_option("--triangles", sizes, "Triangles in all, several sizes")->capture_default_str();
  app.add_option("--single", single, "Facets of one solid, instead of many small ones");
  app.add_option("--runs", runs, "Runs of each size; the median is printed")->capture_default_str();
  app.add_option("--radius", options.radius.value, "Radius in mesh units")->capture_default_str();
  app.add_option("-j,--threads", options.threads, "Threads (0: all)")->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  std::printf("%10s %9s %9s   %9s %9s %9s %9s %9s %9s   %6s\n", "triangles", "solids", "seconds", "component",
              "facets", "convexity", "core", "detection", "pack", "B/edge");
  std::puts("(stages but the first and the last in seconds summed over threads)");
  if (single > 0) {
    const TriangleMesh mesh = facetedBall(single);
    print(mesh.triangles.size(), median(mesh, options, runs));
    return 0;
  }
  std::vector<std::pair<double, double>> points;
  for (const std::size_t size : sizes) {
    const TriangleMesh mesh = manySolids(size);
    const Run r = median(mesh, options, runs);
    print(mesh.triangles.size(), r);
    points.emplace_back(std::log(double(mesh.triangles.size())), std::log(r.seconds));
  }
  for (std::size_t i = 1; i < points.size(); ++i)
    std::printf("slope %.2f\n",
                (points[i].second - points[i - 1].second) / (points[i].first - points[i - 1].first));
  return 0;
}
