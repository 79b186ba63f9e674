#include "server/render/path/sampler.h"

#include "tests/render/chi_squared.h"

#include <cmath>
#include <gtest/gtest.h>
#include <set>

namespace chamfer {
namespace {

/// Does every elementary interval of area 2^-m hold exactly one of the 2^m points?
bool isNet(const std::vector<Float2>& points) {
  const auto count = std::uint32_t(points.size());
  for (std::uint32_t columns = 1; columns <= count; columns *= 2) {
    const std::uint32_t rows = count / columns;
    std::set<std::uint32_t> cells;
    for (const Float2& p : points)
      cells.insert(std::uint32_t(p.x * float(columns)) * rows + std::uint32_t(p.y * float(rows)));
    if (cells.size() != count) return false;
  }
  return true;
}

std::vector<Float2> block(std::uint32_t x, std::uint32_t y, std::uint32_t seed, std::uint32_t pair,
                          std::uint32_t first, std::uint32_t count) {
  std::vector<Float2> points;
  for (std::uint32_t s = first; s < first + count; ++s)
    points.push_back(Sampler(x, y, s, seed).pair(pair));
  return points;
}

TEST(Sampler, EveryAlignedBlockOfEveryPairIsANet) {
  for (std::uint32_t pixel = 0; pixel < 8; ++pixel)
    for (std::uint32_t pair : {0u, 1u, 2u, 7u, 40u})
      for (std::uint32_t count : {1u, 2u, 16u, 256u})
        for (std::uint32_t first : {0u, count, 5 * count})
          EXPECT_TRUE(isNet(block(13 * pixel, 7 * pixel + 1, pixel, pair, first, count)))
              << "pixel " << pixel << " pair " << pair << " samples " << first << "+" << count;
}

TEST(Sampler, TheNetJudgeRejectsAnUnalignedBlockAndAMovedPoint) {
  EXPECT_FALSE(isNet(block(3, 4, 0, 0, 5, 64)));
  auto points = block(3, 4, 0, 0, 0, 64);
  points[10] = points[11];
  EXPECT_FALSE(isNet(points));
}

TEST(Sampler, AddressesAlonePickTheNumber) {
  const Float2 a = Sampler(5, 9, 77, 3).pair(4);
  Sampler(6, 9, 77, 3).pair(4); // queries leave no trace
  const Float2 b = Sampler(5, 9, 77, 3).pair(4);
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.y, b.y);
  for (const Sampler& other : {Sampler(6, 9, 77, 3), Sampler(5, 10, 77, 3), Sampler(5, 9, 78, 3),
                               Sampler(5, 9, 77, 4), Sampler(9, 5, 77, 3)})
    EXPECT_NE(a.x, other.pair(4).x);
}

/// Pairs of dimensions, pixels and seeds must be independent of each other: the joint distribution of one
/// coordinate of each is uniform on the square.
void expectIndependent(const char* what, const std::function<std::pair<float, float>(std::uint32_t)>& draw) {
  constexpr std::uint32_t kCells = 16, kDraws = 1 << 16;
  std::vector<double> observed(kCells * kCells),
      expected(kCells * kCells, double(kDraws) / (kCells * kCells));
  for (std::uint32_t i = 0; i < kDraws; ++i) {
    const auto [a, b] = draw(i);
    ++observed[std::uint32_t(a * kCells) * kCells + std::uint32_t(b * kCells)];
  }
  const auto result = test::chiSquared(observed, expected);
  EXPECT_GT(result.pValue, test::kSignificance) << what << ": " << result.text();
}

TEST(Sampler, PairsPixelsAndSeedsAreIndependent) {
  expectIndependent("first sample of neighbouring pixels", [](std::uint32_t i) {
    return std::pair(Sampler(i % 256, i / 256, 0, 0).pair(0).x,
                     Sampler(i % 256 + 1, i / 256, 0, 0).pair(0).x);
  });
  expectIndependent("two pairs of one pixel", [](std::uint32_t i) {
    const Sampler s(i % 256, i / 256, 3, 0);
    return std::pair(s.pair(2).x, s.pair(3).y);
  });
  expectIndependent("two seeds", [](std::uint32_t i) {
    return std::pair(Sampler(i % 256, i / 256, 1, 0).pair(5).y, Sampler(i % 256, i / 256, 1, 1).pair(5).y);
  });
  expectIndependent("both coordinates over pixels", [](std::uint32_t i) {
    const Float2 p = Sampler(i % 256, i / 256, 0, 9).pair(0);
    return std::pair(p.x, p.y);
  });
}

TEST(Sampler, IntegratesASmoothFunctionFasterThanRandomNumbers) {
  // Error over 64 pixels of the mean of x*y with 256 samples: independent numbers give about 0.22 / 16
  // = 1.4e-2.
  double square = 0;
  for (std::uint32_t pixel = 0; pixel < 64; ++pixel) {
    double mean = 0;
    for (const Float2& p : block(pixel, 0, 0, 1, 0, 256))
      mean += double(p.x) * p.y / 256;
    square += (mean - 0.25) * (mean - 0.25) / 64;
  }
  EXPECT_LT(std::sqrt(square), 1e-3);
}

} // namespace
} // namespace chamfer
