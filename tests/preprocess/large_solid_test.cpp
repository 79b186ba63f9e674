// One solid of many triangles, nearly convex: the same judgement as by comparing everything with everything,
// in near linear time, with progress, to be cancelled.
#include "preprocess/preprocess.h"
#include "preprocess/rounding/plane_tree.h"
#include "tests/oracle/random.h"

#include <ctime>
#include <gtest/gtest.h>
#include <map>

namespace chamfer {
namespace {

/// A cube's faces in n x n squares each, blown up to a sphere, coordinates rounded to multiples of `grid` as
/// text files do: 12 n^2 triangles, many of them a little below their neighbours.
TriangleMesh roundedSphere(int n, double grid) {
  TriangleMesh mesh;
  std::map<std::array<int, 3>, std::uint32_t> vertices;
  const auto vertex = [&](const std::array<int, 3>& p) {
    const auto [entry, added] = vertices.try_emplace(p, std::uint32_t(mesh.positions.size()));
    if (added) {
      Vector3 v;
      for (std::size_t k = 0; k < 3; ++k)
        v[k] = std::tan(0.7853981633974483 * (2.0 * p[k] / n - 1)); // squares of about one size
      v = normalize(v);
      mesh.positions.push_back(
          {std::round(v.x / grid) * grid, std::round(v.y / grid) * grid, std::round(v.z / grid) * grid});
    }
    return entry->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const int side : {0, n})
      for (int i = 0; i < n; ++i)
        for (int k = 0; k < n; ++k) {
          const auto at = [&](int u, int v) {
            std::array<int, 3> p{};
            p[axis] = side;
            p[(axis + 1) % 3] = u;
            p[(axis + 2) % 3] = v;
            return vertex(p);
          };
          std::array<std::uint32_t, 4> q{at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)};
          if (side == 0) std::swap(q[1], q[3]);
          mesh.triangles.push_back({q[0], q[1], q[2]});
          mesh.triangles.push_back({q[0], q[2], q[3]});
        }
  return mesh;
}

/// Roughness in proportion to how far an edge's middle lies below the sphere.
double gridFor(int n) { return 1.2 / (double(n) * n); }

PreprocessOptions options() {
  PreprocessOptions o;
  o.radius.value = 0.05;
  o.threads = 1;
  o.tolerances.convexity = 0.01;
  return o;
}

TEST(PlaneTree, FindsWhatLookingAtAllPlanesFinds) {
  oracle::Random random(4);
  for (const double spread : {0.0, 0.01, 0.5}) {
    std::vector<Plane> planes;
    std::vector<Vector3> places;
    for (int i = 0; i < 3000; ++i) {
      const auto d = random.direction();
      const Vector3 n = i % 10 == 9 ? planes.back().normal : Vector3(d.x(), d.y(), 0.5 * d.z());
      planes.push_back({normalize(n), 1 + spread * random.uniform()});
      places.push_back(planes.back().normal * planes.back().offset);
    }
    const PlaneTree tree(planes, places);
    for (int i = 0; i < 3000; ++i) {
      std::array<Vector3, 3> points;
      const auto d = random.direction() * random.uniform(0, 1.2);
      for (Vector3& p : points) {
        const auto e = random.direction() * random.logUniform(1e-6, 0.1);
        p = {d.x() + e.x(), d.y() + e.y(), d.z() + e.z()};
      }
      const std::size_t count = 1 + random.below(3);
      PlaneTree::Nearest truth{0, INFINITY};
      for (std::uint32_t k = 0; k < planes.size(); ++k) {
        double deepest = 0;
        for (std::size_t m = 0; m < count; ++m)
          deepest = std::max(deepest, planes[k].offset - dot(planes[k].normal, points[m]));
        if (deepest < truth.depth) truth = {k, deepest};
      }
      const PlaneTree::Nearest found = tree.nearest(std::span(points).first(count));
      ASSERT_EQ(found.plane, truth.plane);
      ASSERT_EQ(found.depth, truth.depth);
    }
  }
}

TEST(LargeSolid, TimeGrowsWithItsTrianglesNotTheirSquare) {
  const auto seconds = [](int n) {
    const TriangleMesh mesh = roundedSphere(n, gridFor(n));
    const std::clock_t start = std::clock();
    const PreprocessResult result = preprocess(mesh, options());
    EXPECT_GT(result.report.nonConvexity, 0.01 * gridFor(n)); // the rounding did dent it
    EXPECT_EQ(result.report.solids, 1u);
    return double(std::clock() - start) / CLOCKS_PER_SEC;
  };
  seconds(20);
  const double small = seconds(40), large = seconds(80);              // 19,200 and 76,800 triangles
  EXPECT_LT(large, 9 * small) << small << " s and " << large << " s"; // linear 4, quadratic 16
}

TEST(LargeSolid, ReportsProgressWithinOneSolid) {
  const TriangleMesh mesh = roundedSphere(60, gridFor(60));
  std::map<std::string, std::vector<double>> shares;
  PreprocessOptions o = options();
  o.progress = [&](const char* stage, double share) { shares[stage].push_back(share); };
  preprocess(mesh, o);
  for (const char* stage : {"convexity", "core", "detection"}) {
    SCOPED_TRACE(stage);
    EXPECT_GE(shares[stage].size(), 3u);
    EXPECT_TRUE(std::is_sorted(shares[stage].begin(), shares[stage].end()));
    for (const double share : shares[stage]) {
      EXPECT_GE(share, 0);
      EXPECT_LE(share, 1);
    }
  }
  EXPECT_GE(shares["convexity"].size(), 10u);
}

TEST(LargeSolid, IsCancelledInAnyOfItsStages) {
  struct Stop {};
  const TriangleMesh mesh = roundedSphere(60, gridFor(60));
  for (const char* wanted : {"convexity", "core", "detection"}) {
    int calls = 0;
    PreprocessOptions o = options();
    o.progress = [&](const char* stage, double) {
      if (std::string(stage) == wanted && ++calls == 2) throw Stop{};
    };
    EXPECT_THROW(preprocess(mesh, o), Stop) << wanted;
    EXPECT_EQ(calls, 2) << wanted;
  }
}

} // namespace
} // namespace chamfer
