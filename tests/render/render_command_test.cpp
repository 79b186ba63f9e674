#include "server/render/cli/render_command.h"

#include "server/render/image/image_io.h"
#include "server/render/request/render_words.h"
#include "tests/render/scene_files_fixture.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace chamfer {
namespace {

using test::TemporaryFolder;
using test::thrownBy;
using testing::StartsWith;

RenderCommandOptions optionsFor(const TemporaryFolder& folder, const char* output) {
  writeMeshes(folder);
  RenderCommandOptions o;
  o.scene = folder.path() / "cube.obj";
  o.output = folder.path() / output;
  o.width = 32;
  o.height = 18;
  o.samples = 2;
  o.quiet = true;
  return o;
}

TEST(RenderCommand, WritesThePictureThatRenderTileGives) {
  const TemporaryFolder folder;
  RenderCommandOptions o = optionsFor(folder, "a.exr");
  o.radius = 0.2;
  o.eye = Point3(2, -3, 2);
  o.target = Point3(0, 0, 0);
  o.vfovDegrees = 25;
  EXPECT_EQ(runRenderCommand(o), 0);
  std::vector<std::string> warnings;
  const Texture written = readTexture(o.output, PixelEncoding::Automatic, "a.exr", warnings);
  const auto scene = loadScene(o.scene, folder.path(), "cube");
  RenderSettings s;
  s.width = 32;
  s.height = 18;
  s.endSample = 2;
  s.camera = scene->camera;
  s.camera->eye = *o.eye;
  s.camera->target = *o.target;
  s.camera->vfovDegrees = 25;
  const Image image = renderTile(*prepare(scene, {RoundingMode::Analytic, 0, 0.2}), s, {0, 0, 32, 18}).image;
  for (unsigned i = 0; i < 32 * 18; ++i)
    ASSERT_EQ(written.pixel(i % 32, i / 32),
              (Color{image.rgba[4 * i], image.rgba[4 * i + 1], image.rgba[4 * i + 2]}));
}

TEST(RenderCommand, ExtensionsAreReadInAnyCase) {
  const TemporaryFolder folder;
  const RenderCommandOptions o = optionsFor(folder, "A.PNG");
  EXPECT_EQ(runRenderCommand(o), 0);
  EXPECT_TRUE(std::filesystem::exists(o.output));
}

TEST(RenderCommand, ABareMeshMayBeYUp) {
  const TemporaryFolder folder;
  RenderCommandOptions o = optionsFor(folder, "a.exr");
  o.eye = Point3(9, -9, 9);
  o.target = Point3(0, 0, 1);
  const auto picture = [&](const Point3& lower, const Point3& upper, std::optional<UpAxis> up) {
    o.scene = folder.write("box.obj", test::boxObj(lower, upper));
    o.upAxis = up;
    EXPECT_EQ(runRenderCommand(o), 0);
    std::vector<std::string> warnings;
    return readTexture(o.output, PixelEncoding::Automatic, "a.exr", warnings);
  };
  const Texture upright = picture({0, -2, 0}, {1, 0, 3}, {});
  const auto differing = [&](const Texture& other) {
    int count = 0;
    for (unsigned i = 0; i < 32 * 18; ++i)
      count += std::abs(other.pixel(i % 32, i / 32).g - upright.pixel(i % 32, i / 32).g) > 1e-3f;
    return count;
  };
  EXPECT_LE(differing(picture({0, 0, 0}, {1, 3, 2}, UpAxis::Y)), 3); // y to z, z to -y
  EXPECT_GT(differing(picture({0, 0, 0}, {1, 3, 2}, UpAxis::Z)), 30);
  o.scene = folder.write("s.scene.json", "{}");
  o.upAxis = UpAxis::Y;
  EXPECT_THAT(thrownBy([&] { runRenderCommand(o); }), StartsWith("usage: --up-axis is for a bare mesh"));
}

TEST(RenderCommand, ReportsAsJsonWhatItTook) {
  const TemporaryFolder folder;
  RenderCommandOptions o = optionsFor(folder, "a.png");
  o.quiet = false;
  o.json = true;
  o.radius = 0.2;
  testing::internal::CaptureStdout();
  runRenderCommand(o);
  const auto j = nlohmann::json::parse(testing::internal::GetCapturedStdout());
  EXPECT_EQ(j["samples"], 32 * 18 * 2);
  EXPECT_EQ(j["rounding"], "analytic");
  EXPECT_EQ(j["radius"], 0.2);
  EXPECT_EQ(j["triangles"], 12 + 2 + 2) << "the cube, the studio's ground and its light";
  for (const char* stage : {"load", "prepare", "render", "write"})
    EXPECT_GE(j["seconds"][stage].get<double>(), 0) << stage;
  EXPECT_NEAR(j["samples_per_second"].get<double>() * j["seconds"]["render"].get<double>(), 32 * 18 * 2,
              1e-6);
  EXPECT_GT(j["peak_resident_bytes"], j["memory_bytes"]);
  const auto& rays = j["rays"];
  EXPECT_EQ(rays["camera"]["traced"], 32 * 18 * 2);
  std::uint64_t traced = 0;
  for (const char* kind : {"camera", "bounce", "shadow"}) {
    const auto& count = rays[kind];
    traced += count["traced"].get<std::uint64_t>();
    EXPECT_LE(count["hits"], count["traced"]) << kind;
    EXPECT_LT(count["rounded"], count["hits"]) << kind;
    EXPECT_GT(count["rounded"], 0) << kind;
    EXPECT_DOUBLE_EQ(count["rounded_share"].get<double>(),
                     count["rounded"].get<double>() / count["traced"].get<double>());
  }
  EXPECT_EQ(rays["all"]["traced"], traced);
}

TEST(RenderCommand, LeavesNothingBehindWhenItFails) {
  const TemporaryFolder folder;
  const auto thrown = [&](const char* output, auto&& change) {
    RenderCommandOptions o = optionsFor(folder, output);
    change(o);
    return thrownBy([&] { runRenderCommand(o); });
  };
  EXPECT_THAT(thrown("a.jpg", [](auto&) {}), StartsWith("usage: "));
  EXPECT_THAT(thrown("a.png", [](auto& o) { o.rounding = "soft"; }), StartsWith("usage: "));
  EXPECT_THAT(thrown("a.png", [](auto& o) { o.aov = "colour"; }), StartsWith("usage: "));
  EXPECT_THAT(thrown("a.png", [](auto& o) { o.radius = 0.6; }), StartsWith("radius-too-large: "));
  EXPECT_THAT(thrown("a.png", [](auto& o) { o.scene += ".none"; }), StartsWith("not-found: "));
  EXPECT_THAT(thrown("a.png", [](auto& o) { o.samples = 0; }), StartsWith("out-of-range: "));
  EXPECT_THAT(thrown("none/a.png", [](auto&) {}), StartsWith("cannot-write: "));
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    EXPECT_EQ(entry.path().extension(), ".obj") << entry.path();
}

TEST(RenderWords, AreReadBack) {
  for (const char* word : {"none", "analytic", "mesh:7", "bevel:256"})
    EXPECT_EQ(roundingWord(parseRounding(word)), word);
  for (const char* word : {"beauty", "albedo", "normal", "geometric_normal", "depth", "feature", "instance"})
    EXPECT_STREQ(aovWord(parseAov(word)), word);
  EXPECT_THAT(thrownBy([] { parseRounding("mesh:0"); }), StartsWith("out-of-range: "));
  EXPECT_THAT(thrownBy([] { parseRounding("bevel:257"); }), StartsWith("out-of-range: "));
  EXPECT_THAT(thrownBy([] { parseRounding("mesh:99999999999999999999"); }), StartsWith("out-of-range: "));
  for (const char* word : {"", "mesh", "mesh:", "mesh:x", "mesh:4x", "mesh:-4", "mesh: 4", "Analytic"})
    EXPECT_THAT(thrownBy([&] { parseRounding(word); }), StartsWith("usage: ")) << word;
}

} // namespace
} // namespace chamfer
