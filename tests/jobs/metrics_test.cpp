#include "server/jobs/metrics/metrics.h"

#include "tests/jobs/picture_of.h"
#include "tests/support/temporary_folder.h"

#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <limits>
#include <random>

namespace chamfer {
namespace {

using test::pictureOf;
using test::thrownBy;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

constexpr double kInf = std::numeric_limits<double>::infinity();

Picture random(unsigned width, unsigned height, unsigned channels, unsigned seed) {
  Picture p = pictureOf(width, height, channels, {});
  std::mt19937 rng(seed);
  std::uniform_int_distribution<int> value(1, 64); // of 64: sums and scales by powers of two are exact
  for (std::size_t i = 0; i < p.pixels() * channels; ++i)
    p.values.push_back(float(value(rng)) / 64);
  return p;
}

Region whole(const Picture& p) { return regionOf({}, p.width, p.height); }

double measured(Metric metric, const Picture& a, const Picture& b, const PixelTolerance& tolerance = {}) {
  return metricOf(metric, a, b, whole(a), tolerance);
}

/// Two RGB pixels; differences 0, 1, 2, 0, 0, -4.
const Picture kA = pictureOf(2, 1, 3, {1, 2, 3, 0, 0, 0}), kB = pictureOf(2, 1, 3, {1, 1, 1, 0, 0, 4});

TEST(Metrics, AreWhatTheyAreByHand) {
  EXPECT_DOUBLE_EQ(measured(Metric::Mae, kA, kB), 7. / 6);
  EXPECT_DOUBLE_EQ(measured(Metric::Rmse, kA, kB), std::sqrt(21. / 6));
  EXPECT_DOUBLE_EQ(measured(Metric::RelMse, kA, kB), (1 / 1.01 + 4 / 1.01 + 16 / 16.01) / 6);
  EXPECT_DOUBLE_EQ(measured(Metric::Psnr, kA, kB), -10 * std::log10(3.5));
  EXPECT_DOUBLE_EQ(measured(Metric::MaxError, kA, kB), 4);
  EXPECT_DOUBLE_EQ(measured(Metric::BiasPercent, kA, kB), -100. / 7);
  EXPECT_DOUBLE_EQ(measured(Metric::BiasPercent, kB, kA), 100. / 6);
}

TEST(Metrics, FailingShareCountsPixelsBeyondTheTolerance) {
  const auto share = [](double absolute, double relative) {
    return measured(Metric::FailingShare, kA, kB, {absolute, relative});
  };
  EXPECT_EQ(share(0, 0), 1);
  EXPECT_EQ(share(1.9, 0), 1);
  EXPECT_EQ(share(2, 0), 0.5) << "at the tolerance a pixel passes";
  EXPECT_EQ(share(4, 0), 0);
  EXPECT_EQ(share(0, 1), 0.5) << "the other is 4 of a reference of 4";
  EXPECT_EQ(share(1, 1), 0) << "they add up";
}

TEST(Metrics, OfEqualPicturesAreNothing) {
  const Picture p = random(9, 7, 4, 1);
  for (const MetricRow& row : metricRows())
    EXPECT_EQ(measured(row.metric, p, p), row.metric == Metric::Psnr ? kInf : 0) << row.name;
  const Picture black = pictureOf(2, 2, 1, std::vector<float>(4, 0.f));
  EXPECT_EQ(measured(Metric::BiasPercent, black, black), 0);
}

/// A wrong picture: one pixel of 63 is off by a tenth.
TEST(Metrics, EachRejectsAWrongPicture) {
  for (bool display : {true, false}) {
    Picture right = random(9, 7, 3, 2), wrong = right;
    wrong.values[40] += 0.1f;
    right.display = wrong.display = display;
    for (const MetricRow& row : metricRows()) {
      const double value = measured(row.metric, wrong, right);
      if (row.moreIsBetter)
        EXPECT_LT(value, 45) << row.name;
      else
        EXPECT_GT(value, 1e-5) << row.name;
    }
    EXPECT_NEAR(measured(Metric::MaxError, wrong, right), 0.1, 1e-7);
    EXPECT_DOUBLE_EQ(measured(Metric::FailingShare, wrong, right), 1. / 63);
  }
}

TEST(Metrics, BiasOfABlackReferenceIsInfiniteAndCancelsOtherwise) {
  const Picture black = pictureOf(2, 1, 1, {0, 0});
  EXPECT_EQ(measured(Metric::BiasPercent, pictureOf(2, 1, 1, {0, 1}), black), kInf);
  EXPECT_EQ(measured(Metric::BiasPercent, pictureOf(2, 1, 1, {0, -1}), black), -kInf);
  const Picture a = pictureOf(2, 1, 1, {1, 3}), b = pictureOf(2, 1, 1, {3, 1});
  EXPECT_EQ(measured(Metric::BiasPercent, a, b), 0) << "which is why it never stands alone";
  EXPECT_EQ(measured(Metric::Mae, a, b), 2);
}

TEST(Metrics, ScaleWithTheValues) {
  const Picture a = random(8, 8, 3, 3), b = random(8, 8, 3, 4);
  Picture a4 = a, b4 = b;
  for (Picture* p : {&a4, &b4})
    for (float& v : p->values)
      v *= 4;
  for (Metric m : {Metric::Mae, Metric::Rmse, Metric::MaxError})
    EXPECT_DOUBLE_EQ(measured(m, a4, b4), 4 * measured(m, a, b)) << metricRow(m).name;
  EXPECT_DOUBLE_EQ(measured(Metric::BiasPercent, a4, b4), measured(Metric::BiasPercent, a, b));
  EXPECT_NEAR(measured(Metric::Psnr, a4, b4), measured(Metric::Psnr, a, b) - 20 * std::log10(4.), 1e-12);
  EXPECT_EQ(measured(Metric::FailingShare, a4, b4, {0.4, 0.1}),
            measured(Metric::FailingShare, a, b, {0.1, 0.1}));
}

TEST(Metrics, DoNotMindWhereAPixelIs) {
  const Picture a = random(8, 6, 3, 5), b = random(8, 6, 3, 6);
  const auto turned = [](const Picture& p) {
    Picture q = p;
    std::rotate(q.values.begin(), q.values.begin() + 17 * 3, q.values.end());
    return q;
  };
  for (const MetricRow& row : metricRows())
    if (row.metric != Metric::Flip) {
      EXPECT_NEAR(measured(row.metric, turned(a), turned(b), {0.1, 0}), measured(row.metric, a, b, {0.1, 0}),
                  1e-12)
          << row.name;
    }
}

/// Sums in single precision stop at 2^24.
TEST(Metrics, AddUpInDouble) {
  const unsigned side = 4200;
  const Picture a = pictureOf(side, side, 1, std::vector<float>(std::size_t(side) * side, 1.f));
  const Picture b = pictureOf(side, side, 1, std::vector<float>(std::size_t(side) * side, 0.f));
  EXPECT_EQ(measured(Metric::Mae, a, b), 1);
  EXPECT_EQ(measured(Metric::Rmse, a, b), 1);
}

TEST(Metrics, WhatDoesNotCountHasNoInfluence) {
  RegionChoice choice;
  choice.except = {{5, 4, 3, 3}};
  const Region region = regionOf(choice, 20, 16);
  for (bool display : {true, false}) {
    Picture right = random(20, 16, 3, 7), outside = right, inside = right;
    right.display = outside.display = inside.display = display;
    for (unsigned c = 0; c < 3; ++c) {
      outside.values[(4 * 20 + 5) * 3 + c] = 0.01f; // a corner of the hole: its neighbours count
      inside.values[(4 * 20 + 4) * 3 + c] = 5;
    }
    for (const MetricRow& row : metricRows()) {
      EXPECT_EQ(metricOf(row.metric, outside, right, region), row.metric == Metric::Psnr ? kInf : 0)
          << row.name;
      if (row.moreIsBetter)
        EXPECT_LT(metricOf(row.metric, inside, right, region), 30) << row.name;
      else
        EXPECT_GT(metricOf(row.metric, inside, right, region), 1e-3) << row.name;
      EXPECT_NE(metricOf(row.metric, outside, right, whole(right)), row.metric == Metric::Psnr ? kInf : 0)
          << row.name << ": without the mask it counts";
    }
  }
}

TEST(Metrics, MeansAreOverWhatCounts) {
  RegionChoice choice;
  choice.only = {{1, 0, 1, 1}};
  const Region second = regionOf(choice, 2, 1);
  EXPECT_DOUBLE_EQ(metricOf(Metric::Mae, kA, kB, second), 4. / 3);
  EXPECT_DOUBLE_EQ(metricOf(Metric::BiasPercent, kA, kB, second), -100);
  EXPECT_DOUBLE_EQ(metricOf(Metric::FailingShare, kA, kB, second), 1);
}

TEST(LargestError, IsNamedInTheFrame) {
  const Picture frame = random(12, 10, 3, 8);
  Picture wrong = frame;
  wrong.values[(6 * 12 + 7) * 3 + 1] += 2;
  wrong.values[(9 * 12 + 11) * 3 + 2] -= 9; // beyond the crop
  RegionChoice choice;
  choice.crop = TileRect{3, 2, 6, 5};
  const Region region = regionOf(choice, 12, 10);
  const LargestError e = largestError(cropped(wrong, region.crop), cropped(frame, region.crop), region);
  EXPECT_EQ(e.x, 7u);
  EXPECT_EQ(e.y, 6u);
  EXPECT_EQ(e.channel, 1u);
  EXPECT_EQ(e.error, 2);
  EXPECT_EQ(e.a - e.b, 2);
  EXPECT_EQ(e.b, double(frame.values[(6 * 12 + 7) * 3 + 1]));
  choice.except = {{7, 6, 1, 1}};
  const Region without = regionOf(choice, 12, 10);
  const LargestError none = largestError(cropped(wrong, without.crop), cropped(frame, without.crop), without);
  EXPECT_EQ(none.error, 0);
  EXPECT_EQ(none.x, 3u);
  EXPECT_EQ(none.y, 2u);
}

TEST(Metrics, PicturesThatDoNotFitTheRegionAreADefect) {
  const Picture p = random(4, 4, 3, 9);
  RegionChoice choice;
  choice.crop = TileRect{0, 0, 2, 2};
  EXPECT_THAT(thrownBy([&] { metricOf(Metric::Mae, p, p, regionOf(choice, 4, 4)); }),
              StartsWith("internal: "));
  EXPECT_THAT(thrownBy([&] { metricOf(Metric::Mae, p, random(4, 4, 1, 9), whole(p)); }),
              StartsWith("internal: "));
}

TEST(MetricRows, HaveNamesThatAreRead) {
  for (const MetricRow& row : metricRows()) {
    EXPECT_EQ(parseMetric(row.name), row.metric);
    EXPECT_EQ(&metricRow(row.metric), &row);
    EXPECT_GT(row.most, 0);
    EXPECT_FALSE(row.about.empty());
  }
  EXPECT_EQ(metricRows().size(), 8u);
  EXPECT_EQ(metricRow(Metric::FailingShare).most, 1);
  EXPECT_EQ(metricRow(Metric::Flip).most, 1);
  for (const char* bad : {"", "MAE", "mae ", "ssim"})
    EXPECT_THAT(thrownBy([&] { parseMetric(bad); }),
                AllOf(StartsWith("usage: "), HasSubstr("mae, rmse, relmse, psnr, max_error, bias_percent, "
                                                       "failing_share, flip")));
}

TEST(RequireComparable, NamesBothSidesOfWhatDiffers) {
  const Picture a = random(4, 3, 3, 10);
  EXPECT_EQ(thrownBy([&] { requireComparable(a, random(4, 3, 3, 11), "A", "B"); }), "nothing");
  const auto thrown = [&](const Picture& b) { return thrownBy([&] { requireComparable(a, b, "A", "B"); }); };
  EXPECT_THAT(thrown(random(4, 4, 3, 10)),
              AllOf(StartsWith("out-of-range: "), HasSubstr("A is 4x3"), HasSubstr("B is 4x4")));
  EXPECT_THAT(thrown(random(3, 4, 3, 10)), HasSubstr("B is 3x4")) << "as many pixels are not the same size";
  EXPECT_THAT(
      thrown(random(4, 3, 4, 10)),
      AllOf(StartsWith("out-of-range: "), HasSubstr("A is of 3 channels"), HasSubstr("B is of 4 channels")));
  EXPECT_THAT(thrown(random(4, 3, 1, 10)), HasSubstr("B is of 1 channel (grey)"));
  Picture display = a;
  display.display = true;
  EXPECT_THAT(thrown(display), AllOf(StartsWith("out-of-range: "), HasSubstr("A is made of linear pixels"),
                                     HasSubstr("B is made of sRGB-encoded")));
  EXPECT_THAT(thrown({}), AllOf(StartsWith("out-of-range: "), HasSubstr("B has no pixels")));
}

TEST(RequireComparable, RefusesNumbersThatAreNone) {
  const Picture a = random(4, 3, 3, 12);
  for (float bad : {std::numeric_limits<float>::quiet_NaN(), float(kInf), -float(kInf)})
    for (bool inVariance : {false, true}) {
      Picture b = a;
      b.variance.assign(b.values.size(), 0.f);
      (inVariance ? b.variance : b.values)[(2 * 4 + 1) * 3 + 2] = bad;
      for (const auto& said : {thrownBy([&] { requireComparable(a, b, "A", "B"); }),
                               thrownBy([&] { requireComparable(b, a, "B", "A"); })})
        EXPECT_THAT(said, AllOf(StartsWith("out-of-range: B has 1 value"), HasSubstr("pixel 1,2"),
                                HasSubstr("channel 2")));
    }
}

} // namespace
} // namespace chamfer
