#include "server/render/image/image_io.h"
#include "server/render/path/camera.h"
#include "server/render/scene/scene_data.h"
#include "tests/render/scene_files_fixture.h"

#include <gmock/gmock.h>

namespace chamfer {
namespace {

namespace fs = std::filesystem;
using test::loadText;
using test::TemporaryFolder;
using test::thrownBy;
using testing::HasSubstr;
using testing::StartsWith;

void writeSidecarFor(const fs::path& mesh, double radius) {
  PreprocessOptions options;
  options.radius = {radius, false};
  fs::path sidecar = mesh;
  sidecar += ".chamfer";
  writeSidecar(sidecar, *preprocess(readMesh(mesh), options).rounding);
}

std::shared_ptr<const Scene> loadMesh(const TemporaryFolder& folder, const char* name = "cube.obj") {
  return loadScene(folder.path() / name, folder.path(), "cube");
}

std::string oneMesh(const std::string& mesh, const std::string& more = "") {
  return R"({"meshes":[{"name":"m",)" + mesh + R"(}],"instances":[{"mesh":"m"}])" + more + "}";
}

TEST(LoadScene, ABareMeshWithItsSidecarGetsAStudio) {
  const TemporaryFolder folder;
  writeMeshes(folder);
  writeSidecarFor(folder.path() / "cube.obj", 0.1);
  const auto scene = loadMesh(folder);
  EXPECT_EQ(scene->name, "cube");
  ASSERT_EQ(scene->meshes.size(), 1u);
  EXPECT_FLOAT_EQ(float(scene->meshes[0].radius), 0.1f);
  EXPECT_NEAR(scene->meshes[0].maxRadius, 0.5, 1e-9);
  EXPECT_EQ(scene->triangles, 12u);
  EXPECT_EQ(scene->roundedEdges, 12u);
  EXPECT_EQ(scene->instances.size(), 1u);
  EXPECT_TRUE(scene->warnings.empty());
  EXPECT_EQ(scene->bounds.lower, Point3(-0.5, -0.5, -0.5));
  EXPECT_EQ(scene->data->extraInstances.size(), 2u) << "ground and light";
  EXPECT_NO_THROW(validateCamera(scene->camera));
  // The studio is seen but is not the scene's own.
  const auto prepared = prepare(scene, {});
  const Ray down{{3, 3, 3}, {0, 0, -1}};
  EXPECT_FALSE(ownTracer(*prepared).intersect(down).has_value());
  EXPECT_TRUE(ownTracer(*prepared).intersect({{0.2, 0.1, 3}, {0, 0, -1}}).has_value());
}

TEST(LoadScene, ABareMeshWithoutSidecarStaysSharpUntilARadiusIsGiven) {
  const TemporaryFolder folder;
  writeMeshes(folder);
  const auto scene = loadMesh(folder);
  EXPECT_EQ(scene->meshes[0].rounding, nullptr);
  EXPECT_THAT(scene->warnings, testing::ElementsAre(HasSubstr("no sidecar")));
  const Ray atCorner{{0.49, 0.49, 3}, {0, 0, -1}};
  EXPECT_TRUE(ownTracer(*prepare(scene, {})).intersect(atCorner).has_value());
  EXPECT_FALSE(ownTracer(*prepare(scene, {RoundingMode::Analytic, 0, 0.2})).intersect(atCorner).has_value());
}

TEST(LoadScene, StaleAndDamagedSidecarsOfABareMeshAreRefused) {
  const TemporaryFolder folder;
  writeMeshes(folder);
  writeSidecarFor(folder.path() / "cube.obj", 0.1);
  folder.write("cube.obj", test::boxObj({0, 0, 0}, {1, 1, 2}));
  EXPECT_THAT(thrownBy([&] { loadMesh(folder); }), StartsWith("stale-sidecar: "));
  folder.write("cube.obj.chamfer", "CHAMFER but not really");
  EXPECT_THAT(thrownBy([&] { loadMesh(folder); }), StartsWith("damaged-sidecar: "));
}

TEST(LoadScene, WhichRoundingAMeshGetsIsDecidedByTheFiles) {
  const TemporaryFolder folder;
  writeMeshes(folder);
  const auto radiusOf = [&](const std::string& mesh) {
    return loadText(folder, oneMesh(mesh))->meshes[0].radius;
  };
  EXPECT_EQ(radiusOf(R"("file":"cube.obj")"), 0) << "no radius, no sidecar";
  EXPECT_FLOAT_EQ(float(radiusOf(R"("file":"cube.obj","radius":0.2)")), 0.2f);
  EXPECT_NEAR(radiusOf(R"("file":"cube.obj","radius":"10%")"), 0.1 * std::sqrt(3.0), 1e-6);
  writeSidecarFor(folder.path() / "cube.obj", 0.1);
  EXPECT_FLOAT_EQ(float(radiusOf(R"("file":"cube.obj")")), 0.1f);
  EXPECT_FLOAT_EQ(float(radiusOf(R"("file":"cube.obj","radius":0.2)")), 0.2f)
      << "another radius than the sidecar's";
  EXPECT_EQ(radiusOf(R"("file":"cube.obj","rounding":false)"), 0);
  folder.write("cube.obj.chamfer", "broken");
  const auto scene = loadText(folder, oneMesh(R"("file":"cube.obj","radius":0.2)"));
  EXPECT_FLOAT_EQ(float(scene->meshes[0].radius), 0.2f);
  EXPECT_THAT(scene->warnings, testing::ElementsAre(StartsWith("meshes[0]: the sidecar is not used")));
  EXPECT_THAT(thrownBy([&] { radiusOf(R"("file":"cube.obj")"); }),
              StartsWith("damaged-sidecar: test.scene.json: meshes[0]: "));
}

TEST(LoadScene, FilesAreNamedOnlyBelowTheRoot) {
  const TemporaryFolder outside, folder;
  outside.write("secret.obj", test::cubeObj());
  writeMeshes(folder);
  fs::create_symlink(outside.path() / "secret.obj", folder.path() / "link.obj");
  fs::create_directory_symlink(outside.path(), folder.path() / "linked");
  fs::create_symlink(folder.path() / "cube.obj", folder.path() / "inside.obj");
  const auto thrown = [&](const std::string& file) {
    return thrownBy([&] { loadText(folder, oneMesh("\"file\":\"" + file + "\"")); });
  };
  EXPECT_THAT(thrown("../x.obj"), StartsWith("malformed: test.scene.json: meshes[0]: \"../x.obj\": \"..\""));
  EXPECT_THAT(thrown("a/../cube.obj"), HasSubstr("\"..\""));
  EXPECT_THAT(thrown((outside.path() / "secret.obj").string()), HasSubstr("relative"));
  EXPECT_THAT(thrown("link.obj"), HasSubstr("outside"));
  EXPECT_THAT(thrown("linked/secret.obj"), HasSubstr("outside"));
  EXPECT_THAT(thrown("none.obj"), StartsWith("not-found: "));
  EXPECT_THAT(thrown("."), StartsWith("not-found: "));
  EXPECT_THAT(thrown("cube.obj\\u0000.png"), HasSubstr("zero character"));
  EXPECT_EQ(thrown("inside.obj"), "nothing") << "a link that stays below is no harm";
}

TEST(LoadScene, TheIdIsADigestOfEverythingThatIsSeen) {
  const TemporaryFolder folder;
  const auto id = [&](const std::string& json) { return loadText(folder, json)->id.hex(); };
  const std::string textured =
      R"({"meshes":[{"name":"m","file":"cube.obj"}],"materials":[{"name":"t","base_color_texture":"t.exr"}],
      "instances":[{"mesh":"m","material":"t"}]})";
  writeImage(folder.path() / "t.exr", {1, 1, {1, 0, 0, 1}});
  const std::string plain = oneMesh(R"("file":"cube.obj")");
  const std::string first = id(plain), firstTextured = id(textured);
  EXPECT_EQ(id(plain), first) << "loading again changes nothing";
  EXPECT_NE(id(oneMesh(R"("file":"cube.obj","radius":0.2)")), first);
  writeSidecarFor(folder.path() / "cube.obj", 0.1);
  const std::string rounded = id(plain);
  EXPECT_NE(rounded, first);
  writeSidecarFor(folder.path() / "cube.obj", 0.11);
  EXPECT_NE(id(plain), rounded);
  fs::remove(folder.path() / "cube.obj.chamfer");
  EXPECT_EQ(id(plain), first);
  writeImage(folder.path() / "t.exr", {1, 1, {0, 1, 0, 1}});
  EXPECT_NE(id(textured), firstTextured);
  folder.write("other/cube.obj", test::cubeObj());
  const auto elsewhere = loadScene(folder.write("other/b.scene.json", plain), folder.path(), "other/b");
  EXPECT_EQ(elsewhere->id.hex(), first) << "neither name nor place is seen";
}

