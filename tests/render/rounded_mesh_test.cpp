// rounding=mesh:K against the exact rounding: the same surface, materials and texture coordinates.
#include "server/render/surface/rounded_mesh.h"

#include "common/error.h"
#include "server/render/path/prepared_scene.h"
#include "tests/oracle/convex_families.h"
#include "tests/render/direction_chi_squared.h"
#include "tests/render/scene_files_fixture.h"
#include "tests/support/mesh_of.h"

#include <gmock/gmock.h>

namespace chamfer {
namespace {

using test::loadText;
using test::TemporaryFolder;
using test::thrownBy;

/// Rays from all around towards the scene's middle.
std::vector<Ray> raysAt(const Bounds3& bounds, int count) {
  test::UniformNumbers u(5);
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    const Point3 eye = bounds.centre() + Vector3(u.direction()) * bounds.diagonal();
    const Point3 target = bounds.centre() + Vector3(u.direction()) * (0.4 * bounds.diagonal() * double(u()));
    rays.push_back({eye, normalize(target - eye)});
  }
  return rays;
}

TEST(RoundedMesh, AgreesWithTheExactRoundingUnderAnyTransform) {
  const TemporaryFolder folder;
  const auto scene = loadText(folder, R"({"meshes":[{"name":"cube","file":"cube.obj","radius":0.2},
    {"name":"floor","file":"floor.obj"}],"instances":[{"mesh":"floor"},{"mesh":"cube"},
    {"mesh":"cube","scale":[1,-2,0.7],"rotate":{"axis":[1,2,3],"degrees":40},"translate":[3,0,1]}]})");
  const auto exact = prepare(scene, {}), mesh = prepare(scene, {RoundingMode::Mesh, 64, {}});
  // The largest triangles of a sphere's grid lie twice as deep below it as a chord; stretched by the scale.
  const double tolerance = 2 * 2 * 0.2 * (1 - std::cos(std::numbers::pi / 4 / 64));
  int hits = 0, rounded = 0, parted = 0;
  for (const Ray& ray : raysAt({{-1, -1, -0.5}, {4, 1, 2}}, 60000)) {
    const auto a = exact->tracer().intersect(ray), b = mesh->tracer().intersect(ray);
    if (a.has_value() != b.has_value() || (a && a->instance != b->instance)) {
      ++parted; // at silhouettes
      continue;
    }
    if (!a) continue;
    const double cosine = std::abs(dot(a->normal, ray.direction));
    if (cosine < 0.1) continue; // grazing: a small step aside is a long way along the ray
    ++hits;
    const SurfacePlace place = mesh->surfaces().place(*b);
    ASSERT_NEAR(a->t, b->t, tolerance / cosine + 1e-5);
    const Vector3 n = mesh->surfaces().shadingNormal(*b, place, Sampler(0, 0, 0, 0), 0).normal;
    ASSERT_NEAR(length(n), 1, 1e-9);
    ASSERT_LT(length(n - a->normal), 0.03) << "instance " << a->instance;
    ASSERT_GT(dot(n, b->normal), 0.999);
    rounded += place.rounded();
    // Along their borders chord and arc fall on different sides of the feature's border.
    if (place.feature != a->feature) ++parted;
  }
  EXPECT_GT(rounded, 3000);
  EXPECT_LT(parted, hits / 50);
}

