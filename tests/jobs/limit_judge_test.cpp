// Limits of metrics under noise whose truth is known.
#include "server/jobs/compare/limit_judge.h"

#include "tests/jobs/picture_of.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace chamfer {
namespace {

constexpr unsigned kWidth = 32, kHeight = 24;

Region wholeRegion() {
  Region region;
  region.crop = {0, 0, kWidth, kHeight};
  region.pixels = std::size_t(kWidth) * kHeight;
  return region;
}

Picture noisy(std::mt19937_64& random, float mean, float deviation) {
  std::normal_distribution<float> value(mean, deviation);
  Picture p = test::pictureOf(kWidth, kHeight, 3, std::vector<float>(std::size_t(kWidth) * kHeight * 3));
  for (float& v : p.values)
    v = value(random);
  return p;
}

/// After `seeds` seeds of means 1 + difference and 1, with independent noise.
Outcome judged(Metric metric, double limit, double difference, unsigned seeds, double deviation = 0.2,
               PixelTolerance tolerance = {}) {
  const Region region = wholeRegion();
  LimitJudge judge(region, tolerance, {{metric, limit}}, 0.01);
  std::mt19937_64 random(7);
  for (unsigned k = 0; k < seeds; ++k) {
    const Picture a = noisy(random, float(1 + difference), float(deviation));
    judge.add(a, noisy(random, 1, float(deviation)));
  }
  const std::vector<MetricResult> results = judge.judge();
  EXPECT_EQ(results.size(), 1u);
  EXPECT_TRUE(seeds == 1 || results[0].standardError) << "the noise of a value is told";
  return results[0].outcome;
}

/// What each metric is of a true difference of 0.1 to a reference of 1 everywhere.
struct Truth {
  Metric metric;
  double value;
};
const Truth kTruths[] = {{Metric::Mae, 0.1},
                         {Metric::Rmse, 0.1},
                         {Metric::RelMse, 0.01 / 1.01},
                         {Metric::BiasPercent, 10},
                         {Metric::Psnr, 20}};

TEST(LimitJudge, FindsWhatIsBeyondItsLimit) {
  for (const auto& [metric, value] : kTruths) {
    const double tight = metric == Metric::Psnr ? 26 : value / 2;
    EXPECT_EQ(judged(metric, tight, 0.1, 512), Outcome::Differs) << metricRow(metric).name;
  }
}

TEST(LimitJudge, AcceptsWhatIsWithin) {
  for (const auto& [metric, value] : kTruths) {
    const double wide = metric == Metric::Psnr ? 17 : value * 2;
    EXPECT_EQ(judged(metric, wide, 0.1, 512), Outcome::Same) << metricRow(metric).name;
  }
}

TEST(LimitJudge, DoesNotTakeNoiseForADifference) {
  // Measured: the noise of 16 seeds, 0.07, beyond each limit. True: no difference at all.
  for (const Metric metric : {Metric::Mae, Metric::Rmse, Metric::RelMse, Metric::MaxError, Metric::Flip})
    EXPECT_EQ(judged(metric, 1e-4, 0, 16), Outcome::CannotTell) << metricRow(metric).name;
  EXPECT_EQ(judged(Metric::Psnr, 80, 0, 16), Outcome::CannotTell);
  EXPECT_EQ(judged(Metric::FailingShare, 0.01, 0, 16, 0.2, {0.05, 0}), Outcome::CannotTell);
  EXPECT_EQ(judged(Metric::BiasPercent, 0.01, 0, 16), Outcome::CannotTell);
}

TEST(LimitJudge, CountsFailingPixelsThatAreSure) {
  EXPECT_EQ(judged(Metric::FailingShare, 0.5, 0.1, 512, 0.02, {0.05, 0}), Outcome::Differs);
  EXPECT_EQ(judged(Metric::FailingShare, 0.01, 0.1, 512, 0.02, {0.2, 0}), Outcome::Same);
}

TEST(LimitJudge, TakesSinglePicturesAsTheyAre) {
  EXPECT_EQ(judged(Metric::Rmse, 0.11, 0.1, 1, 0), Outcome::Same);
  EXPECT_EQ(judged(Metric::Rmse, 0.09, 0.1, 1, 0), Outcome::Differs);
  EXPECT_EQ(judged(Metric::MaxError, 0, 0, 1, 0), Outcome::Same);
  EXPECT_EQ(judged(Metric::Psnr, 19, 0.1, 1, 0), Outcome::Same);
  EXPECT_EQ(judged(Metric::Psnr, 21, 0.1, 1, 0), Outcome::Differs);
}

TEST(LimitJudge, CountsTheNoiseThatAnImageTellsOf) {
  const Region region = wholeRegion();
  std::mt19937_64 random(3);
  Picture a = noisy(random, 1, 0.1f), b = noisy(random, 1, 0.1f);
  const auto outcome = [&](const Picture& x, const Picture& y) {
    LimitJudge judge(region, {}, {{Metric::Rmse, 0.01}}, 0.01);
    judge.add(x, y);
    return judge.judge()[0].outcome;
  };
  EXPECT_EQ(outcome(a, b), Outcome::Differs);
  for (Picture* p : {&a, &b})
    p->variance.assign(p->values.size(), 0.01f);
  EXPECT_EQ(outcome(a, b), Outcome::CannotTell) << "all of it may be noise";
}

TEST(LimitJudge, IsRightAsOftenAsItSays) {
  // True values at the limit: neither answer is right, and each may come as often as the significance, 0.05.
  int alarms = 0;
  const Region region = wholeRegion();
  std::mt19937_64 random(11);
  for (int i = 0; i < 100; ++i) {
    LimitJudge judge(region, {}, {{Metric::BiasPercent, 1}}, 0.05);
    for (int k = 0; k < 16; ++k) {
      const Picture a = noisy(random, 1.01f, 0.3f);
      judge.add(a, noisy(random, 1, 0.3f));
    }
    alarms += judge.judge()[0].outcome != Outcome::CannotTell;
  }
  EXPECT_LE(alarms, 5 + 9) << "four standard deviations above 0.05";
  EXPECT_GE(alarms, 1) << "a judge that never decides is none";
}

} // namespace
} // namespace chamfer
