// Light whose amount is known exactly: furnaces, closed boxes, direct light in closed form.
#include "server/render/image/image_io.h"
#include "server/render/path/camera.h"
#include "server/render/path/prepared_scene.h"
#include "tests/render/direction_chi_squared.h"
#include "tests/render/scene_files_fixture.h"

#include <cmath>
#include <gmock/gmock.h>

namespace chamfer {
namespace {

using test::loadText;
using test::TemporaryFolder;

/// Mean of the green channel over a tile, from independent renders that differ in their seed.
struct Estimate {
  double mean = 0, error = 0; ///< standard error of the mean
  /// Is the mean within 4.5 standard errors of the truth (and some float32 rounding)?
  bool agreesWith(double truth) const { return std::abs(mean - truth) <= 4.5 * error + 2e-5 * truth; }
  std::string text() const { return std::to_string(mean) + " +- " + std::to_string(error); }
};

struct View {
  Camera camera;
  unsigned samples = 64, seeds = 12, bounces = 8;
  RoundingChoice rounding;
  float clamp = 0;
};

Estimate measure(const std::shared_ptr<const Scene>& scene, const View& view) {
  const auto prepared = prepare(scene, view.rounding);
  RenderSettings s;
  s.width = s.height = 16;
  s.endSample = view.samples;
  s.maxBounces = view.bounces;
  s.indirectClamp = view.clamp;
  s.camera = view.camera;
  double sum = 0, squares = 0;
  for (s.seed = 0; s.seed < view.seeds; ++s.seed) {
    const RenderResult r = renderTile(*prepared, s, {0, 0, s.width, s.height});
    EXPECT_EQ(r.statistics.nonFiniteSamples, 0u);
    double mean = 0;
    for (std::size_t i = 1; i < r.image.rgba.size(); i += 4)
      mean += r.image.rgba[i] / (s.width * s.height);
    sum += mean;
    squares += mean * mean;
  }
  const double n = view.seeds, mean = sum / n;
  return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean) / (n - 1))};
}

/// The same, one bounce, with lights found by scattered rays alone: a path tracer of the simplest kind.
Estimate measureByScattering(const std::shared_ptr<const Scene>& scene, const View& view) {
  const auto prepared = prepare(scene, view.rounding);
  const Tracer& tracer = ownTracer(*prepared);
  const Surfaces& surfaces = prepared->surfaces();
  const CameraRays camera(view.camera, 1, 1);
  test::UniformNumbers u(11);
  double sum = 0, squares = 0;
  const int samples = int(view.samples) * 256;
  for (int i = 0; i < samples; ++i) {
    const Ray ray = camera.ray(0.5, 0.5, {});
    Arrival arrival;
    const auto hit = tracer.intersect(ray, {}, 0, INFINITY, &arrival);
    double value = 0;
    if (hit) {
      const Vector3 d(Frame(Vector3f(hit->normal)).toWorld(warpToCosineHemisphere(u.pair())));
      const auto light = tracer.intersect({hit->position, d}, arrival.state);
      if (light)
        value =
            double(surfaces.place(*hit).material->baseColor.g * surfaces.place(*light).material->emission.g);
    }
    sum += value / samples;
    squares += value * value / samples;
  }
  return {sum, std::sqrt((squares - sum * sum) / samples)};
}

Camera lookAt(const Point3& eye, const Point3& target, double vfov) {
  Camera c;
  c.eye = eye;
  c.target = target;
  c.vfovDegrees = vfov;
  return c;
}

std::string furnace(const std::string& material, const std::string& radius) {
  return R"({"meshes":[{"name":"cube","file":"cube.obj")" + radius + R"(}],"materials":[{"name":"m",)" +
         material +
         R"(}],"instances":[{"mesh":"cube","material":"m"}],"lights":[{"type":"environment","color":[1,1,1]}]})";
}