TEST(LoadScene, MaterialsOfTheMeshFileAreUsedWhereAnInstanceNamesNone) {
  const TemporaryFolder folder;
  folder.write("m.mtl",
               "newmtl red\nKd 0.5 0 0\nPr 0.7\nPm 1\nnewmtl lamp\nKd 0 0 0\nKe 3 3 3\nmap_Kd none.png\n");
  folder.write("two.obj", "mtllib m.mtl\nusemtl red\n" + test::cubeObj() + "usemtl lamp\nf 1 3 4 2\n");
  const auto scene = loadText(folder, oneMesh(R"("file":"two.obj")"));
  const SceneData& data = *scene->data;
  const auto& own = data.meshMaterials[0].ofTriangle;
  ASSERT_EQ(own.size(), 14u);
  EXPECT_EQ(data.materials[own[0]].name, "red");
  EXPECT_FLOAT_EQ(data.materials[own[0]].roughness, 0.7f);
  EXPECT_EQ(data.materials[own[13]].emission, grey(3));
  EXPECT_THAT(scene->warnings, testing::Contains(HasSubstr("none.png")));
}

TEST(Prepare, RefusesARadiusThatIsTooLargeAndNamesTheLargest) {
  const TemporaryFolder folder;
  const auto scene = loadText(folder, R"({"meshes":[{"name":"big","file":"box2.obj","radius":0.2},
      {"name":"small","file":"cube.obj","radius":0.2},{"name":"floor","file":"floor.obj"}],
      "instances":[{"mesh":"big"},{"mesh":"small"},{"mesh":"floor"}]})");
  const auto thrown = [&](const RoundingChoice& c) { return thrownBy([&] { prepare(scene, c); }); };
  EXPECT_EQ(thrown({RoundingMode::Analytic, 0, 0.49}), "nothing");
  EXPECT_THAT(thrown({RoundingMode::Analytic, 0, 0.5}), StartsWith("radius-too-large: "));
  EXPECT_THAT(thrown({RoundingMode::Analytic, 0, 0.7}),
              HasSubstr("below 0.5, the inradius of mesh \"small\""));
  EXPECT_THAT(thrown({RoundingMode::Analytic, 0, 0.0}), StartsWith("out-of-range: "));
  EXPECT_THAT(thrown({RoundingMode::Analytic, 0, NAN}), StartsWith("out-of-range: "));
  for (const RoundingMode mode : {RoundingMode::Mesh, RoundingMode::Bevel}) {
    EXPECT_EQ(thrown({mode, 4, 0.49}), "nothing");
    EXPECT_THAT(thrown({mode, 4, 0.5}), StartsWith("radius-too-large: "));
  }
  EXPECT_THAT(thrown({RoundingMode::Bevel, 257, {}}), StartsWith("out-of-range: "));
}

