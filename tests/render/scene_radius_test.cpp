// Which rounding a mesh of a scene gets: radii in world units, options that a sidecar was made with, clamps,
// and the axis that is up.
#include "common/sidecar.h"
#include "tests/render/direction_chi_squared.h"
#include "tests/render/scene_files_fixture.h"

#include <fstream>
#include <gmock/gmock.h>
#include <iterator>
#include <sstream>

namespace chamfer {
namespace {

namespace fs = std::filesystem;
using test::loadText;
using test::TemporaryFolder;
using test::thrownBy;
using testing::HasSubstr;
using testing::StartsWith;

const RoundingChoice kWide{RoundingMode::Analytic, 0, 0.35};

/// One mesh entry and its instances, given as the members after "name" and "mesh".
std::string scene(const std::string& mesh, std::initializer_list<std::string> instances) {
  std::string text = R"({"meshes":[{"name":"m",)" + mesh + R"(}],"instances":[)", comma;
  for (const std::string& i : instances)
    text += std::exchange(comma, ",") + R"({"mesh":"m")" + i + "}";
  return text + "]}";
}

/// The same surfaces, as rays from around see them? Hits on the outline of either may miss the other.
void expectSameHits(const std::shared_ptr<const Scene>& a, const std::shared_ptr<const Scene>& b,
                    const RoundingChoice& choice = {}) {
  const auto preparedA = prepare(a, choice), preparedB = prepare(b, choice);
  const Tracer &first = ownTracer(*preparedA), &second = ownTracer(*preparedB);
  test::UniformNumbers u(3);
  const double size = b->bounds.diagonal();
  const Bounds3& bounds = b->bounds;
  int met = 0, rounded = 0, apart = 0;
  for (int i = 0; i < 4000; ++i) {
    const Point3 from = bounds.centre() + Vector3(u.direction()) * size;
    const Vector3 across = bounds.upper - bounds.lower;
    const Point3 to = bounds.lower + Vector3(across.x * u(), across.y * u(), across.z * u());
    const Ray ray{from, to - from};
    const auto hitA = first.intersect(ray), hitB = second.intersect(ray);
    if (hitA.has_value() != hitB.has_value() ||
        (hitA && length(hitA->position - hitB->position) > 1e-4 * size)) {
      ++apart;
      continue;
    }
    if (!hitA) continue;
    ++met;
    rounded += hitA->rounded();
    EXPECT_NEAR(dot(hitA->normal, hitB->normal), 1, 1e-3);
  }
  EXPECT_GT(met, 1000);
  EXPECT_GT(rounded, 30);
  EXPECT_LE(apart, 5);
}

TEST(RadiusInWorldUnits, IsDividedByAUniformScale) {
  const TemporaryFolder folder;
  const auto s =
      loadText(folder, scene(R"("file":"cube.obj","radius_world":0.3)",
                             {R"(,"scale":2)", R"(,"scale":-4,"translate":[9,0,0])",
                              R"(,"scale":2,"rotate":{"axis":[1,2,3],"degrees":40},"translate":[0,9,0],
                                            "repeat":[{"count":3,"step":[0,0,5]}])"}));
  ASSERT_EQ(s->meshes.size(), 2u) << "instances of one scale share a rounding";
  EXPECT_EQ(s->meshes[0].traced, s->meshes[1].traced) << "and all the mesh";
  EXPECT_FLOAT_EQ(s->meshes[0].rounding->view().solids[0].radius, 0.15f);
  EXPECT_FLOAT_EQ(s->meshes[1].rounding->view().solids[0].radius, 0.075f);
  EXPECT_NEAR(s->meshes[0].radius, 0.3, 1e-7);
  EXPECT_NEAR(s->meshes[1].radius, 0.3, 1e-7);
  EXPECT_NEAR(s->meshes[0].maxRadius, 1, 1e-9);
  EXPECT_EQ(s->instances.size(), 5u);
  const auto one = loadText(folder, scene(R"("file":"cube.obj","radius_world":0.3)", {R"(,"scale":2)"}));
  const auto applied = loadText(folder, scene(R"("file":"box2.obj","radius":0.3)", {""}));
  expectSameHits(one, applied);
  expectSameHits(one, applied, kWide); // a request's radius is in world units, too
  EXPECT_THAT(thrownBy([&] {
                prepare(one, {RoundingMode::Analytic, 0, 1.0});
              }),
              StartsWith("radius-too-large: the radius 1 is too large: it must be below 1"));
}

TEST(RadiusInWorldUnits, RoundsAfterAnUnevenScale) {
  const TemporaryFolder folder;
  folder.write("wall.obj", test::boxObj({-2, -0.5, -1}, {2, 0.5, 1}));
  const std::string place = R"(,"rotate":{"axis":[1,-1,2],"degrees":70},"translate":[5,6,7])";
  const auto applied = loadText(folder, scene(R"("file":"wall.obj","radius":0.2)", {place}));
  for (const char* scale : {"[4,1,2]", "[-4,1,2]", "[4,-1,-2]"}) {
    const auto scaled = loadText(folder, scene(R"("file":"cube.obj","radius_world":0.2)",
                                               {R"(,"scale":)" + std::string(scale) + place}));
    EXPECT_EQ(scaled->meshes[0].name, "m (scaled 4 x 1 x 2)");
    EXPECT_NEAR(scaled->meshes[0].maxRadius, 0.5, 1e-9);
    expectSameHits(scaled, applied);
    expectSameHits(scaled, applied, kWide);
  }
  // What turns it differently, shares it.
  const auto many = loadText(
      folder, scene(R"("file":"cube.obj","radius_world":0.2)",
                    {R"(,"scale":[4,1,2])", R"(,"scale":[4,1,2])" + place,
                     R"(,"scale":[-4,1,2],"rotate":{"axis":[0,0,1],"degrees":33})", R"(,"scale":[4,2,1])"}));
  EXPECT_EQ(many->meshes.size(), 2u);
}

TEST(RadiusInWorldUnits, RoundsAfterAShear) {
  const TemporaryFolder folder;
  std::ostringstream obj;
  for (int i = 0; i < 8; ++i) { // the unit cube under [2 1 0; 0 1 0.5; 0 0 1]
    const double x = i & 1 ? 0.5 : -0.5, y = i & 2 ? 0.5 : -0.5, z = i & 4 ? 0.5 : -0.5;
    obj << "v " << 2 * x + y << ' ' << y + 0.5 * z << ' ' << z << '\n';
  }
  obj << "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  folder.write("sheared.obj", obj.str());
  const auto applied = loadText(folder, scene(R"("file":"sheared.obj","radius":0.1)", {""}));
  const auto sheared = loadText(folder, scene(R"("file":"cube.obj","radius_world":0.1)",
                                              {R"(,"matrix":[2,1,0,0, 0,1,0.5,0, 0,0,1,0, 0,0,0,1])"}));
  EXPECT_EQ(sheared->meshes[0].name, "m (scaled sheared)");
  expectSameHits(sheared, applied);
  EXPECT_THAT(thrownBy([&] {
                loadText(folder,
                         scene(R"("file":"cube.obj","radius_world":0.1)", {R"(,"scale":[1,1,1e-10])"}));
              }),
              HasSubstr("squeezes"));
}

TEST(RadiusInWorldUnits, KeepsTheMaterialsOfTheMeshFile) {
  const TemporaryFolder folder;
  folder.write("m.mtl", "newmtl red\nKd 0.5 0 0\n");
  folder.write("red.obj", "mtllib m.mtl\nusemtl red\n" + test::cubeObj());
  const auto s = loadText(folder, scene(R"("file":"red.obj","radius_world":0.1)",
                                        {R"(,"scale":2)", R"(,"scale":[1,2,3],"translate":[9,0,0])"}));
  ASSERT_EQ(s->meshes.size(), 2u);
  const auto prepared = prepare(s, {});
  RenderSettings settings;
  settings.width = settings.height = 8;
  settings.aov = Aov::Albedo;
  settings.camera = s->camera;
  settings.camera->target = {9, 0, 0};
  settings.camera->eye = {9, -9, 0};
  settings.camera->vfovDegrees = 1;
  EXPECT_EQ(renderTile(*prepared, settings, {0, 0, 1, 1}).image.rgba[0], 0.5f);
}

/// Two cubes of sides 1 and 0.1.
std::string twoCubes() {
  std::string text = test::cubeObj(), small = test::boxObj({3, 0, 0}, {3.1, 0.1, 0.1});
  return text + small.substr(0, small.find('f')) +
         "f 9 11 12 10\nf 13 14 16 15\nf 9 10 14 13\nf 11 15 16 12\nf 9 13 15 11\nf 10 12 16 14\n";
}

void writeSidecarFor(const fs::path& mesh, const PreprocessOptions& options) {
  writeSidecar(mesh.string() + ".chamfer", *preprocess(readMesh(mesh), options).rounding);
}

TEST(SidecarOptions, HoldForAnotherRadius) {
  const TemporaryFolder folder;
  PreprocessOptions options;
  options.radius = parseRadius("0.2");
  // A top that is nearly but not quite joined to the sides: one solid only with --weld.
  const std::string cube = test::cubeObj();
  std::string loose = cube.substr(0, cube.find('f')) + "v -0.5 -0.5 0.50001\nv 0.5 -0.5 0.5\nv -0.5 0.5 0.5\n"
                                                       "v 0.5 0.5 0.5\n";
  loose += "f 1 3 4 2\nf 9 10 12 11\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  const fs::path mesh = folder.write("loose.obj", loose);
  EXPECT_THAT(thrownBy([&] { preprocess(readMesh(mesh), options); }), StartsWith("not-convex-solid"));
  options.tolerances.weld = 1e-4;
  options.tolerances.planarity = 1e-4;
  writeSidecarFor(mesh, options);
  const auto bare = loadScene(mesh, folder.path(), "loose");
  EXPECT_EQ(bare->meshes[0].options.weld, 1e-4);
  EXPECT_EQ(thrownBy([&] { prepare(bare, kWide); }), "nothing");
  EXPECT_EQ(thrownBy([&] { loadText(folder, scene(R"("file":"loose.obj","radius":0.3)", {""})); }), "nothing")
      << "in a scene that asks for another radius, too";

  // A radius that is too large for one of the solids: with the sidecar's clamp no radius is.
  const fs::path two = folder.write("two.obj", twoCubes());
  options = {};
  options.radius = parseRadius("0.2");
  options.clamp = 0.8;
  writeSidecarFor(two, options);
  const auto clamped = loadScene(two, folder.path(), "two");
  EXPECT_NEAR(clamped->meshes[0].radius, 0.2, 1e-7);
  EXPECT_NEAR(clamped->meshes[0].maxRadius, 0.5, 1e-9) << "beyond it nothing is rounded more";
  const auto small = [&](const RoundingChoice& choice) { // down past the small cube's vertical edge
    return ownTracer(*prepare(clamped, choice)).intersect({{3.008, 0.008, 1}, {0, 0, -1}}).has_value();
  };
  EXPECT_FALSE(small({})) << "0.04 rounds 0.012 of the diagonal off";
  EXPECT_FALSE(small(kWide));
  RoundingChoice less = kWide;
  less.radiusClamp = 0.2;
  EXPECT_TRUE(small(less)) << "a request's clamp wins";
  less.radiusClamp = 0;
  EXPECT_THAT(thrownBy([&] { prepare(clamped, less); }), HasSubstr("radius-too-large"));
  less.radiusClamp = 1;
  EXPECT_THAT(thrownBy([&] { prepare(clamped, less); }), StartsWith("out-of-range: the radius clamp"));
  less = {};
  less.radiusClamp = 0.1; // with the radius that it has
  EXPECT_TRUE(small(less));
}

TEST(SidecarOptions, AreComparedWithWhatASceneAsks) {
  const TemporaryFolder folder;
  const fs::path two = folder.write("two.obj", twoCubes());
  PreprocessOptions options;
  options.radius = parseRadius("5%");
  options.clamp = 0.8;
  writeSidecarFor(two, options);
  const auto meshOf = [&](const std::string& keys) {
    return loadText(folder, scene(R"("file":"two.obj",)" + keys, {""}))->meshes[0];
  };
  const SceneMesh same = meshOf(R"("radius":"5%")");
  EXPECT_EQ(same.options, recordOf(options));
  EXPECT_EQ(meshOf(R"("radius":"5%","radius_clamp":0.8)").options, recordOf(options));
  EXPECT_EQ(meshOf(R"("radius":"5%","radius_clamp":0.5)").options.clamp, 0.5);
  EXPECT_EQ(meshOf(R"("radius":0.3)").options.clamp, 0.8);
  EXPECT_THAT(thrownBy([&] { meshOf(R"("radius":0.3,"radius_clamp":0)"); }), HasSubstr("radius-too-large"));
  fs::remove(folder.path() / "two.obj.chamfer");
  EXPECT_THAT(thrownBy([&] { meshOf(R"("radius":0.3)"); }), HasSubstr("radius-too-large"));
  const SceneMesh clamped = meshOf(R"("radius":0.3,"radius_clamp":0.9)");
  EXPECT_NEAR(clamped.radius, 0.3, 1e-7);
  EXPECT_NEAR(clamped.rounding->view().solids[1].radius, 0.045f, 1e-7);
}

TEST(UpAxis, TurnsMeshesUpright) {
  const TemporaryFolder folder;
  const fs::path post = folder.write("post.obj", test::boxObj({0, 0, 0}, {1, 5, 2}));
  const auto asIs = loadScene(post, folder.path(), "p"),
             turned = loadScene(post, folder.path(), "p", UpAxis::Y);
  EXPECT_EQ(asIs->bounds.upper, Point3(1, 5, 2));
  EXPECT_EQ(turned->bounds.lower, Point3(0, -2, 0));
  EXPECT_EQ(turned->bounds.upper, Point3(1, 0, 5));
  EXPECT_FALSE(asIs->id == turned->id);
  // Either brings the other along.
  ASSERT_TRUE(asIs->otherUp && turned->otherUp);
  EXPECT_EQ(asIs->otherUp->id, turned->id);
  EXPECT_EQ(turned->otherUp->id, asIs->id);
  EXPECT_EQ(asIs->otherUp->otherUpId, asIs->id);
  EXPECT_EQ(asIs->otherUp->bounds.lower, turned->bounds.lower);
  EXPECT_EQ(asIs->otherUp->camera.eye, turned->camera.eye);
  EXPECT_EQ(asIs->otherUp->meshes[0].traced, asIs->meshes[0].traced) << "what is large is there once";
  expectSameHits(asIs->otherUp, turned, {RoundingMode::Analytic, 0, 0.2});
  const auto placed = loadText(folder, scene(R"("file":"post.obj","up_axis":"y","radius":0.1)",
                                             {R"(,"scale":[1,1,2],"translate":[10,0,0])"}));
  EXPECT_EQ(placed->bounds.lower, Point3(10, -2, 0));
  EXPECT_EQ(placed->bounds.upper, Point3(11, 0, 10)) << "upright first, then what the instance says";
}

/// Inputs made after users' reports; empty where they are not beside the sources.
fs::path reports(const char* name) {
  const fs::path folder = fs::path(CHAMFER_SOURCE_DIR) / "../shared/data/reports" / name;
  return fs::exists(folder) ? folder : fs::path();
}

TEST(Reports, ScaledWallIsRoundedLikeOneWhoseScaleWasApplied) {
  const fs::path folder = reports("unapplied-scale");
  if (folder.empty()) GTEST_SKIP() << "no folder of reports beside the sources";
  std::ifstream in(folder / "wall-scaled.scene.json");
  std::string text{std::istreambuf_iterator<char>(in), {}};
  const std::string key = "\"radius\"";
  ASSERT_NE(text.find(key), std::string::npos);
  text.replace(text.find(key), key.size(), "\"radius_world\"");
  const TemporaryFolder copy;
  fs::copy(folder, copy.path());
  copy.write("wall-scaled.scene.json", text);
  expectSameHits(loadScene(copy.path() / "wall-scaled.scene.json", copy.path(), "a"),
                 loadScene(copy.path() / "wall-applied.scene.json", copy.path(), "b"));
}

TEST(Reports, PostStandsUpright) {
  const fs::path folder = reports("y-up");
  if (folder.empty()) GTEST_SKIP() << "no folder of reports beside the sources";
  const auto y = loadScene(folder / "post-y-up.obj", folder, "a", UpAxis::Y);
  const auto z = loadScene(folder / "post-z-up.obj", folder, "b");
  EXPECT_EQ(y->bounds.lower, z->bounds.lower);
  EXPECT_EQ(y->bounds.upper, z->bounds.upper);
}

TEST(Reports, SmallEnvironmentsLoadAndWhatIsNoLightIsNamed) {
  const fs::path folder = reports("environment-small");
  if (folder.empty()) GTEST_SKIP() << "no folder of reports beside the sources";
  const auto warnings = [&](const char* name) {
    return loadScene(folder / (std::string(name) + ".scene.json"), folder, name)->warnings;
  };
  EXPECT_THAT(warnings("negative-pixel"),
              testing::ElementsAre(AllOf(HasSubstr("\"neg.exr\""), HasSubstr("pixel 7,0"))));
  EXPECT_THAT(warnings("inf-sun"),
              testing::ElementsAre(AllOf(HasSubstr("\"inf-sun.exr\""), HasSubstr("pixel 20,6"))));
  for (const char* name : {"one-pixel", "colour", "sun", "black-with-lamp", "none-with-lamp"})
    EXPECT_THAT(warnings(name), testing::IsEmpty()) << name;
}

} // namespace
} // namespace chamfer