TEST(Furnace, WhiteConvexSolidsVanishInAUniformSky) {
  const TemporaryFolder folder;
  View view;
  view.camera = lookAt({1.4, -3, 1.1}, {0, 0, 0}, 30);
  view.seeds = 4;
  for (const char* radius : {"", R"(,"radius":0.1)", R"(,"radius":0.45)"}) { // sharp, rounded, nearly a ball
    const Estimate e = measure(loadText(folder, furnace(R"("base_color":1,"specular":0)", radius)), view);
    EXPECT_NEAR(e.mean, 1, 1e-3) << radius << " " << e.text();
    EXPECT_TRUE(e.agreesWith(1)) << radius << " " << e.text();
  }
  // The coat's albedo comes from a table: to its precision white plastic vanishes as well.
  const Estimate plastic = measure(loadText(folder, furnace(R"("base_color":1,"roughness":0.4)", "")), view);
  EXPECT_NEAR(plastic.mean, 1, 3e-3 + 4 * plastic.error);
}

TEST(Furnace, EveryWhiteMaterialVanishesAtEveryRoughness) {
  const TemporaryFolder folder;
  View view;
  view.camera = lookAt({1.4, -3, 1.1}, {0, 0, 0}, 15); // the solid fills the frame
  view.bounces = 256;
  view.seeds = 4;
  const auto check = [&](const std::string& material, const char* radius, double noise = 6e-3) {
    const Estimate e = measure(loadText(folder, furnace(R"("base_color":1,)" + material, radius)), view);
    EXPECT_NEAR(e.mean, 1, 4.5 * e.error + 5e-3) << material << radius << " " << e.text();
    EXPECT_LT(e.error, noise) << material << radius;
  };
  for (const char* roughness : {"0.05", "0.2", "0.4", "0.7", "1"}) {
    const std::string rough = R"(,"roughness":)" + std::string(roughness);
    for (const char* radius : {"", R"(,"radius":0.1)", R"(,"radius":0.45)"}) {
      check(R"("metallic":1)" + rough, radius);
      check(R"("transmission":1)" + rough, radius);
    }
    check(R"("transmission":1,"ior":1.05)" + rough, R"(,"radius":0.1)");
    // A path meets the inside of such solids many times, and each adds noise.
    check(R"("transmission":1,"ior":2.2)" + rough, R"(,"radius":0.1)", 0.02);
    check(R"("transmission":1,"ior":3)" + rough, R"(,"radius":0.1)", 0.05);
    check(R"("metallic":0.5,"transmission":0.5)" + rough, R"(,"radius":0.1)", 0.03);
    check(R"("metallic":0.3,"transmission":0.3,"specular":1)" + rough, R"(,"radius":0.1)", 0.02);
  }
  // Light that total reflection keeps inside a sharp cube of clear glass for good is lost to the limit of
  // bounces.
  check(R"("transmission":1,"roughness":0)", R"(,"radius":0.1)");
  check(R"("transmission":1,"roughness":0)", R"(,"radius":0.45)");
  const Estimate sharp =
      measure(loadText(folder, furnace(R"("base_color":1,"transmission":1,"roughness":0)", "")), view);
  EXPECT_LE(sharp.mean, 1 + 4.5 * sharp.error + 1e-4);
}

TEST(Furnace, ReportedMaterialsVanish) { // scenes made after users' reports
  const std::filesystem::path reports =
      std::filesystem::path(CHAMFER_SOURCE_DIR) / "../shared/data/reports/rough-furnace";
  if (!std::filesystem::exists(reports)) GTEST_SKIP() << "no folder of reports beside the sources";
  int scenes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(reports)) {
    if (entry.path().extension() != ".json") continue;
    ++scenes;
    const auto scene = loadScene(entry.path(), reports, entry.path().stem().string());
    View view;
    view.camera = scene->camera;
    view.bounces = 64;
    view.seeds = 4;
    const Estimate e = measure(scene, view);
    EXPECT_NEAR(e.mean, 1, 4.5 * e.error + 5e-3) << entry.path().filename() << " " << e.text();
    EXPECT_LT(e.error, 2e-3) << entry.path().filename();
  }
  EXPECT_GE(scenes, 12);
}

