// What shading normals may do to light, and where they come from: bevels and normal textures.
#include "server/render/surface/shading_normal.h"

#include "server/render/image/image_io.h"
#include "server/render/path/prepared_scene.h"
#include "server/render/surface/bevel.h"
#include "server/render/surface/tangent_frame.h"
#include "tests/render/direction_chi_squared.h"
#include "tests/render/scene_files_fixture.h"

#include <gmock/gmock.h>

namespace chamfer {
namespace {

using test::loadText;
using test::TemporaryFolder;
using test::thrownBy;

TEST(BendNormal, KeepsTheMirrorDirectionAboveTheSurface) {
  test::UniformNumbers u(9);
  const Vector3 up(0, 0, 1);
  int bent = 0;
  for (int i = 0; i < 20000; ++i) {
    Vector3 wo = normalize(Vector3(u.direction())), n = normalize(Vector3(u.direction()));
    wo.z = std::abs(wo.z) * (i % 2 ? 1 : 1e-3);
    wo = normalize(wo);
    const Vector3 b = bendNormal(wo, n, up);
    ASSERT_NEAR(length(b), 1, 1e-12);
    ASSERT_GT(dot(b, wo), 0);
    ASSERT_GT(dot(b, up), 0);
    const Vector3 mirrored = b * (2 * dot(b, wo)) - wo;
    ASSERT_GT(mirrored.z, 0);
    if (b == n) continue;
    ++bent;
    const Vector3 before = n * (2 * dot(n, wo)) - wo;
    ASSERT_TRUE(before.z < 0.01 || n.z < 0.01) << "a normal that needs no bending is left alone";
  }
  EXPECT_GT(bent, 5000);
  EXPECT_EQ(bendNormal(normalize(Vector3(1, 0, 0.2)), -up, up), up);
}

TEST(TerminatorFactor, FadesToNothingAtTheSurfacesHorizon) {
  const Vector3 smooth(0, 0, 1), n = normalize(Vector3(1, 0, 1));
  EXPECT_EQ(terminatorFactor(smooth, n, smooth), 1);
  EXPECT_EQ(terminatorFactor(smooth, smooth, normalize(Vector3(1, 0, 1e-3))), 1);
  double before = 1;
  for (double z = 1; z > 0; z -= 1e-3) { // towards the horizon on the side to which n leans
    const double f = terminatorFactor(smooth, n, normalize(Vector3(1, 0, z)));
    EXPECT_LE(f, before + 1e-12);
    EXPECT_GT(before - f, -1e-12);
    EXPECT_LT(before - f, 0.01) << "no step";
    before = f;
  }
  EXPECT_LT(before, 0.01);
  EXPECT_EQ(terminatorFactor(smooth, n, normalize(Vector3(1, 0, -0.1))), 0);
}

TEST(Bevel, DistancesFollowTheFalloff) {
  constexpr int kCells = 40, kSamples = 200000;
  constexpr double kRadius = 0.3;
  std::vector<double> observed(kCells), expected(kCells);
  test::UniformNumbers u(4);
  for (int i = 0; i < kSamples; ++i) {
    const double r = sampleBevelDistance(kRadius, double(u()));
    ASSERT_GE(r, 0);
    ASSERT_LT(r, kRadius);
    ++observed[std::size_t(r / kRadius * kCells)];
  }
  for (int c = 0; c < kCells; ++c)
    expected[std::size_t(c)] =
        kSamples *
        test::integrate([&](double r, double) { return 2 * std::numbers::pi * r * bevelFalloff(kRadius, r); },
                        kRadius * c / kCells, kRadius * (c + 1) / kCells, 0, 1, 32);
  EXPECT_GT(test::chiSquared(observed, expected).pValue, test::kSignificance);
  for (double& e : expected)
    e = double(kSamples) / kCells;
  EXPECT_LT(test::chiSquared(observed, expected).pValue, test::kSignificance)
      << "the judge sees a difference";
}

/// The mean over many samples of the shading normal at a hit, not normalised.
Vector3 meanNormal(const PreparedScene& prepared, const Ray& ray) {
  const auto hit = prepared.tracer().intersect(ray);
  EXPECT_TRUE(hit.has_value());
  Vector3 sum;
  for (std::uint32_t s = 0; s < 256; ++s)
    sum += prepared.surfaces()
               .shadingNormal(*hit, prepared.surfaces().place(*hit), Sampler(0, 0, s, 0), 0)
               .normal;
  return sum / 256;
}

TEST(Bevel, TurnsNormalsNearEdgesAndNowhereElse) {
  const TemporaryFolder folder;
  const auto scene = loadText(folder, R"({"meshes":[{"name":"cube","file":"cube.obj","radius":0.1}],
    "instances":[{"mesh":"cube"},{"mesh":"cube","scale":[-2,2,2],"translate":[5,0,0]}]})");
  const auto prepared = prepare(scene, {RoundingMode::Bevel, 16, {}});
  const auto above = [&](double x, double y) { return meanNormal(*prepared, {{x, y, 3}, {0, 0, -1}}); };
  EXPECT_EQ(above(0, 0), Vector3(0, 0, 1));
  EXPECT_EQ(above(0.39, 0), Vector3(0, 0, 1)) << "a radius from the edge";
  double before = 0;
  for (const double x : {0.42, 0.45, 0.47, 0.49, 0.4999}) {
    const Vector3 n = above(x, 0);
    EXPECT_GT(n.x, before) << x;
    EXPECT_NEAR(n.y, 0, 0.02) << x;
    before = n.x;
  }
  // At the edge itself both faces count alike, whichever of them is looked at.
  const auto exact = prepare(scene, {RoundingMode::Bevel, 256, {}}); // few probes favour the face they are on
  const Vector3 edge = normalize(meanNormal(*exact, {{0.49999, 0, 3}, {0, 0, -1}}));
  EXPECT_NEAR(edge.x, std::sqrt(0.5), 0.02);
  EXPECT_NEAR(edge.z, std::sqrt(0.5), 0.02);
  const Vector3 side = normalize(meanNormal(*exact, {{3, 0, 0.49999}, {-1, 0, 0}}));
  EXPECT_NEAR(side.z, std::sqrt(0.5), 0.02);
  const Vector3 corner = normalize(meanNormal(*exact, {{0.49999, 0.49999, 3}, {0, 0, -1}}));
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(corner[i], std::sqrt(1.0 / 3), 0.03);
  // Mirrored and twice as large, the bevel is twice as wide and leans outward still.
  EXPECT_EQ(above(5.78, 0), Vector3(0, 0, 1));
  EXPECT_NEAR(above(5.98, 0).x, above(0.49, 0).x, 0.01);
  EXPECT_NEAR(above(4.02, 0).x, -above(0.49, 0).x, 0.01);
  // Geometry stays sharp.
  EXPECT_TRUE(prepared->tracer().intersect({{0.499, 0.499, 3}, {0, 0, -1}}).has_value());
  EXPECT_EQ(prepare(scene, {RoundingMode::None, 0, {}})->tracer().memoryBytes(),
            prepared->tracer().memoryBytes());
}

TEST(Bevel, ProbesSeeAllOfOneMeshAndNothingElse) {
  const TemporaryFolder folder;
  const auto scene = loadText(folder, R"({"meshes":[{"name":"cube","file":"cube.obj","radius":0.1}],
    "instances":[{"mesh":"cube"},{"mesh":"cube","translate":[0,0,0.2]}]})");
  const auto& traced = *scene->meshes[0].traced;
  std::array<MeshHit, 8> hits;
  ASSERT_EQ(allHits(traced, {{0.1, 0.2, 3}, {0, 0, -1}}, 10, hits), 2u);
  EXPECT_NEAR(std::min(hits[0].t, hits[1].t), 2.5, 1e-6);
  EXPECT_NEAR(std::max(hits[0].t, hits[1].t), 3.5, 1e-6);
  EXPECT_EQ(allHits(traced, {{0.1, 0.2, 3}, {0, 0, -1}}, 3, hits), 1u) << "the segment ends inside";
  EXPECT_EQ(allHits(traced, {{0.1, 0.2, 0}, {0, 0, -1}}, 10, hits), 1u);
  EXPECT_EQ(allHits(traced, {{0.7, 0.2, 3}, {0, 0, -1}}, 10, hits), 0u);
  EXPECT_EQ(allHits(traced, {{0.1, 0.2, 3}, {0, 0, -1}}, 10, std::span(hits).first(1)), 2u)
      << "counted all the same";
}

