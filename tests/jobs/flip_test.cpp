#include "server/jobs/metrics/flip.h"

#include "tests/jobs/plain_flip.h"
#include "tests/support/temporary_folder.h"

#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <random>

namespace chamfer {
namespace {

using testing::Each;
using testing::StartsWith;

Picture filled(unsigned width, unsigned height, const std::vector<float>& color, bool display = true) {
  Picture p;
  p.width = width;
  p.height = height;
  p.channels = unsigned(color.size());
  p.display = display;
  for (std::size_t i = 0; i < p.pixels(); ++i)
    p.values.insert(p.values.end(), color.begin(), color.end());
  return p;
}

void setPixel(Picture& p, unsigned x, unsigned y, const std::vector<float>& color) {
  std::copy(color.begin(), color.end(),
            p.values.begin() + std::ptrdiff_t((std::size_t(y) * p.width + x) * p.channels));
}

Picture random(unsigned width, unsigned height, unsigned channels, unsigned seed) {
  Picture p = filled(width, height, std::vector<float>(channels, 0.f));
  std::mt19937 rng(seed);
  std::uniform_real_distribution<float> value(0, 1);
  for (float& v : p.values)
    v = value(rng);
  return p;
}

double meanOf(const std::vector<float>& map) {
  double sum = 0;
  for (float v : map)
    sum += double(v);
  return sum / double(map.size());
}

void expectNear(const std::vector<float>& map, const std::vector<double>& expected, const char* what) {
  ASSERT_EQ(map.size(), expected.size());
  for (std::size_t i = 0; i < map.size(); ++i)
    ASSERT_NEAR(map[i], expected[i], 3e-4) << what << ' ' << i;
}

TEST(Flip, OfEqualPicturesIsNothing) {
  for (bool display : {true, false}) {
    Picture p = random(40, 30, 3, 1);
    p.display = display;
    EXPECT_THAT(flipMap(p, p), Each(0.f));
  }
}

/// Floats against doubles: a feature's difference is a root, and 1e-7 of it 3e-4 of an exponent.
TEST(Flip, IsThePublishedMethodOnRandomPictures) {
  for (const auto& [width, height] :
       {std::pair(33u, 20u), std::pair(5u, 31u), std::pair(40u, 3u), std::pair(1u, 1u)})
    for (unsigned channels : {1u, 3u}) {
      const Picture a = random(width, height, channels, 7), b = random(width, height, channels, 8);
      expectNear(flipMap(a, b), test::plainFlip(a, b, kFlipPixelsPerDegree), "papers' observer");
    }
  const Picture a = random(30, 30, 3, 9), b = random(30, 30, 3, 10);
  for (double ppd : {5., 20., 90.})
    expectNear(flipMap(a, b, ppd), test::plainFlip(a, b, ppd), "other observer");
}

TEST(Flip, OfNearlyEqualPicturesIsThePublishedMethod) {
  const Picture b = random(32, 24, 3, 3);
  Picture a = b;
  for (std::size_t i = 0; i < a.values.size(); i += 7)
    a.values[i] = std::min(1.f, a.values[i] + 0.02f);
  expectNear(flipMap(a, b), test::plainFlip(a, b, kFlipPixelsPerDegree), "near");
}

TEST(Flip, GreenAgainstBlueIsAllAndBlackAgainstWhiteIsAsPublished) {
  EXPECT_THAT(flipMap(filled(6, 4, {0, 1, 0}), filled(6, 4, {0, 0, 1})), Each(testing::FloatNear(1, 1e-5f)));
  // HyAB of black and white is 100; of green (87.73, -86.18, 83.18) and blue (32.30, 79.19, -107.86) in
  // CIELAB, with Hunt's effect, 203.3: pow 0.7 of them is 25.12 and 41.28, the knee is at 0.4 * 41.28.
  const double expected = 0.95 + 0.05 * (25.12 - 16.51) / (41.28 - 16.51);
  const auto map = flipMap(filled(6, 4, {0, 0, 0}), filled(6, 4, {1, 1, 1}));
  EXPECT_THAT(map, Each(testing::FloatNear(float(expected), 1e-3f)));
  EXPECT_NEAR(map[0], test::plainColorError({0, 0, 0}, {1, 1, 1}), 1e-5);
  EXPECT_EQ(flipMap(filled(6, 4, {0}), filled(6, 4, {1})), map) << "grey is the same colours";
}

TEST(Flip, OfDisplayPicturesDoesNotMindWhichIsWhich) {
  const Picture a = random(24, 24, 3, 4), b = random(24, 24, 3, 5);
  EXPECT_EQ(flipMap(a, b), flipMap(b, a));
}

TEST(Flip, GrowsWithTheDifference) {
  const Picture b = filled(32, 32, {0.4f, 0.4f, 0.4f});
  double before = 0;
  for (float d : {0.001f, 0.01f, 0.05f, 0.2f, 0.5f}) {
    Picture a = b;
    for (unsigned y = 10; y < 20; ++y)
      for (unsigned x = 10; x < 20; ++x)
        setPixel(a, x, y, {0.4f + d, 0.4f + d, 0.4f + d});
    const double mean = meanOf(flipMap(a, b));
    EXPECT_GT(mean, before) << d;
    before = mean;
  }
}

TEST(Flip, MovesWithThePicture) {
  const Picture b = filled(80, 70, {0.3f, 0.4f, 0.5f});
  Picture a = b, moved = b;
  std::mt19937 rng(6);
  std::uniform_real_distribution<float> value(0, 1);
  for (unsigned y = 0; y < 6; ++y)
    for (unsigned x = 0; x < 9; ++x) {
      const std::vector<float> color{value(rng), value(rng), value(rng)};
      setPixel(a, 25 + x, 26 + y, color);
      setPixel(moved, 25 + x + 13, 26 + y + 9, color);
    }
  const auto map = flipMap(a, b), movedMap = flipMap(moved, b);
  for (unsigned y = 0; y + 9 < 70; ++y)
    for (unsigned x = 0; x + 13 < 80; ++x)
      ASSERT_EQ(map[y * 80 + x], movedMap[(y + 9) * 80 + x + 13]) << x << ' ' << y;
  EXPECT_EQ(map[0], 0) << "far from it there is nothing";
}

/// The widest kernel, of blue and yellow, has a radius of 10 pixels: not one row less may be looked at.
TEST(Flip, APixelIsSeenAsFarAsTheKernelsReach) {
  const Picture b = filled(31, 61, {0.5f, 0.5f, 0.5f});
  Picture a = b;
  setPixel(a, 15, 30, {0, 0, 1});
  const auto map = flipMap(a, b);
  expectNear(map, test::plainFlip(a, b, kFlipPixelsPerDegree), "about a pixel");
  for (unsigned y = 0; y < 61; ++y)
    EXPECT_EQ(map[y * 31 + 15] > 0, y >= 20 && y <= 40) << y;
}

TEST(Flip, ALineStandsOutMoreThanItsColour) {
  const Picture b = filled(41, 41, {0.5f, 0.5f, 0.5f});
  Picture line = b;
  for (unsigned y = 0; y < 41; ++y)
    setPixel(line, 20, y, {0.6f, 0.6f, 0.6f});
  const auto map = flipMap(line, b);
  const auto colorOnly = test::plainFlip(line, b, kFlipPixelsPerDegree, {}, true);
  const std::size_t middle = 20 * 41 + 20;
  EXPECT_GT(map[middle], 1.1 * colorOnly[middle]) << "its point response";
  EXPECT_GT(map[middle + 3], 1.05 * colorOnly[middle + 3]) << "its edge response";
  EXPECT_NEAR(map[middle], map[middle - 10 * 41], 1e-6) << "along the line it is the same";
  EXPECT_NEAR(map[middle + 3], map[middle - 3], 1e-3) << "on both sides";
  Picture turned = b;
  for (unsigned x = 0; x < 41; ++x)
    setPixel(turned, x, 20, {0.6f, 0.6f, 0.6f});
  EXPECT_NEAR(flipMap(turned, b)[middle + 3 * 41], map[middle + 3], 1e-3) << "a line across";
}

TEST(Flip, LeavesAlphaOut) {
  const Picture a = random(16, 16, 3, 11), b = random(16, 16, 3, 12);
  const auto withAlpha = [](const Picture& p, float alpha) {
    Picture q = filled(p.width, p.height, {0, 0, 0, alpha});
    for (std::size_t i = 0; i < p.pixels(); ++i)
      std::copy_n(p.values.begin() + std::ptrdiff_t(3 * i), 3, q.values.begin() + std::ptrdiff_t(4 * i));
    return q;
  };
  EXPECT_EQ(flipMap(withAlpha(a, 0), withAlpha(b, 1)), flipMap(a, b));
}

/// The exposures by the paper's rule, from the reference's luminances.
TEST(HdrFlip, IsTheLargestOverTheReferencesExposures) {
  for (unsigned channels : {1u, 3u}) {
    Picture a = random(24, 18, channels, 13), b = random(24, 18, channels, 14);
    a.display = b.display = false;
    for (Picture* p : {&a, &b})
      for (float& v : p->values)
        v = std::exp(8 * v - 5);
    std::vector<double> light;
    for (std::size_t i = 0; i < b.pixels(); ++i) {
      const float* v = &b.values[i * channels];
      light.push_back(channels == 1 ? double(v[0])
                                    : 0.2126 * double(v[0]) + 0.7152 * double(v[1]) + 0.0722 * double(v[2]));
    }
    std::sort(light.begin(), light.end());
    // 0.85 = v (2.51 v + 0.03) / (v (2.43 v + 0.59) + 0.14) of v = 0.6 x
    const double p = (0.03 - 0.85 * 0.59) / (2.51 - 0.85 * 2.43), q = -0.85 * 0.14 / (2.51 - 0.85 * 2.43);
    const double shoulder = (-p / 2 + std::sqrt(p * p / 4 - q)) / 0.6;
    const double start = std::log2(shoulder / light.back()),
                 stop = std::log2(shoulder / light[light.size() / 2]);
    const int count = int(std::max(2., std::ceil(stop - start)));
    ASSERT_GT(count, 3);
    std::vector<double> most(a.pixels(), 0.);
    for (int i = 0; i < count; ++i) {
      const auto one = test::plainFlip(a, b, kFlipPixelsPerDegree, start + i * (stop - start) / (count - 1));
      for (std::size_t k = 0; k < most.size(); ++k)
        most[k] = std::max(most[k], one[k]);
    }
    expectNear(flipMap(a, b), most, "exposures");
  }
}

TEST(HdrFlip, SeesWhatIsDarkBesideABrightWindow) {
  Picture b = filled(40, 40, {0.001f, 0.001f, 0.001f}, false);
  for (unsigned y = 0; y < 10; ++y)
    for (unsigned x = 0; x < 40; ++x)
      setPixel(b, x, y, {50, 50, 50});
  Picture a = b;
  setPixel(a, 20, 30, {0.004f, 0.004f, 0.004f});
  Picture displayA = a, displayB = b;
  displayA.display = displayB.display = true;
  const std::size_t at = 30 * 40 + 20;
  const double dark = flipMap(displayA, displayB)[at]; // nearly as black as the rest at one exposure
  EXPECT_NEAR(dark, test::plainFlip(displayA, displayB, kFlipPixelsPerDegree)[at], 3e-4);
  EXPECT_GT(flipMap(a, b)[at], 5 * dark);
  EXPECT_EQ(flipMap(a, b)[0], 0);
}

TEST(HdrFlip, ScaleOfBothIsNothingToTheEye) {
  Picture a = random(20, 20, 3, 15), b = random(20, 20, 3, 16);
  a.display = b.display = false;
  const auto map = flipMap(a, b);
  for (Picture* p : {&a, &b})
    for (float& v : p->values)
      v *= 1024; // a power of two: the same digits
  const auto scaled = flipMap(a, b);
  for (std::size_t i = 0; i < map.size(); ++i)
    ASSERT_NEAR(map[i], scaled[i], 1e-4);
}

TEST(HdrFlip, StandsBlackAndExtremeReferences) {
  const Picture black = filled(20, 20, {0, 0, 0}, false);
  EXPECT_THAT(flipMap(black, black), Each(0.f));
  Picture dim = black;
  setPixel(dim, 10, 10, {1e-4f, 1e-4f, 1e-4f});
  EXPECT_GT(flipMap(dim, black)[10 * 20 + 10], 0.1) << "black asks for no exposure, the other does";
  EXPECT_GT(flipMap(black, dim)[10 * 20 + 10], 0.1) << "mostly black: the median of what is not";
  Picture extreme = black;
  setPixel(extreme, 3, 3, {3e38f, 1e-45f, 0});
  setPixel(extreme, 4, 4, {1e-45f, 1e-45f, 1e-45f});
  for (const auto& map : {flipMap(extreme, black), flipMap(black, extreme), flipMap(extreme, dim)})
    for (float v : map)
      ASSERT_TRUE(v >= 0 && v <= 1);
  Picture negative = filled(20, 20, {-5, -5, -5}, false);
  EXPECT_THAT(flipMap(negative, black), Each(0.f)) << "negative values are black";
}

TEST(Flip, RefusesObserversAndShapesThatAreNone) {
  const Picture a = filled(4, 4, {0, 0, 0});
  for (double ppd : {0., -1., 0.5, 1e4, double(NAN), double(INFINITY)})
    EXPECT_THAT(test::thrownBy([&] { flipMap(a, a, ppd); }), StartsWith("out-of-range: ")) << ppd;
  const Picture wrong[] = {filled(4, 5, {0, 0, 0}), filled(4, 4, {0}), filled(4, 4, {0, 0, 0}, false)};
  for (const Picture& b : wrong)
    EXPECT_THAT(test::thrownBy([&] { flipMap(a, b); }), StartsWith("internal: "));
}

} // namespace
} // namespace chamfer
