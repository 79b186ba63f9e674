// What the rounding costs in ray queries alone, without shading, and what its structures bring.
//
// rays/*: 22,500 boxes in one mesh, seen from above. Every pixel costs a camera ray and, from where that
// hits, a ray in a random direction and a shadow ray. The variants change the rounding only: none, analytic,
// explicit meshes of 1, 3 and 10 segments. zone/*: the zone test of points on the cap of a prism of N sides,
// by the kd-tree over the cap's detection cylinders and by going through all of them.
//
// Google Benchmark's options apply; unless told otherwise the variants are interleaved at random and
// repeated, and medians are to be compared.
#include "common/core_view.h"
#include "preprocess/preprocess.h"
#include "preprocess/rounding/explicit_mesh.h"
#include "server/render/tracing/tracer.h"
#include "tests/oracle/convex_families.h"
#include "tests/support/mesh_of.h"

#include <benchmark/benchmark.h>
#include <memory>
#include <random>

namespace {

using namespace chamfer;

constexpr int kSide = 150; ///< boxes along each side of the field
constexpr double kRadius = 0.028;
constexpr unsigned kWidth = 480, kHeight = 320;

TriangleMesh boxField() {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> size(0.6, 0.9), height(0.4, 1.4);
  TriangleMesh field;
  for (int i = 0; i < kSide * kSide; ++i) {
    const TriangleMesh box = meshOf(oracle::box(size(random), size(random), height(random)));
    const auto base = std::uint32_t(field.positions.size());
    for (const Point3& p : box.positions)
      field.positions.push_back(p + Vector3{double(i % kSide), double(i / kSide), 0});
    for (const auto& t : box.triangles)
      field.triangles.push_back({base + t[0], base + t[1], base + t[2]});
  }
  for (std::uint32_t t = 0; t < field.triangles.size(); ++t)
    field.faceOfTriangle.push_back(t);
  return field;
}

const TriangleMesh& field() {
  static const TriangleMesh mesh = boxField();
  return mesh;
}

const std::shared_ptr<const Rounding>& rounding() {
  static const std::shared_ptr<const Rounding> made = [] {
    PreprocessOptions options;
    options.radius = {kRadius, false};
    return preprocess(field(), options).rounding;
  }();
  return made;
}

TracedInstance sharp(TriangleMesh mesh) {
  return {makeTracedMesh(std::make_shared<const TriangleMesh>(std::move(mesh))), nullptr, {}};
}

TracedInstance analytic() {
  TracedInstance instance = sharp(field());
  instance.rounding = rounding();
  return instance;
}

TracedInstance explicitly(unsigned segments) {
  ExplicitMesh e = explicitMesh(rounding()->view(), field(), segments);
  TriangleMesh mesh;
  mesh.positions = std::move(e.positions);
  mesh.triangles = std::move(e.triangles);
  return sharp(std::move(mesh));
}

/// One ray of a pinhole over the field's corner a pixel, and what its path needs of randomness.
struct Pixel {
  Ray ray;
  Vector3 unit; ///< uniform on the sphere
};

const std::vector<Pixel>& pixels() {
  static const std::vector<Pixel> made = [] {
    std::mt19937 random(11);
    std::normal_distribution<double> gauss;
    const Point3 eye{-0.05 * kSide, -0.05 * kSide, 0.16 * kSide};
    const Vector3 forward = normalize(Point3(0.3 * kSide, 0.3 * kSide, 0) - eye);
    const Vector3 right = normalize(cross(forward, Vector3(0, 0, 1))), up = cross(right, forward);
    std::vector<Pixel> list;
    for (unsigned y = 0; y < kHeight; ++y)
      for (unsigned x = 0; x < kWidth; ++x) {
        const double u = (x + 0.5) / kHeight - 0.5 * kWidth / kHeight, v = 0.5 - (y + 0.5) / kHeight;
        list.push_back({{eye, normalize(forward + right * (0.7 * u) + up * (0.7 * v))},
                        normalize(Vector3(gauss(random), gauss(random), gauss(random)))});
      }
    return list;
  }();
  return made;
}

void traceField(benchmark::State& state, TracedInstance (*make)(unsigned), unsigned segments) {
  const TracedInstance instance = make(segments);
  const auto tracer = makeTracer({instance});
  const Vector3 toLight = normalize(Vector3(-0.4, 0.2, 0.8));
  std::size_t rays = 0, hits = 0, rounded = 0;
  const auto count = [&](const std::optional<TraceHit>& hit) {
    ++rays;
    if (!hit) return;
    ++hits;
    rounded += hit->rounded();
  };
  const PathState eye;
  Arrival arrival;
  for (auto _ : state)
    for (const Pixel& p : pixels()) {
      const auto hit = tracer->intersect(p.ray, eye, 0, INFINITY, &arrival);
      count(hit);
      if (!hit) continue;
      const Vector3 bounce = normalize(hit->normal + p.unit * 0.999); // cosine-weighted
      count(tracer->intersect({hit->position, bounce}, arrival.state));
      ++rays;
      if (dot(toLight, hit->normal) > 0)
        benchmark::DoNotOptimize(tracer->occluded({hit->position, toLight}, arrival.state));
    }
  state.SetItemsProcessed(std::int64_t(rays));
  state.counters["rounded"] = hits ? double(rounded) / double(hits) : 0;
  state.counters["bytes"] = double(tracer->memoryBytes());
}

TriangleMesh prism(std::uint32_t sides) {
  TriangleMesh mesh;
  for (const double z : {-0.5, 0.5})
    for (std::uint32_t i = 0; i < sides; ++i)
      mesh.positions.push_back({std::cos(2 * M_PI * i / sides), std::sin(2 * M_PI * i / sides), z});
  for (std::uint32_t i = 0; i < sides; ++i) {
    const std::uint32_t j = (i + 1) % sides;
    mesh.triangles.push_back({i, j, sides + j});
    mesh.triangles.push_back({i, sides + j, sides + i});
    if (i > 0 && j > 0) {
      mesh.triangles.push_back({0, j, i});
      mesh.triangles.push_back({sides, sides + i, sides + j});
    }
  }
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    mesh.faceOfTriangle.push_back(t);
  return mesh;
}

/// A prism and points spread over its upper cap, most of them near the border, in the solid's frame.
struct Cap {
  explicit Cap(int sides) {
    PreprocessOptions options;
    options.radius = {0.3 * M_PI / sides, false};
    rounding = preprocess(prism(std::uint32_t(sides)), options).rounding;
    const RoundingView& view = rounding->view();
    while (view.facets[facet].normal.z < 0.9f)
      ++facet;
    std::mt19937 random(5);
    std::uniform_real_distribution<double> share(0, 1);
    for (int i = 0; i < 4096; ++i) {
      const double angle = 2 * M_PI * share(random), radius = std::sqrt(std::sqrt(share(random)));
      points.push_back(
          {radius * std::cos(angle), radius * std::sin(angle), double(view.facets[facet].offset)});
    }
  }
  std::shared_ptr<const Rounding> rounding;
  std::uint32_t facet = 0;
  std::vector<Point3> points;
};

void zoneByTree(benchmark::State& state) {
  const Cap cap(int(state.range(0)));
  const RoundingView& view = cap.rounding->view();
  for (auto _ : state)
    for (const Point3& p : cap.points)
      benchmark::DoNotOptimize(detect(view, 0, cap.facet, p));
  state.SetItemsProcessed(state.iterations() * std::int64_t(cap.points.size()));
}

void zoneByLoop(benchmark::State& state) {
  const Cap cap(int(state.range(0)));
  const RoundingView& view = cap.rounding->view();
  const CoreView core(view, 0);
  for (auto _ : state)
    for (const Point3& p : cap.points) {
      CoreFeature feature(CoreFeature::Face, view.facets[cap.facet].firstHalfEdge());
      benchmark::DoNotOptimize(core.inCell(feature, Vector3(p)));
    }
  state.SetItemsProcessed(state.iterations() * std::int64_t(cap.points.size()));
}

} // namespace

int main(int argc, char** argv) {
  const auto none = [](unsigned) { return sharp(field()); };
  const auto rounded = [](unsigned) { return analytic(); };
  benchmark::RegisterBenchmark("rays/none", traceField, none, 0u);
  benchmark::RegisterBenchmark("rays/analytic", traceField, rounded, 0u);
  for (const unsigned segments : {1u, 3u, 10u})
    benchmark::RegisterBenchmark(("rays/mesh:" + std::to_string(segments)).c_str(), traceField, &explicitly,
                                 segments);
  benchmark::RegisterBenchmark("zone/tree", zoneByTree)->RangeMultiplier(4)->Range(8, 2048);
  benchmark::RegisterBenchmark("zone/loop", zoneByLoop)->RangeMultiplier(4)->Range(8, 2048);
  std::vector<char*> arguments(argv, argv + argc);
  std::string defaults[] = {"--benchmark_enable_random_interleaving=true", "--benchmark_repetitions=7",
                            "--benchmark_report_aggregates_only=true", "--benchmark_min_time=0.3"};
  // Before the caller's own, which win.
  for (std::string& d : defaults)
    arguments.insert(arguments.begin() + 1, d.data());
  int count = int(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 2;
  benchmark::RunSpecifiedBenchmarks();
}
