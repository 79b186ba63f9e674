#include "tests/render/image_judge.h"

#include "common/error.h"
#include "server/jobs/compare/words.h"
#include "server/jobs/metrics/metrics.h"
#include "server/jobs/statistics/statistics.h"

#include <limits>

namespace chamfer::test {
namespace {

/// Without its alpha.
Picture pictureOf(const Image& image) {
  Picture p;
  p.width = image.width;
  p.height = image.height;
  p.channels = 3;
  for (std::size_t i = 0; i < image.rgba.size(); ++i)
    if (i % 4 != 3) p.values.push_back(image.rgba[i]);
  return p;
}

} // namespace

Verdict judge(const ImageSeries& a, const ImageSeries& b) {
  if (a.size() != b.size() || a.size() < kFirstLook)
    throw Error(ErrorKind::OutOfRange, "a judgement needs two series of as many renders, 16 or more");
  StatisticsChoice choice;
  choice.significance = kImageSignificance;
  choice.mostSeeds = unsigned(a.size());
  const double none = std::numeric_limits<double>::infinity();
  choice.resolution = {none, none, none}; // asked is whether they differ
  const Region region = regionOf({}, a[0].width, a[0].height);
  const auto test = signFlipTest(region, 3, choice, false);
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Picture x = pictureOf(a[i]), y = pictureOf(b[i]);
    try {
      requireComparable(x, y, "a", "b");
    } catch (const Error& error) {
      return {false, error.what()};
    }
    test->add(x, y);
  }
  const StatisticsResult result = test->judge(0);
  return {result.outcome() != Outcome::Differs, levelText(*decidingLevel(result), 3)};
}

} // namespace chamfer::test