TEST(Furnace, ShadingNormalsNeverShine) {
  // Coarse meshes, bevels and normal textures turn the frame that light scatters in; what they cut off may be
  // lost, and none may be made.
  const TemporaryFolder folder;
  std::string obj = test::cubeObj();
  const std::string top = "f 5 6 8 7\n";
  obj.replace(obj.find(top), top.size(), "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 5/1 6/2 8/3 7/4\n");
  folder.write("mapped.obj", obj);
  writeImage(folder.path() / "n.exr", {2, 1, {0.9f, 0.3f, 0.7f, 1, 0.2f, 0.8f, 0.65f, 1}});
  View view;
  view.camera = lookAt({1.4, -3, 1.1}, {0, 0, 0}, 15);
  view.bounces = 64;
  view.seeds = 6;
  const auto measured = [&](const RoundingChoice& choice, const std::string& material) {
    view.rounding = choice;
    return measure(loadText(folder, furnace(material, R"(,"radius":0.2)")), view);
  };
  for (const char* m :
       {R"("base_color":1,"specular":0)", R"("base_color":1,"metallic":1,"roughness":0.2)",
        R"("base_color":1,"metallic":1,"roughness":0)", R"("base_color":1,"transmission":1,"roughness":0)"})
    for (const RoundingChoice& choice :
         {RoundingChoice{RoundingMode::Mesh, 1, {}}, RoundingChoice{RoundingMode::Mesh, 64, {}},
          RoundingChoice{RoundingMode::Bevel, 4, {}}}) {
      const Estimate e = measured(choice, m);
      EXPECT_LE(e.mean, 1 + 4.5 * e.error + 1e-4) << m << e.text();
      EXPECT_GE(e.mean, 0.8) << m << e.text();
      if (choice.mode == RoundingMode::Mesh && choice.count == 64) {
        EXPECT_NEAR(e.mean, 1, 0.02) << m << e.text();
      }
    }
  const auto mapped = loadText(folder, R"({"meshes":[{"name":"cube","file":"mapped.obj","rounding":false}],
    "materials":[{"name":"m","base_color":1,"specular":0,"normal_texture":"n.exr"}],
    "instances":[{"mesh":"cube","material":"m"}],"lights":[{"type":"environment","color":[1,1,1]}]})");
  view.rounding = {};
  view.camera = lookAt({1, -1, 3}, {0.1, -0.1, 0.5}, 5); // at the mapped face
  const Estimate e = measure(mapped, view);
  EXPECT_LE(e.mean, 1 + 4.5 * e.error + 1e-4) << e.text();
  EXPECT_GE(e.mean, 0.6) << e.text();
  EXPECT_LT(e.mean, 0.99) << "the texture must have turned something: " << e.text();
}

TEST(Furnace, ConcaveScenesVanishToo) { // inter-reflection between two white solids and a white floor
  const TemporaryFolder folder;
  const auto scene = loadText(folder, R"({"meshes":[{"name":"cube","file":"cube.obj","radius":0.1},
    {"name":"floor","file":"floor.obj"}],"materials":[{"name":"m","base_color":1,"specular":0}],
    "instances":[{"mesh":"cube","material":"m"},{"mesh":"cube","material":"m","translate":[1.05,0,0]},
    {"mesh":"floor","material":"m"}],"lights":[{"type":"environment","color":[1,1,1]}]})");
  View view;
  view.camera = lookAt({0.5, -3, 2}, {0.5, 0, -0.2}, 30);
  view.bounces = 200;
  const Estimate e = measure(scene, view);
  EXPECT_TRUE(e.agreesWith(1)) << e.text();
  EXPECT_NEAR(e.mean, 1, 2e-3);
}

std::string closedBox(double emission, double albedo, const std::string& radius) {
  return R"({"meshes":[{"name":"box","file":"box2.obj")" + radius +
         R"(}],"materials":[{"name":"m","specular":0,
    "emission":)" +
         std::to_string(emission) + R"(,"base_color":)" + std::to_string(albedo) +
         R"(}],"instances":[{"mesh":"box","material":"m"}],"lights":[{"type":"environment","color":0}]})";
}

TEST(ClosedBox, RadianceIsEmissionOverOneMinusAlbedo) {
  const TemporaryFolder folder;
  View view;
  view.camera = lookAt({0.3, -0.5, 0.2}, {0, 1, -0.3}, 70);
  view.bounces = 300;
  view.samples = 32;
  for (const char* radius : {"", R"(,"radius":0.3)"}) // sampled as a light, found by scattering alone
    for (const double albedo : {0.0, 0.5, 0.8}) {
      const Estimate e = measure(loadText(folder, closedBox(0.7, albedo, radius)), view);
      EXPECT_TRUE(e.agreesWith(0.7 / (1 - albedo))) << albedo << radius << " " << e.text();
      EXPECT_NEAR(e.mean, 0.7 / (1 - albedo), 0.01) << albedo << radius;
    }
}

