// Sides as people write them.
#include "server/jobs/suite/side.h"

#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>

namespace chamfer {
namespace {

using test::thrownBy;
using testing::HasSubstr;

TEST(Side, IsASceneWithParametersOfTiles) {
  const SideChoice side = parseSide("scenes/blocks.scene.json?rounding=mesh:8&radius=0.1&seed=7&bounces=3"
                                    "&samples=16&width=320&height=200&clamp=2&aov=albedo&radius_clamp=0.5");
  EXPECT_EQ(side.kind, SideKind::Scene);
  EXPECT_EQ(side.source, "scenes/blocks.scene.json");
  EXPECT_EQ(side.request.rounding.mode, RoundingMode::Mesh);
  EXPECT_EQ(side.request.rounding.count, 8u);
  EXPECT_EQ(side.request.settings.seed, 7u);
  EXPECT_EQ(side.request.settings.maxBounces, 3u);
  EXPECT_EQ(side.request.samples(), 16u);
  EXPECT_EQ(side.request.settings.width, 320u);
  EXPECT_EQ(side.request.settings.height, 200u);
  using Pair = std::pair<std::string, std::string>;
  EXPECT_THAT(settingsOf(side.request),
              testing::ElementsAre(Pair("rounding", "mesh:8"), Pair("radius", "0.1"),
                                   Pair("radius_clamp", "0.5"), Pair("seed", "7"), Pair("bounces", "3"),
                                   Pair("clamp", "2"), Pair("aov", "albedo")));
}

TEST(Side, LeavesTheFrameAndTheSamplesToTheCase) {
  const SideChoice side = parseSide("part.stl?up_axis=y");
  EXPECT_EQ(side.kind, SideKind::Scene);
  EXPECT_EQ(side.upAxis, UpAxis::Y);
  EXPECT_EQ(side.request.settings.width, 0u);
  EXPECT_EQ(side.request.samples(), 0u);
  EXPECT_TRUE(settingsOf(side.request).empty());
}

TEST(Side, IsATilesUrlWithOrWithoutItsServer) {
  for (const char* server : {"", "http://127.0.0.1:8080", "https://node.example"}) {
    const SideChoice side =
        parseSide(std::string(server) + "/v1/scenes/a%20b/c/tiles/640x360/32,16,64,48/4-8.exr?seed=3");
    EXPECT_EQ(side.kind, SideKind::Tile);
    EXPECT_EQ(side.source, "a b/c");
    EXPECT_EQ(side.request.tile, (TileRect{32, 16, 64, 48}));
    EXPECT_EQ(side.request.settings.firstSample, 4u);
    EXPECT_EQ(side.request.settings.endSample, 8u);
    EXPECT_EQ(side.request.settings.seed, 3u);
  }
  const SideChoice frame = parseSide("/v1/scenes/blocks/frames/64x36/0-4.png");
  EXPECT_EQ(frame.kind, SideKind::Tile);
  EXPECT_EQ(frame.request.tile, (TileRect{0, 0, 64, 36}));
}

TEST(Side, IsAnImageByItsName) {
  for (const char* name : {"a.exr", "b/c.PNG", "d.hdr", "e.jpeg"})
    EXPECT_EQ(parseSide(name).kind, SideKind::Image) << name;
  EXPECT_THAT(thrownBy([] { parseSide("a.exr?seed=1"); }), HasSubstr("takes no parameters"));
}

TEST(Side, IsADigest) {
  const SideChoice side = parseSide("digest:0123456789abcdef00000000000000ff");
  EXPECT_EQ(side.kind, SideKind::Digest);
  EXPECT_EQ(side.digest.hex(), "0123456789abcdef00000000000000ff");
  for (const char* wrong : {"digest:", "digest:12", "digest:0123456789ABCDEF00000000000000FF",
                            "digest:0123456789abcdef00000000000000fg"})
    EXPECT_THAT(thrownBy([&] { parseSide(wrong); }), HasSubstr("32 hexadecimal digits")) << wrong;
}

TEST(Side, RefusesWhatItDoesNotKnow) {
  const auto refusal = [](const std::string& text) { return thrownBy([&] { parseSide(text); }); };
  EXPECT_THAT(refusal("a.obj?colour=red"), HasSubstr("no parameter \"colour\""));
  EXPECT_THAT(refusal("a.obj?radius=-1"), HasSubstr("radius"));
  EXPECT_THAT(refusal("a.obj?samples=0"), HasSubstr("s1"));
  EXPECT_THAT(refusal("a.obj?width=64"), HasSubstr("width and height"));
  EXPECT_THAT(refusal("a.obj?up_axis=x"), HasSubstr("y or z"));
  EXPECT_THAT(refusal("a.obj?seed=1&seed=2"), HasSubstr("seed"));
  EXPECT_THAT(refusal("/v1/scenes/blocks"), HasSubstr("URL"));
  EXPECT_THAT(refusal("/v1/scenes/blocks/tiles/64x36/0,0,99,9/0-1.exr"), HasSubstr("ends at column 99"));
  EXPECT_THAT(refusal(""), HasSubstr("a side names"));
  EXPECT_THAT(refusal("?seed=1"), HasSubstr("a side names"));
}

} // namespace
} // namespace chamfer
