// Digests are written into sidecars and URLs: they must not change from build to build.
#include "common/digest.h"

#include <gtest/gtest.h>

namespace chamfer {
namespace {

TEST(Digest, OfNothingIsXxh3s) {
  // The published values of XXH3 with seed 0 for the empty input.
  EXPECT_EQ(digestOf(std::string_view()).hex(), "99aa06d3014798d86001c324468d497f");
  EXPECT_EQ(checksumOf({}), 0x2d06800538d394c2u);
}

TEST(Digest, StaysTheSame) {
  EXPECT_EQ(digestOf("chamfer").hex(), "937a4e41b2072f3da80adec383d9e8b7");
  EXPECT_EQ(digestOf(std::string(1000, 'x')).hex(), "50a1af5a5f2dcf01c0a4877b962cba82");
}

TEST(Digest, SeesEveryByteAndTheLength) {
  const std::string text(300, 'a');
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string other = text;
    other[i] ^= 1;
    EXPECT_NE(digestOf(other), digestOf(text)) << i;
    EXPECT_NE(checksumOf(std::as_bytes(std::span(other))), checksumOf(std::as_bytes(std::span(text)))) << i;
  }
  EXPECT_NE(digestOf(text + '\0'), digestOf(text));
}

TEST(Digest, HexHasAllDigits) { EXPECT_EQ((Digest{0x1, 0xab}.hex()), "000000000000000100000000000000ab"); }

} // namespace
} // namespace chamfer