TEST(ClosedBox, BouncesAreCounted) { // E (1 + rho + ... + rho^n)
  const TemporaryFolder folder;
  View view;
  view.camera = lookAt({0.3, -0.5, 0.2}, {0, 1, -0.3}, 70);
  const auto scene = loadText(folder, closedBox(1, 0.5, ""));
  for (const auto& [bounces, truth] : {std::pair(0u, 1.0), {1u, 1.5}, {2u, 1.75}, {5u, 1.96875}}) {
    view.bounces = bounces;
    const Estimate e = measure(scene, view);
    EXPECT_TRUE(e.agreesWith(truth)) << bounces << " " << e.text();
  }
}

TEST(IndirectClamp, CutsIndirectLightAndNothingElse) {
  const TemporaryFolder folder;
  View view;
  view.camera = lookAt({0.3, -0.5, 0.2}, {0, 1, -0.3}, 70);
  view.bounces = 1;
  const auto scene = loadText(folder, closedBox(1, 0.5, R"(,"radius":0.3)")); // found by scattering alone
  view.clamp = 0.1f;
  EXPECT_TRUE(measure(scene, view).agreesWith(1.5)) << "emission and direct light are left alone";
  // The third hit adds 0.25; the fourth, which roulette lets one path in eight get to, 1.
  view.bounces = 3;
  EXPECT_TRUE(measure(scene, view).agreesWith(1.5 + 0.1 + 0.1 / 8)) << measure(scene, view).text();
  view.clamp = 0.2f;
  EXPECT_TRUE(measure(scene, view).agreesWith(1.5 + 0.2 + 0.2 / 8)) << measure(scene, view).text();
  view.clamp = 0;
  EXPECT_TRUE(measure(scene, view).agreesWith(1.875)) << "0: none";
}

TEST(ClosedBox, TheJudgeRejectsOneHalfPercent) {
  const TemporaryFolder folder;
  View view;
  view.camera = lookAt({0.3, -0.5, 0.2}, {0, 1, -0.3}, 70);
  view.bounces = 300;
  view.samples = 32;
  const Estimate e = measure(loadText(folder, closedBox(0.7035, 0.5, "")), view);
  EXPECT_FALSE(e.agreesWith(1.4)) << e.text();
}

/// Looks straight down at a small patch of a grey floor at the origin of z = -0.5.
View floorView() {
  View view;
  view.camera = lookAt({0, 0, 2}, {0, 0, -0.5}, 0.01);
  view.camera.up = {0, 1, 0};
  view.bounces = 1;
  return view;
}

std::string floorUnder(const std::string& lights, const std::string& instances = "") {
  return R"({"meshes":[{"name":"floor","file":"floor.obj"},{"name":"cube","file":"cube.obj","radius":0.1}],
    "materials":[{"name":"m","base_color":0.5,"specular":0}],"instances":[{"mesh":"floor","material":"m"})" +
         instances + R"(],"lights":[{"type":"environment","color":0},)" + lights + "]}";
}

TEST(DirectLight, MatchesClosedForms) {
  const TemporaryFolder folder;
  const double rho = 0.5 / std::numbers::pi;
  const auto check = [&](const char* what, const std::string& lights, double irradiance) {
    const Estimate e = measure(loadText(folder, floorUnder(lights)), floorView());
    EXPECT_TRUE(e.agreesWith(rho * irradiance)) << what << " " << e.text() << " truth " << rho * irradiance;
  };
  check("point", R"({"type":"point","position":[3,0,3.5],"intensity":25})", 25 / 25.0 * 4 / 5);
  check("sun", R"({"type":"directional","direction":[0,-1,-1],"irradiance":2})", 2 / std::sqrt(2.0));
  check("wide sun",
        R"({"type":"directional","direction":[0,-1,-1],"irradiance":2,"angular_diameter_degrees":3})",
        2 / std::sqrt(2.0));
  // A 2 x 2 light one above the point (and beside the camera's view).
  const double quad = 4 / std::sqrt(2.0) * std::atan(1 / std::sqrt(2.0));
  View below = floorView();
  below.camera = lookAt({0, 0, 0.4}, {0, 0, -0.5}, 0.01);
  below.camera.up = {0, 1, 0};
  const Estimate e = measure(
      loadText(folder,
               floorUnder(R"({"type":"area","center":[0,0,0.5],"u":[1,0,0],"v":[0,1,0],"emission":3})")),
      below);
  EXPECT_TRUE(e.agreesWith(3 * rho * quad)) << e.text() << " truth " << 3 * rho * quad;
}

