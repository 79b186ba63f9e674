// The bits of two small tiles: the same on every machine, so that tiles of several servers fit together and a
// cache may keep them. Where a change of the light, of the random numbers or of the rounding is meant to
// change them, take the new digest from the message (of an optimised build), look at the picture before and
// after, and say so in the commit. Where nothing was meant to change them, or where only one machine or build
// differs, that is a fault: look for an instruction set that is chosen at run time.
#include "common/digest.h"
#include "server/render/image/image_io.h"
#include "server/render/path/render.h"

#include <gtest/gtest.h>

namespace chamfer {
namespace {

struct KnownTile {
  const char* scene; ///< a bundled one
  const char* digest;
};

TEST(KnownBits, OfTilesOfBundledScenes) {
  constexpr KnownTile kTiles[] = {{"blocks", "aa7bad63550ec813ce842976fe77cc8a"},
                                  {"still-life", "eeaac97723e83eaeab3c9b9c62f32b95"}};
  const std::filesystem::path data = CHAMFER_SOURCE_DIR "/data";
  for (const auto& [name, digest] : kTiles) {
    const auto scene = loadScene(data / (std::string(name) + ".scene.json"), data, name);
    RenderSettings s;
    s.width = 48;
    s.height = 32;
    s.endSample = 4;
    const RenderResult result = renderTile(*prepare(scene, {}), s, {0, 0, s.width, s.height});
    EXPECT_GT(result.statistics.roundedHits(), 0u) << "the tile must show roundings";
    EXPECT_EQ(digestOf(encodeF16(result.image, s.endSample)).hex(), digest)
        << name << ": the first of these is the digest of what is rendered now";
  }
}

} // namespace
} // namespace chamfer