TEST(Prepare, OnlyWhatIsRoundedFollowsTheRadius) {
  const TemporaryFolder folder;
  const auto scene = loadText(folder, R"({"meshes":[{"name":"cube","file":"cube.obj","radius":0.1},
      {"name":"box","file":"box2.obj"}],
      "instances":[{"mesh":"cube"},{"mesh":"box","translate":[5,0,0]}]})");
  const auto hits = [&](const RoundingChoice& c, double x, double y) {
    return ownTracer(*prepare(scene, c)).intersect({{x, y, 4}, {0, 0, -1}}).has_value();
  };
  const RoundingChoice none{RoundingMode::None, 0, {}}, analytic{}, wide{RoundingMode::Analytic, 0, 0.4};
  EXPECT_TRUE(hits(none, 0.49, 0.49));
  EXPECT_FALSE(hits(analytic, 0.49, 0.49));
  EXPECT_TRUE(hits(analytic, 0.45, 0.45));
  EXPECT_FALSE(hits(wide, 0.45, 0.45));
  EXPECT_TRUE(hits(wide, 5.99, 0.99)) << "a mesh without a radius stays sharp";
}

TEST(Camera, RefusesWhatIsNotACamera) {
  const auto thrown = [](auto&& change) {
    Camera c;
    change(c);
    return thrownBy([&] { validateCamera(c); });
  };
  EXPECT_THAT(thrown([](Camera& c) { c.eye = c.target; }),
              StartsWith("out-of-range: camera: eye and target"));
  EXPECT_THAT(thrown([](Camera& c) { c.eye.x = NAN; }), HasSubstr("finite"));
  EXPECT_THAT(thrown([](Camera& c) { c.up = {0, 0, 0}; }), HasSubstr("up"));
  EXPECT_THAT(thrown([](Camera& c) { c.vfovDegrees = 0; }), HasSubstr("is 0"));
  EXPECT_THAT(thrown([](Camera& c) { c.apertureDiameter = -1; }), HasSubstr("aperture"));
}