TEST(DirectLight, RoundedEmittersAreSampledAsWhatTheyAre) {
  // A cube of inradius 0.5 rounded by nearly that is a ball: E = pi L (r / d)^2 times the cosine of its
  // centre.
  const TemporaryFolder folder;
  const auto scene = [&](const char* radius) {
    return loadText(folder,
                    R"({"meshes":[{"name":"floor","file":"floor.obj"},{"name":"lamp","file":"cube.obj",)" +
                        std::string(radius) + R"(}],
      "materials":[{"name":"m","base_color":0.5,"specular":0},{"name":"glow","base_color":0,"specular":0,"emission":4}],
      "instances":[{"mesh":"floor","material":"m"},
      {"mesh":"lamp","material":"glow","scale":[1,-1,1],"translate":[1.5,0,1.5]}],
      "lights":[{"type":"environment","color":0}]})");
  };
  const double rho = 0.5 / std::numbers::pi, distance2 = 1.5 * 1.5 + 4, cosine = 2 / std::sqrt(distance2);
  const double ball = rho * std::numbers::pi * 4 * 0.25 / distance2 * cosine;
  const Estimate round = measure(scene(R"("radius":0.4999)"), floorView());
  EXPECT_NEAR(round.mean, ball, 4.5 * round.error + 2e-3 * ball) << round.text();
  EXPECT_LT(round.error, 0.005 * ball) << "scattered rays alone would do far worse";
  // Without light sampling (the lamp is seen through scattered rays only) the estimate must be the same.
  View blind = floorView();
  blind.samples = 1024;
  for (const char* radius : {R"("radius":0.2)", R"("rounding":false)"}) {
    const auto lamp = scene(radius);
    const Estimate aimed = measure(lamp, floorView());
    const Estimate found = measureByScattering(lamp, blind);
    EXPECT_TRUE(std::abs(aimed.mean - found.mean) <= 4.5 * std::hypot(aimed.error, found.error))
        << radius << " " << aimed.text() << " against " << found.text();
  }
}

TEST(DirectLight, RoundedCornersLetLightPast) {
  // A point light seen past a cube's vertical edge: blocked by the sharp cube, free beside the rounded one.
  // The cube reaches 0.5, the light's ray passes its corner (0.5, 0.5) 0.02 inside the sharp cube, outside of
  // the rounding (0.041).
  const TemporaryFolder folder;
  const double inside = 0.02 / std::sqrt(2.0);
  const std::string cube = R"(,{"mesh":"cube","material":"m","translate":[)" + std::to_string(-0.5 + inside) +
                           "," + std::to_string(-0.5 + inside) + ",0.01]}";
  const std::string light = R"({"type":"point","position":[-3,3,1],"intensity":25})";
  View view = floorView();
  view.camera = lookAt({3, -3, 1}, {1.2, -1.2, -0.5}, 0.01);
  const auto scene = loadText(folder, floorUnder(light, cube));
  const Estimate rounded = measure(scene, view);
  view.rounding.mode = RoundingMode::None;
  const Estimate sharp = measure(scene, view);
  EXPECT_EQ(sharp.mean, 0);
  EXPECT_GT(rounded.mean, 0.01);
}

TEST(Sidedness, NoLightLeaksIntoARoundedSolid) {
  // From inside a closed black room under a bright sky nothing is seen, along edges and corners least of all.
  const TemporaryFolder folder;
  const auto scene = loadText(folder, R"({"meshes":[{"name":"box","file":"box2.obj","radius":0.5}],
    "materials":[{"name":"m","base_color":0.9}],"instances":[{"mesh":"box","material":"m"}],
    "lights":[{"type":"environment","color":[100,100,100]},{"type":"point","position":[3,3,3],"intensity":900}]})");
  View view;
  view.camera = lookAt({-0.4, -0.4, -0.4}, {1, 1, 1}, 110);
  const Estimate e = measure(scene, view);
  EXPECT_EQ(e.mean, 0);
}

} // namespace
} // namespace chamfer
