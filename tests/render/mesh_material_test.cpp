// Materials of a mesh file's own library in a scene: where their images are found, how they lie, and what is
// told.
#include "server/render/image/image_io.h"
#include "server/render/scene/scene_data.h"
#include "server/render/surface/tangent_frame.h"
#include "tests/render/scene_files_fixture.h"

#include <gmock/gmock.h>

namespace chamfer {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

const std::string kBox = "usemtl m\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n" + test::cubeObj();

/// The cube with this library beside it, as a scene that holds it alone: without the note about the sidecar.
std::shared_ptr<const Scene> withLibrary(const TemporaryFolder& folder, const std::string& library,
                                         const std::string& below = "") {
  folder.write(below + "m.mtl", library);
  folder.write(below + "a.obj", "mtllib m.mtl\n" + kBox);
  return loadScene(folder.write("a.scene.json", R"({"meshes":[{"name":"m","file":")" + below +
                                                    R"(a.obj"}],"instances":[{"mesh":"m"}]})"),
                   folder.path(), "a");
}

const Material& materialOf(const Scene& scene) {
  return scene.data->materials[scene.data->meshMaterials[0].ofTriangle[0]];
}

void writeColor(const fs::path& file, float red, float green) {
  fs::create_directories(file.parent_path());
  writeImage(file, {1, 1, {red, green, 0, 1}});
}

TEST(MeshMaterial, ImagesAreFoundByTheirNamesAsWritten) {
  const TemporaryFolder outside, folder;
  writeColor(outside.path() / "secret.exr", 0, 1);
  writeColor(folder.path() / "tex/Wood.exr", 1, 0);
  writeColor(folder.path() / "tex/wood grain #2.exr", 1, 0);
  writeColor(folder.path() / "set/tex/Near.exr", 1, 0);
  fs::create_symlink(outside.path() / "secret.exr", folder.path() / "tex/link.exr");
  const std::string gone = "there is no such file below the served folder";
  const struct {
    std::string name, warning; ///< empty: none
    bool found;
  } kRows[] = {
      {"../tex/Wood.exr", "", true}, // ".." that stays below the root
      {"..\\tex\\Wood.exr", "", true},
      {"..\\\\tex\\\\Wood.exr", "", true},
      {"./tex/Near.exr", "", true},
      {"../tex/wood grain #2.exr", "", true},
      {"\"../tex/Wood.exr\"", "", true},
      {"../tex/Wood.exr # oak", "", true},
      {"Tex/near.EXR", "\"tex/Near.exr\" is used", true},
      {"C:\\Users\\someone\\tex\\Near.exr", "\"tex/Near.exr\" is used", true},
      {"/home/someone/TEX/near.exr", "\"tex/Near.exr\" is used", true},
      {"\\\\server\\share\\tex\\Near.exr", "\"tex/Near.exr\" is used", true},
      {"other/tex/Near.exr", "\"tex/Near.exr\" is used", true},
      {"none.exr", gone, false},
      {"../tex/link.exr", gone, false},
      {"../../" + outside.path().filename().string() + "/secret.exr", gone, false},
      {(outside.path() / "secret.exr").string(), gone, false},
      {std::string("\x01\xff.exr"), "\"\\x01\\xff.exr\": " + gone, false},
  };
  for (const auto& row : kRows) {
    SCOPED_TRACE(row.name);
    const auto scene = withLibrary(folder, "newmtl m\nmap_Kd " + row.name + "\n", "set/");
    const Material& material = materialOf(*scene);
    ASSERT_EQ(material.baseColorTexture != kNoTexture, row.found);
    if (row.found) {
      EXPECT_EQ(scene->data->textures[material.baseColorTexture].at(0.5f, 0.5f), (Color{1, 0, 0}));
    }
    if (row.warning.empty()) {
      EXPECT_THAT(scene->warnings, IsEmpty());
    } else {
      EXPECT_THAT(scene->warnings, ElementsAre(AllOf(StartsWith("m.mtl:2: "), HasSubstr(row.warning),
                                                     Not(HasSubstr(folder.path().string())))));
    }
  }
}

TEST(MeshMaterial, AnImageThatComesLaterIsKnown) {
  const TemporaryFolder folder;
  const auto scene = withLibrary(folder, "newmtl m\nmap_Kd tex/late.exr\n");
  EXPECT_THAT(scene->files, Contains(fs::canonical(folder.path()) / "tex/late.exr"));
}

/// Black, but for red in the left half and green in the lower half.
Texture quarters() { return {2, 2, {{1, 0, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}}}; }