/// A cube whose top is mapped to the whole texture; `flipped`: mirrored in u.
std::string mappedCube(bool flipped) {
  std::string obj = test::cubeObj();
  const std::string top = "f 5 6 8 7\n"; // (-,-) (+,-) (+,+) (-,+) at z = 0.5
  const std::string uv = flipped ? "vt 1 0\nvt 0 0\nvt 0 1\nvt 1 1\n" : "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
  obj.replace(obj.find(top), top.size(), uv + "f 5/1 6/2 8/3 7/4\n");
  return obj;
}

TEST(NormalTexture, TurnsTheNormalInTheFrameOfTheTexture) {
  const TemporaryFolder folder;
  folder.write("plain.obj", mappedCube(false));
  folder.write("flipped.obj", mappedCube(true));
  // Everywhere: a little along u, twice that along v.
  const Vector3 texel = normalize(Vector3(0.2, 0.4, 1));
  const auto channel = [](double v) { return float(v / 2 + 0.5); };
  writeImage(folder.path() / "n.exr", {1, 1, {channel(texel.x), channel(texel.y), channel(texel.z), 1}});
  const auto scene = loadText(folder, R"({"meshes":[{"name":"plain","file":"plain.obj","radius":0.2},
    {"name":"flipped","file":"flipped.obj","radius":0.2}],"materials":[{"name":"m","normal_texture":"n.exr"}],
    "instances":[{"mesh":"plain","material":"m"},{"mesh":"flipped","material":"m","translate":[3,0,0]},
      {"mesh":"plain","material":"m","scale":[-1,2,1],"translate":[6,0,0]},
      {"mesh":"plain","material":"m","rotate":{"axis":[0,0,1],"degrees":90},"translate":[9,0,0]}]})");
  for (const RoundingMode mode : {RoundingMode::None, RoundingMode::Analytic, RoundingMode::Mesh}) {
    const auto prepared = prepare(scene, {mode, 8, {}});
    const auto at = [&](double x, double y, double dz = -1) {
      const auto hit = prepared->tracer().intersect({{x, y, -3 * dz}, {0, 0, dz}});
      return prepared->surfaces().shadingNormal(*hit, prepared->surfaces().place(*hit), Sampler(0, 0, 0, 0),
                                                0);
    };
    const auto expect = [&](const Vector3& n, const Vector3& truth, const char* what) {
      EXPECT_LT(length(n - truth), 1e-5) << what << " in mode " << int(mode);
    };
    expect(at(0, 0).normal, texel, "plain");
    expect(at(3, 0).normal, {-texel.x, texel.y, texel.z}, "texture mirrored in u");
    expect(at(6, 0).normal, {-texel.x, texel.y, texel.z}, "instance mirrored in x");
    expect(at(9, 0).normal, {-texel.y, texel.x, texel.z}, "instance turned");
    expect(at(0, 0, 1).normal, {0, 0, -1}, "no texture coordinates below");
    if (mode == RoundingMode::None) continue;
    // On the rounding of an edge along y, 30 degrees down: u runs down along the cylinder, v along its axis.
    const ShadingNormal r = at(0.4, 0);
    const Vector3 n = r.smooth, down(n.z, 0, -n.x);
    EXPECT_NEAR(n.x, 0.5, 0.03);
    expect(r.normal, n * texel.z + down * texel.x + Vector3(0, 1, 0) * texel.y, "on a cylinder");
  }
}

