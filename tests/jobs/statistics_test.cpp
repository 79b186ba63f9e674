// The three answers of the statistics, on made-up noise whose truth is known.
#include "server/jobs/statistics/statistics.h"

#include "common/error.h"
#include "tests/jobs/picture_of.h"

#include <gtest/gtest.h>
#include <random>

namespace chamfer {
namespace {

constexpr unsigned kWidth = 24, kHeight = 16;

/// Skewed noise of mean `mean`: mostly dark, sometimes bright, as a path tracer's.
Picture noise(std::mt19937_64& random, float mean) {
  std::exponential_distribution<float> value(1 / mean);
  Picture p = test::pictureOf(kWidth, kHeight, 3, std::vector<float>(std::size_t(kWidth) * kHeight * 3));
  for (float& v : p.values)
    v = (value(random) + value(random) + value(random)) / 3;
  return p;
}

Region wholeRegion() {
  Region region;
  region.crop = {0, 0, kWidth, kHeight};
  region.pixels = std::size_t(kWidth) * kHeight;
  return region;
}

template <class Change>
Outcome compare(const StatisticsChoice& choice, unsigned long seed, Change&& change) {
  std::mt19937_64 random(seed);
  const auto test = signFlipTest(wholeRegion(), 3, choice, false);
  Outcome outcome = Outcome::CannotTell;
  for (unsigned n = 1; n <= lastLook(choice.mostSeeds) && outcome == Outcome::CannotTell; ++n) {
    const Picture a = noise(random, 1);
    Picture b = noise(random, 1);
    change(b);
    test->add(a, b);
    if (isLook(n, choice.mostSeeds)) outcome = test->judge(1).outcome();
  }
  return outcome;
}

TEST(SeedTest, RaisesFalseAlarmsNoMoreOftenThanStated) {
  StatisticsChoice choice;
  choice.significance = 0.1;
  choice.mostSeeds = 32;
  choice.resolution = {0, 0, 0}; // never the same: all looks are used
  int alarms = 0;
  constexpr int kComparisons = 200;
  for (int i = 0; i < kComparisons; ++i)
    alarms += compare(choice, 1000 + static_cast<unsigned long>(i), [](Picture&) {}) == Outcome::Differs;
  // Binomial of 0.1: four standard deviations above; and not a judge that cannot fail.
  EXPECT_LE(alarms, 20 + 17);
  EXPECT_GE(alarms, 3);
}

TEST(SeedTest, FindsWhatDiffers) {
  StatisticsChoice choice;
  EXPECT_EQ(compare(choice, 1,
                    [](Picture& b) {
                      for (float& v : b.values)
                        v *= 1.03f;
                    }),
            Outcome::Differs)
      << "3 % brighter everywhere";
  EXPECT_EQ(compare(choice, 2, [](Picture& b) { b.values[3 * 100 + 1] += 4; }), Outcome::Differs)
      << "one pixel of one channel";
}

TEST(SeedTest, SaysSameOnlyWithBoundsBelowTheResolution) {
  StatisticsChoice choice;
  choice.resolution = {3, 1, 0.1};
  EXPECT_EQ(compare(choice, 3, [](Picture&) {}), Outcome::Same);
  choice.resolution = {1e-3, 1e-3, 1e-3};
  EXPECT_EQ(compare(choice, 3, [](Picture&) {}), Outcome::CannotTell) << "noise hides what this small is";
}

TEST(SeedTest, ToleratesWhatItIsToldTo) {
  StatisticsChoice choice;
  const auto brighter = [](Picture& b) {
    for (float& v : b.values)
      v *= 1.03f;
  };
  choice.tolerance = {0.5, 0.2, 0.1};
  EXPECT_NE(compare(choice, 4, brighter), Outcome::Differs);
  choice.tolerance = {0, 0, 0.005};
  EXPECT_EQ(compare(choice, 4, brighter), Outcome::Differs);
}

TEST(SeedTest, JudgingCanBeCancelled) {
  std::mt19937_64 random(6);
  const auto test = signFlipTest(wholeRegion(), 3, StatisticsChoice(), false);
  for (unsigned n = 0; n < kFirstLook; ++n)
    test->add(noise(random, 1), noise(random, 1));
  for (const unsigned threads : {1u, 3u}) {
    EXPECT_THROW(test->judge(threads, [] { return true; }), Error);
    EXPECT_EQ(test->judge(threads, [] { return false; }).seeds, kFirstLook);
  }
}

TEST(ReferenceTest, KnowsTheNoiseOfBothSides) {
  std::mt19937_64 random(5);
  constexpr unsigned kImageSeeds = 64;
  Picture image = noise(random, 1);
  std::vector<double> sum(image.values.size(), 0), squares = sum;
  for (unsigned n = 0; n < kImageSeeds; ++n) {
    const Picture one = noise(random, 1);
    for (std::size_t i = 0; i < sum.size(); ++i) {
      sum[i] += double(one.values[i]);
      squares[i] += double(one.values[i]) * double(one.values[i]);
    }
  }
  image.variance.resize(image.values.size());
  for (std::size_t i = 0; i < sum.size(); ++i) {
    const double mean = sum[i] / kImageSeeds;
    image.values[i] = float(mean);
    image.variance[i] = float((squares[i] / kImageSeeds - mean * mean) / (kImageSeeds - 1));
  }
  const auto judged = [&](float factor) {
    StatisticsChoice choice;
    choice.mostSeeds = 16;
    choice.resolution = {10, 2, 0.2};
    const auto test = referenceTest(wholeRegion(), image, choice, 1, kImageSeeds);
    for (unsigned n = 0; n < 16; ++n) {
      Picture a = noise(random, 1);
      for (float& v : a.values)
        v *= factor;
      test->add(a, {});
    }
    return test->judge(1).outcome();
  };
  EXPECT_EQ(judged(1), Outcome::Same);
  EXPECT_EQ(judged(1.1f), Outcome::Differs);
}

} // namespace
} // namespace chamfer
