#include "server/render/render_command.h"

#include "server/render/image_io.h"
#include "server/render/render_words.h"
#include "tests/render/scene_files_fixture.h"

#include <gmock/gmock.h>

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
  const Texture written = readTexture(o.output, PixelEncoding::Automatic, "a.exr");
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
  for (const char* word : {"beauty", "albedo", "normal", "depth", "feature"})
    EXPECT_STREQ(aovWord(parseAov(word)), word);
  EXPECT_THAT(thrownBy([] { parseRounding("mesh:0"); }), StartsWith("out-of-range: "));
  EXPECT_THAT(thrownBy([] { parseRounding("bevel:257"); }), StartsWith("out-of-range: "));
  EXPECT_THAT(thrownBy([] { parseRounding("mesh:99999999999999999999"); }), StartsWith("out-of-range: "));
  for (const char* word : {"", "mesh", "mesh:", "mesh:x", "mesh:4x", "mesh:-4", "mesh: 4", "Analytic"})
    EXPECT_THAT(thrownBy([&] { parseRounding(word); }), StartsWith("usage: ")) << word;
}

} // namespace
} // namespace chamfer