TEST(MeshMaterial, PlacementMovesTheLookUp) {
  const Texture image = quarters();
  const struct {
    TexturePlacement placement;
    float u, v, sameAsU, sameAsV; ///< the place in the image as it is
  } kRows[] = {
      {{}, 0.25f, 0.25f, 0.25f, 0.25f},
      {{}, 1.25f, -0.75f, 0.25f, 0.25f},
      {{{2, 1}, {0, 0}, false}, 0.375f, 0.25f, 0.75f, 0.25f},
      {{{2, 1}, {0, 0}, false}, 0.75f, 0.25f, 0.5f, 0.25f},
      {{{1, 4}, {0, 0}, false}, 0.25f, 0.1875f, 0.25f, 0.75f},
      {{{1, 1}, {0.5f, 0}, false}, 0.25f, 0.25f, 0.75f, 0.25f},
      {{{1, 1}, {0, 0.5f}, false}, 0.25f, 0.25f, 0.25f, 0.75f},
      {{{-1, 1}, {1, 0}, false}, 0.25f, 0.25f, 0.75f, 0.25f},
      {{{1, 10}, {0, -7}, true}, 0.25f, 0.725f, 0.25f, 0.25f},
      {{{1, 10}, {0, -7}, true}, 0.25f, 0.1f, 0.25f, 0.25f},  // below: the lower border
      {{{1, 10}, {0, -7}, true}, 0.25f, 0.95f, 0.25f, 0.75f}, // above: the upper one
      {{{1, 1}, {0, 0}, true}, -3, 0.25f, 0.25f, 0.25f},
      {{{1, 1}, {0, 0}, true}, 1e38f, 0.25f, 0.75f, 0.25f},
  };
  for (const auto& row : kRows) {
    const Color c = image.placed(row.placement).at(row.u, row.v), same = image.at(row.sameAsU, row.sameAsV);
    EXPECT_NEAR(c.r, same.r, 1e-5) << row.u << " " << row.v;
    EXPECT_NEAR(c.g, same.g, 1e-5) << row.u << " " << row.v;
  }
  const Color huge = image.placed({{1e38f, 1}, {1e38f, 0}, false}).at(1e10f, 0);
  EXPECT_TRUE(isFinite(huge));
}

TEST(MeshMaterial, OptionsOfTheLibraryReachTheTexture) {
  const TemporaryFolder folder;
  writeColor(folder.path() / "a.exr", 0.5f, 0.5f);
  writeImage(folder.path() / "n.exr", {1, 1, {0.75f, 0.5f, 0.9f, 1}});
  const auto scene = withLibrary(
      folder, "newmtl m\nmap_Kd -s 4 2 1 a.exr -o .5 .25 -clamp on\nmap_Pr a.exr\nnorm n.exr -bm .5\n");
  EXPECT_THAT(scene->warnings, IsEmpty());
  const Material& m = materialOf(*scene);
  EXPECT_EQ(scene->data->textures[m.baseColorTexture].placement(),
            (TexturePlacement{{4, 2}, {0.5f, 0.25f}, true}));
  EXPECT_EQ(scene->data->textures[m.roughnessTexture].placement(), TexturePlacement{});
  EXPECT_FLOAT_EQ(m.normalStrength, 0.5f);
  // What is placed twice is held once.
  const auto twice = withLibrary(folder, "newmtl m\nmap_Kd a.exr\nnewmtl n\nmap_Kd -s 2 a.exr\n");
  ASSERT_EQ(twice->data->textures.size(), 2u);
  EXPECT_EQ(twice->data->textures[0].pixels(), twice->data->textures[1].pixels());
  // Another placement is another picture.
  const auto id = [&](const std::string& options) {
    return withLibrary(folder, "newmtl m\nmap_Kd " + options + "a.exr\nnorm -bm 1 n.exr\n")->id.hex();
  };
  EXPECT_EQ(id(""), id(""));
  for (const std::string options : {"-s 2 ", "-o .5 ", "-clamp on "})
    EXPECT_NE(id(options), id("")) << options;
}

