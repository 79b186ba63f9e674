// Solids that are rounded as their convex hulls are traced as their hulls: from a sidecar, from a scene file,
// with another radius and in every rounding.
#include "tests/render/scene_files_fixture.h"

#include <gmock/gmock.h>

namespace chamfer {
namespace {

using test::TemporaryFolder;
using test::thrownBy;
using testing::StartsWith;

/// An L whose hull closes the notch with a facet from (3, 1) to (1, 3).
constexpr char kPrism[] = "v 0 0 0\nv 3 0 0\nv 3 1 0\nv 1 1 0\nv 1 3 0\nv 0 3 0\n"
                          "v 0 0 1\nv 3 0 1\nv 3 1 1\nv 1 1 1\nv 1 3 1\nv 0 3 1\n"
                          "f 1 4 3 2\nf 1 6 5 4\nf 7 8 9 10\nf 7 10 11 12\n"
                          "f 1 2 8 7\nf 2 3 9 8\nf 3 4 10 9\nf 4 5 11 10\nf 5 6 12 11\nf 6 1 7 12\n";

/// Distances at which rays from 5 in front of the facet over the notch, and from above the notch, meet the
/// scene.
void expectHull(const std::shared_ptr<const Scene>& scene, const RoundingChoice& choice) {
  const auto prepared = prepare(scene, choice);
  const double s = std::sqrt(0.5);
  for (const double along : {-0.7, 0.0, 0.7})
    for (const double z : {0.3, 0.5, 0.7}) {
      const Point3 from = Point3(2 + along * s, 2 - along * s, z) + Vector3(5 * s, 5 * s, 0);
      const auto hit = ownTracer(*prepared).intersect({from, {-s, -s, 0}});
      ASSERT_TRUE(hit);
      EXPECT_NEAR(hit->t, 5, 1e-5);
    }
  for (const double x : {1.2, 1.5})
    for (const double z : {-4.0, 5.0}) {
      const auto hit = ownTracer(*prepared).intersect({{x, 1.6, z}, {0, 0, z < 0 ? 1.0 : -1.0}});
      ASSERT_TRUE(hit);
      EXPECT_NEAR(hit->t, 4, 1e-5);
    }
}

void expectHullInEveryRounding(const std::shared_ptr<const Scene>& scene) {
  expectHull(scene, {});
  expectHull(scene, {RoundingMode::Analytic, 0, 0.2});
  expectHull(scene, {RoundingMode::None, 0, {}});
  expectHull(scene, {RoundingMode::Mesh, 3, 0.15});
  expectHull(scene, {RoundingMode::Bevel, 4, 0.1});
}

std::string sceneText(const std::string& more) {
  return R"({"meshes":[{"name":"m","file":"l.obj")" + more + R"(}],"instances":[{"mesh":"m"}]})";
}

void writeHulledSidecar(const TemporaryFolder& folder) {
  PreprocessOptions options;
  options.radius = {0.1, false};
  options.onNonConvex = OnNonConvex::Hull;
  writeSidecar(folder.path() / "l.obj.chamfer",
               *preprocess(readMesh(folder.path() / "l.obj"), options).rounding);
}

TEST(HulledScene, ASceneFileThatAsksForHulls) {
  const TemporaryFolder folder;
  folder.write("l.obj", kPrism);
  expectHullInEveryRounding(test::loadText(folder, sceneText(R"(,"radius":0.1,"on_nonconvex":"hull")")));
}

TEST(HulledScene, ASidecarOfTheHull) {
  const TemporaryFolder folder;
  folder.write("l.obj", kPrism);
  writeHulledSidecar(folder);
  const auto scene = loadScene(folder.path() / "l.obj", folder.path(), "l");
  EXPECT_NEAR(scene->meshes[0].radius, 0.1, 1e-6);
  EXPECT_EQ(scene->meshes[0].mesh->triangles.size(),
            scene->meshes[0].rounding->view().facetOfTriangle.size());
  expectHullInEveryRounding(scene);
  // A scene file takes the sidecar as it is, and without looking at it for another radius.
  expectHullInEveryRounding(test::loadText(folder, sceneText("")));
  expectHullInEveryRounding(test::loadText(folder, sceneText(R"(,"radius":0.05,"on_nonconvex":"hull")")));
}

TEST(HulledScene, ASidecarOfAnotherMeshIsStaleAllTheSame) {
  const TemporaryFolder folder;
  folder.write("l.obj", kPrism);
  writeHulledSidecar(folder);
  std::string other = kPrism;
  other.replace(other.find("v 1 1 0"), 7, "v 1 2 0"); // still no convex solid
  folder.write("l.obj", other);
  EXPECT_THAT(thrownBy([&] { loadScene(folder.path() / "l.obj", folder.path(), "l"); }),
              StartsWith("stale-sidecar: "));
}

} // namespace
} // namespace chamfer