TEST(RoundedMesh, KeepsMaterialsAndTextureCoordinatesOfTheOriginal) {
  const TemporaryFolder folder;
  // A facet of two triangles of different materials, mapped as one square of the texture plane.
  folder.write("m.mtl", "newmtl a\nKd 0.2 0.2 0.2\nnewmtl b\nKd 0.6 0.6 0.6\n");
  std::string obj = "mtllib m.mtl\n" + test::cubeObj();
  const std::string top = "f 5 6 8 7\n";
  const std::size_t at = obj.find(top);
  ASSERT_NE(at, std::string::npos);
  obj.replace(at, top.size(),
              "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl a\nf 5/1 6/2 8/3\nusemtl b\nf 5/1 8/3 7/4\nusemtl a\n");
  folder.write("two.obj", obj);
  const auto scene = loadText(
      folder, R"({"meshes":[{"name":"m","file":"two.obj","radius":0.1}],"instances":[{"mesh":"m"}]})");
  for (const RoundingChoice& choice : {RoundingChoice{}, RoundingChoice{RoundingMode::Mesh, 5, {}},
                                       RoundingChoice{RoundingMode::Bevel, 2, {}}}) {
    const auto prepared = prepare(scene, choice);
    test::UniformNumbers u(3);
    for (int i = 0; i < 2000; ++i) {
      const double x = double(u()) * 0.98 - 0.49, y = double(u()) * 0.98 - 0.49;
      const auto hit = prepared->tracer().intersect({{x, y, 3}, {0, 0, -1}});
      if (!hit) continue;
      const SurfacePlace place = prepared->surfaces().place(*hit);
      const Vector3 n = prepared->surfaces().shadingNormal(*hit, place, Sampler(0, 0, 0, 0), 0).smooth;
      if (n.z < 0.71 || std::abs(x - y) < 1e-4) continue; // beyond half of a rounding: another facet's
      // Triangles of `two.obj`: the first facet's two, then the two of the top.
      ASSERT_EQ(place.original.triangle, x > y ? 2u : 3u) << x << " " << y;
      ASSERT_EQ(place.material->name, x > y ? "a" : "b");
      const float u1 = place.original.u, v1 = place.original.v;
      const float s = x > y ? u1 + v1 : u1, t = x > y ? v1 : u1 + v1;
      ASSERT_NEAR(double(s), x + 0.5, 1e-5) << "looked at from above, the texture lies as on the sharp cube";
      ASSERT_NEAR(double(t), y + 0.5, 1e-5);
      // Of the explicit mesh, what lies on the top has two materials, and none to aim at by.
      const Material* ofAll = prepared->surfaces().materialOfAll(0, hit->triangle);
      ASSERT_EQ(ofAll, choice.mode == RoundingMode::Mesh ? nullptr : place.material);
    }
  }
}

TEST(RoundedMesh, AnEmitterIsAimedAtThroughItsTriangles) {
  const TemporaryFolder folder;
  const auto scene = loadText(folder, R"({"meshes":[{"name":"cube","file":"cube.obj","radius":0.2}],
    "materials":[{"name":"glow","emission":2}],"instances":[{"mesh":"cube","material":"glow","scale":[1,-1,1]}],
    "lights":[{"type":"environment","color":0}]})");
  const auto prepared = prepare(scene, {RoundingMode::Mesh, 4, {}});
  const std::uint32_t triangles = std::uint32_t(prepared->surfaces().tracedMesh(0).triangles.size());
  EXPECT_EQ(tracedTriangles(*prepared), 12u + 12 * 2 * 4 + 8 * 16);
  EXPECT_EQ(triangles, tracedTriangles(*prepared));
  for (std::uint32_t t = 0; t < triangles; ++t)
    ASSERT_EQ(prepared->surfaces().materialOfAll(0, t)->name, "glow");
  int aimed = 0;
  test::UniformNumbers u(8);
  for (int i = 0; i < 1000; ++i) { // what is aimed at is found by a ray, with the same density
    const Point3 p(0.2, -0.3, 3);
    const float choice = u();
    const LightSample s = prepared->lights().sample(p, choice, u.pair());
    if (!(s.pdf > 0)) continue;
    const Ray ray{p, normalize(s.toLight)};
    const auto hit = prepared->tracer().intersect(ray);
    if (!hit) continue;                                        // past a silhouette, by rounding
    if (std::abs(hit->t - length(s.toLight)) > 1e-4) continue; // another triangle hides it
    ++aimed;
    ASSERT_NEAR(prepared->lights().foundPdf(*hit, ray), s.pdf, 1e-3f * s.pdf);
  }
  EXPECT_GT(aimed, 200);
}

TEST(RoundedMesh, TooManySegmentsAreRefusedWithTheLargestNumberThatWorks) {
  std::vector<std::shared_ptr<const Rounding>> roundings;
  for (int i = 0; i < 600; ++i) { // 8 corners of 256 x 256 triangles each, and 12 edges
    PreprocessOptions options;
    options.radius.value = 0.1;
    roundings.push_back(preprocess(meshOf(oracle::box(1, 1, 1)), options).rounding);
  }
  const auto text = thrownBy([&] { explicitBytes(roundings, 256, UINT64_MAX); });
  EXPECT_THAT(text,
              testing::StartsWith("out-of-range: rounding \"mesh:256\" would make 318266400 triangles"));
  EXPECT_THAT(text, testing::HasSubstr("use mesh:56 or fewer"));
  EXPECT_EQ(thrownBy([&] { explicitBytes(roundings, 56, UINT64_MAX); }), "nothing");
  EXPECT_THAT(thrownBy([&] { explicitBytes(roundings, 57, UINT64_MAX); }),
              testing::StartsWith("out-of-range: "));
  roundings.assign(600, roundings[0]); // one rounding for all is made once
  EXPECT_EQ(thrownBy([&] { explicitBytes(roundings, 256, UINT64_MAX); }), "nothing");
}

} // namespace
} // namespace chamfer