TEST(Camera, RaysGoThroughTheirPixels) {
  Camera c;
  c.eye = {0, -10, 0};
  c.target = {0, 0, 0};
  c.up = {0, 0, 1};
  c.vfovDegrees = 90;
  const CameraRays rays(c, 200, 100);
  const auto through = [&](double x, double y) {
    const Ray r = rays.ray(x, y, {0.5f, 0.5f});
    return r.at(10 / r.direction.y); // in the target's plane, 20 high and 40 wide
  };
  EXPECT_NEAR(length(through(100, 50) - Point3(0, 0, 0)), 0, 1e-9);
  EXPECT_NEAR(length(through(0, 0) - Point3(-20, 0, 10)), 0, 1e-9);
  EXPECT_NEAR(length(through(200, 100) - Point3(20, 0, -10)), 0, 1e-9);
  // All rays of a lens meet in the focal plane.
  c.apertureDiameter = 2;
  c.focusDistance = 10;
  const CameraRays lens(c, 200, 100);
  for (const Float2 u : {Float2{0.1f, 0.9f}, {0.99f, 0.5f}}) {
    const Ray r = lens.ray(0, 0, u);
    EXPECT_LE(length(r.origin - c.eye), 1 + 1e-6);
    EXPECT_GT(length(r.origin - c.eye), 0.1);
    EXPECT_NEAR(length(r.at((0 - r.origin.y) / r.direction.y) - Point3(-20, 0, 10)), 0, 1e-9);
  }
}

TEST(LoadScene, CoordinatesThatRaysCannotReachAreRefusedByName) {
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& instances, const std::string& lights = "[]") {
    return test::thrownBy([&] {
      const auto scene = loadText(folder, R"({"meshes":[{"name":"cube","file":"cube.obj","radius":0.1},
        {"name":"far","file":"cube.obj"}],"instances":[)" +
                                              instances + R"(],"lights":)" + lights + "}");
      // What is taken can be rendered.
      RenderSettings s;
      s.width = s.height = 4;
      EXPECT_EQ(renderTile(*prepare(scene, {}), s, {0, 0, 4, 4}).statistics.nonFiniteSamples, 0u);
    });
  };
  const std::string one = R"({"mesh":"cube"})";
  using testing::HasSubstr;
  for (const char* culprit :
       {R"({"mesh":"far","scale":1e20})", R"({"mesh":"far","scale":1e-20})",
        R"({"mesh":"far","translate":[0,-1e20,0]})", R"({"mesh":"far","scale":[1,1,1e18]})",
        R"({"mesh":"far","repeat":[{"count":2,"step":[3e15,0,0]}]})"})
    EXPECT_THAT(refusal(one + "," + culprit), testing::AllOf(HasSubstr("(mesh \"far\")"), HasSubstr("scale")))
        << culprit;
  EXPECT_THAT(refusal(one, R"([{"type":"area","center":[0,0,1e20],"u":[1,0,0],"v":[0,1,0],"emission":1}])"),
              HasSubstr("area light 0"));
  EXPECT_THAT(refusal(one, R"([{"type":"point","position":[0,0,1e20],"intensity":1}])"),
              HasSubstr("point light 0"));
  for (const char* fine : {R"({"mesh":"far","scale":1e12})", R"({"mesh":"far","scale":1e-12})",
                           R"({"mesh":"far","translate":[0,-1e14,0]})"})
    EXPECT_EQ(refusal(one + "," + fine), "nothing") << fine;
}

} // namespace
} // namespace chamfer