TEST(NormalTexture, HeightMapsAreToldFromNormals) {
  const TemporaryFolder folder;
  writeImage(folder.path() / "height.exr", {1, 1, {0.5f, 0.5f, 0.5f, 1}});
  writeImage(folder.path() / "flat.exr", {1, 1, {0.5f, 0.5f, 1, 1}});
  const std::string scene = R"({"meshes":[{"name":"m","file":"bumpy.obj"}],"materials":[{"name":"m")";
  folder.write("bumpy.obj", "mtllib b.mtl\nusemtl b\n" + test::cubeObj());
  folder.write("b.mtl", "newmtl b\nmap_Bump height.exr\n");
  const auto thrown = [&](const char* file) {
    return thrownBy([&] {
      loadText(folder, scene + R"(,"normal_texture":")" + file + R"("}],"instances":[{"mesh":"m"}]})");
    });
  };
  EXPECT_EQ(thrown("flat.exr"), "nothing");
  EXPECT_THAT(thrown("height.exr"), testing::HasSubstr("materials[0]: normal_texture: height.exr"));
  const auto loaded = loadText(folder, scene + R"(}],"instances":[{"mesh":"m"}]})");
  EXPECT_THAT(loaded->warnings, testing::Contains(testing::HasSubstr("height map")));
  folder.write("b.mtl", "newmtl b\nnorm flat.exr\n");
  const auto normal = loadText(folder, scene + R"(}],"instances":[{"mesh":"m"}]})");
  EXPECT_TRUE(normal->warnings.empty());
  EXPECT_NE(normal->data->materials[1].normalTexture, kNoTexture);
  EXPECT_NE(loaded->id, normal->id);
}

} // namespace
} // namespace chamfer