TEST(MeshMaterial, TheStrengthOfANormalTextureScalesWhatItLeans) {
  const TangentFrame frame{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const Color texel{0.75f, 0.5f, 1};
  const auto lean = [&](double u, double v) {
    const Vector3 n = frame.turned(texel, {u, v});
    return n.x / n.z;
  };
  EXPECT_NEAR(lean(1, 1), 0.5, 1e-6);
  EXPECT_NEAR(lean(0.5, 1), 0.25, 1e-6);
  EXPECT_NEAR(lean(-1, 1), -0.5, 1e-6);
  EXPECT_EQ(frame.turned(texel, {0, 0}), Vector3(0, 0, 1));
}

TEST(MeshMaterial, WhatReadingWarnsOfIsInTheSceneOnceAndBounded) {
  const TemporaryFolder folder;
  folder.write("m.mtl", "newmtl m\nKs 1 1 1\nillum 4\n");
  folder.write("a.obj", "mtllib m.mtl\nl 1 2\n" + kBox);
  std::string meshes, instances;
  for (int i = 0; i < 80; ++i) {
    const std::string name = "m" + std::to_string(i);
    meshes += (i ? "," : "") + (R"({"name":")" + name + R"(","file":"a.obj","radius":0.1})");
    instances += (i ? "," : "") + (R"({"mesh":")" + name + R"("})");
  }
  const auto load = [&](const std::string& m, const std::string& i) {
    return loadScene(folder.write("a.scene.json", R"({"meshes":[)" + m + R"(],"instances":[)" + i + "]}"),
                     folder.path(), "a");
  };
  const auto one = load(R"({"name":"m0","file":"a.obj","radius":0.1})", R"({"mesh":"m0"})");
  EXPECT_THAT(one->warnings,
              ElementsAre(StartsWith("meshes[0]: line 2: \"l\""),
                          HasSubstr("m.mtl: keys that are not used: Ks (line 2), illum (line 3)")));
  const auto many = load(meshes, instances);
  EXPECT_EQ(many->warnings.size(), 101u);
  EXPECT_THAT(many->warnings.back(), StartsWith("and 60 more"));
}

const fs::path kReports = CHAMFER_SOURCE_DIR "/../shared/data/reports";

TEST(MeshMaterial, EveryKindOfImageIsTheSamePicture) {
  const fs::path folder = kReports / "texture-kinds";
  if (!fs::is_directory(folder)) GTEST_SKIP() << "the reports are not beside the project";
  const auto read = [&](const std::string& name) {
    std::vector<std::string> warnings;
    Texture texture = readTexture(folder / name, PixelEncoding::Automatic, name, warnings);
    EXPECT_THAT(warnings, testing::IsEmpty()) << name;
    return texture;
  };
  const struct {
    const char *kind, *plain;
    float tolerance; ///< of JPEG's loss where only one of the two has it
  } kRows[] = {
      {"rgb16.png", "rgb8.png", 1e-6f},         {"rgba16.png", "rgb8.png", 1e-6f},
      {"palette.png", "rgb8.png", 1e-6f},       {"grey8.png", "grey-as-rgb.png", 1e-6f},
      {"grey16.png", "grey-as-rgb.png", 1e-6f}, {"greyalpha8.png", "grey-as-rgb.png", 1e-6f},
      {"grey.jpg", "grey-as-rgb.png", 0.05f},   {"rgb.jpg", "rgb8.png", 0.05f},
      {"cmyk.jpg", "rgb8.png", 0.05f},
  };
  for (const auto& row : kRows) {
    SCOPED_TRACE(row.kind);
    const Texture kind = read(row.kind), plain = read(row.plain);
    ASSERT_EQ(kind.width() % plain.width(), 0u);
    ASSERT_EQ(kind.height() % plain.height(), 0u);
    const unsigned zoom = kind.width() / plain.width(); // the JPEGs show each pixel as a block
    float worst = 0;
    for (unsigned y = 0; y < kind.height(); ++y)
      for (unsigned x = 0; x < kind.width(); ++x) {
        const Color &a = kind.pixel(x, y), &b = plain.pixel(x / zoom, y / zoom);
        worst = std::max({worst, std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
      }
    EXPECT_LE(worst, row.tolerance);
  }
}

TEST(MeshMaterial, ReportedFilesHaveTheirImages) {
  if (!fs::is_directory(kReports)) GTEST_SKIP() << "the reports are not beside the project";
  const struct {
    const char* file;
    TexturePlacement placement;
    bool warned;
  } kRows[] = {
      {"mtl-texture-paths/slash.obj", {}, false},
      {"mtl-texture-paths/backslash.obj", {}, false},
      {"mtl-texture-paths/double-backslash.obj", {}, false},
      {"mtl-texture-paths/dot-slash.obj", {}, false},
      {"mtl-texture-paths/space.obj", {}, false},
      {"mtl-texture-paths/trailing-blank.obj", {}, false},
      {"mtl-texture-paths/case.obj", {}, true},
      {"mtl-texture-paths/absolute.obj", {}, true},
      {"mtl-texture-paths/models/up.obj", {}, false},
      {"mtl-texture-options/plain.obj", {}, false},
      {"mtl-texture-options/scaled.obj", {{4, 4}, {0, 0}, false}, false},
      {"mtl-texture-options/offset.obj", {{1, 1}, {0.5f, 0}, false}, false},
      {"mtl-texture-options/mixed.obj", {{1, 10}, {0, -7}, true}, false},
      {"mtl-texture-options/option-behind.obj", {}, true},
  };
  for (const auto& row : kRows) {
    SCOPED_TRACE(row.file);
    const auto scene = loadScene(kReports / row.file, kReports, "a");
    const Material& m = materialOf(*scene);
    ASSERT_NE(m.baseColorTexture, kNoTexture);
    EXPECT_EQ(scene->data->textures[m.baseColorTexture].placement(), row.placement);
    EXPECT_EQ(scene->warnings.size(), row.warned ? 2u : 1u) << "beside the note that there is no sidecar";
  }
  const struct {
    const char* file;
    float transmission;
  } kPanes[] = {{"Tf", 0},      {"d-and-Tr-equal", 0.7f}, {"d-zero", 1},
                {"halo", 0.4f}, {"max-d1-Tr0", 0},        {"meshlab-Tr1", 1}};
  for (const auto& pane : kPanes)
    EXPECT_FLOAT_EQ(materialOf(*loadScene(kReports / "transparency-keys" / (std::string(pane.file) + ".obj"),
                                          kReports, "a"))
                        .transmission,
                    pane.transmission)
        << pane.file;
}

} // namespace
} // namespace chamfer
