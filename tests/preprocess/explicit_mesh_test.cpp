// The explicit mesh is closed and manifold and lies on R; its volume and area converge to Steiner's formulas.
#include "preprocess/rounding/explicit_mesh.h"

#include "preprocess/preprocess.h"
#include "tests/oracle/convex_families.h"
#include "tests/oracle/rounded_oracle.h"
#include "tests/support/mesh_of.h"

#include <algorithm>
#include <filesystem>
#include <gtest/gtest.h>

namespace chamfer {
namespace {

struct Totals {
  double volume = 0, area = 0;
};

Totals totals(const ExplicitMesh& mesh) {
  Totals t;
  for (const auto& v : mesh.triangles) {
    const Vector3 a(mesh.positions[v[0]]), b(mesh.positions[v[1]]), c(mesh.positions[v[2]]);
    t.volume += dot(a, cross(b, c)) / 6;
    t.area += length(cross(b - a, c - a)) / 2;
  }
  return t;
}

/// Every directed edge once and its reverse once.
bool closedManifold(const ExplicitMesh& mesh) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k)
      edges.emplace_back(t[k], t[(k + 1) % 3]);
  std::sort(edges.begin(), edges.end());
  return std::adjacent_find(edges.begin(), edges.end()) == edges.end() &&
         std::all_of(edges.begin(), edges.end(), [&](const auto& e) {
           return std::binary_search(edges.begin(), edges.end(), std::pair(e.second, e.first));
         });
}

TEST(ExplicitMesh, ConvergesToSteinersFormulas) {
  for (const auto& solid : oracle::familyCatalogue()) {
    const double inradius = double(oracle::inball(solid).radius);
    for (const double share : {0.2, 0.95}) {
      const oracle::RoundedOracle truth(solid, share * inradius);
      const TriangleMesh mesh = meshOf(solid);
      PreprocessOptions options;
      options.radius.value = share * inradius;
      const auto result = preprocess(mesh, options);
      double coarse[2] = {};
      for (const unsigned segments : {16u, 64u}) {
        const ExplicitMesh rounded = explicitMesh(result.rounding->view(), mesh, segments);
        ASSERT_TRUE(closedManifold(rounded)) << solid.name << " at " << share << " with " << segments;
        const Totals t = totals(rounded);
        const double errors[2] = {std::abs(t.volume / double(truth.volume()) - 1),
                                  std::abs(t.area / double(truth.area()) - 1)};
        for (int k = 0; k < 2; ++k) {
          // Chords converge with the square of the number of segments, 16 times from 16 to 64, less where a
          // corner spans almost half a turn; the area's error may pass through zero on the way.
          if (segments == 64) {
            EXPECT_LT(errors[k], std::max(coarse[k] / 8, 1e-4) + 2e-5)
                << solid.name << " at " << share << (k ? " area" : " volume");
          }
          EXPECT_LT(errors[k], 0.15) << solid.name << " at " << share << " with " << segments;
          coarse[k] = errors[k];
        }
      }
    }
  }
}

TEST(ExplicitMesh, ItsSizeIsKnownWithoutMakingIt) {
  for (const auto& solid : oracle::familyCatalogue())
    for (const double share : {0.1, 0.95}) { // at 0.95 whole facets have vanished
      const TriangleMesh mesh = meshOf(solid);
      PreprocessOptions options;
      options.radius.value = share * double(oracle::inball(solid).radius);
      const auto result = preprocess(mesh, options);
      const ExplicitMeshSize size(result.rounding->view());
      for (const unsigned segments : {1u, 2u, 7u}) {
        const ExplicitMesh made = explicitMesh(result.rounding->view(), mesh, segments);
        EXPECT_EQ(made.triangles.size(), size.triangles(segments)) << solid.name << " at " << share;
        EXPECT_EQ(made.features.size(), made.triangles.size());
      }
    }
}

TEST(ExplicitMesh, VerticesLieOnTheRoundedSolidWithItsNormals) {
  const auto solid = oracle::hullOnSphere(40, 7);
  const double r = 0.4 * double(oracle::inball(solid).radius);
  const oracle::RoundedOracle truth(solid, r);
  PreprocessOptions options;
  options.radius.value = r;
  const TriangleMesh mesh = meshOf(solid);
  const ExplicitMesh rounded = explicitMesh(preprocess(mesh, options).rounding->view(), mesh, 3);
  for (std::size_t i = 0; i < rounded.positions.size(); ++i) {
    const Point3& p = rounded.positions[i];
    const auto near = truth.nearest(oracle::Vec3(p.x, p.y, p.z));
    EXPECT_NEAR(double(near.distance), r, 1e-6);
    const Vector3& n = rounded.normals[i];
    EXPECT_GT(double(near.normal.dot(oracle::Vec3(n.x, n.y, n.z))), 1 - 1e-6);
  }
}

TEST(ExplicitMesh, OfTheReportedBoxLiesOnItsRoundingWithAnyNumberOfSegments) {
  const std::filesystem::path file = CHAMFER_SOURCE_DIR "/../shared/data/reports/rounded-box-mesh/box.obj";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "the reports are not beside the project";
  const TriangleMesh mesh = readMesh(file); // 10 x 20 x 3 from the origin
  PreprocessOptions options;
  options.radius.value = 1;
  const auto result = preprocess(mesh, options);
  constexpr double kSize[3] = {10, 20, 3};
  for (const unsigned segments : {1u, 2u, 6u, 7u}) {
    const ExplicitMesh rounded = explicitMesh(result.rounding->view(), mesh, segments);
    EXPECT_TRUE(closedManifold(rounded)) << segments;
    for (std::size_t i = 0; i < rounded.positions.size(); ++i) {
      // The nearest point of the box that is 1 smaller on each side.
      Vector3 out;
      for (int axis = 0; axis < 3; ++axis)
        out[axis] = rounded.positions[i][axis] - std::clamp(rounded.positions[i][axis], 1.0, kSize[axis] - 1);
      EXPECT_NEAR(length(out), 1, 1e-6) << segments;
      EXPECT_GT(dot(rounded.normals[i], out), 1 - 1e-6) << segments;
    }
  }
}

} // namespace
} // namespace chamfer
