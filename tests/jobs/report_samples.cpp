#include "tests/jobs/report_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace chamfer::test {
namespace {

Region wholeOf(const Picture& picture) {
  Region region;
  region.crop = {0, 0, picture.width, picture.height};
  region.pixels = picture.pixels();
  return region;
}

LevelResult levelOf(const std::string& level, unsigned block, Outcome outcome, const TileRect& worst) {
  LevelResult result;
  result.level = level;
  result.block = block;
  result.tests = block == 0 ? 3 : 3 * std::size_t(std::max(1u, 240 / block)) * std::max(1u, 160 / block);
  result.outcome = outcome;
  result.pValue = outcome == Outcome::Differs ? 3.2e-9 : 0.41;
  result.worst = worst;
  result.channel = 1;
  result.a = 0.5231, result.b = 0.4987;
  result.seenFrom = 0.003, result.boundedBy = 0.0042, result.resolution = 0.005;
  if (outcome == Outcome::CannotTell) result.boundedBy = 0.0131;
  return result;
}

/// Takes the square, and with it what is wrong, out of a case.
void makeSame(CaseResult& one) {
  one.outcome = Outcome::Same;
  one.reason = "Every metric is within its limit, and no difference above 0.5 % can be there.";
  one.a.mean = makePicture(one.b.mean.width, one.b.mean.height, one.b.mean.channels, 3, 0.02);
  for (MetricResult& metric : one.metrics)
    metric.outcome = Outcome::Same;
  one.metrics[0].value = 0.0012;
  for (LevelResult& level : one.statistics->levels)
    level = levelOf(level.level, level.block, Outcome::Same, level.worst);
}

} // namespace

Picture makePicture(unsigned width, unsigned height, unsigned channels, unsigned seed, double noise) {
  Picture picture;
  picture.width = width, picture.height = height, picture.channels = channels;
  picture.values.resize(picture.pixels() * channels);
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal(0, noise);
  std::size_t i = 0;
  for (unsigned y = 0; y < height; ++y)
    for (unsigned x = 0; x < width; ++x) {
      const double u = (x + 0.5) / width, v = (y + 0.5) / height;
      const bool disc = std::hypot((u - 0.4) * width / height, v - 0.55) < 0.25;
      const double color[4] = {disc ? 0.6 - 0.4 * v : 0.2 + 0.3 * u, disc ? 0.25 : 0.3 + 0.2 * v,
                               disc ? 0.1 : 0.6 - 0.3 * v, 1};
      for (unsigned c = 0; c < channels; ++c, ++i)
        picture.values[i] = float(std::max(0.0, color[c] + (c == 3 ? 0 : normal(engine))));
    }
  return picture;
}

CaseResult makeCase(const std::string& name, unsigned width, unsigned height, unsigned channels) {
  CaseResult one;
  one.name = name;
  one.outcome = Outcome::Differs;
  one.reason =
      "mae is 0.0213, above its limit of 0.005; a difference of 4.9 % was seen in a block of 8 x 8 pixels.";
  one.command = "chamferd compare --suite cases.json --case '" + name + "'";
  one.seconds = 3.71;
  one.a.label = "room.scene.json?radius=0.05";
  one.a.isRender = true;
  one.a.sceneId = "6f1d2c0b9a8e7f60";
  one.a.settings = {{"rounding", "analytic"}, {"radius", "0.05"}};
  one.a.seeds = 8, one.a.samplesPerSeed = 64;
  one.a.mean = makePicture(width, height, channels, 1, 0.02);
  one.b.label = "references/room.exr";
  one.b.mean = makePicture(width, height, channels, 2, 0.02);
  one.b.mean.variance.assign(one.b.mean.values.size(), 1e-4f);
  one.b.mean.about = {{"chamfer:scene", "6f1d2c0b9a8e7f60"}, {"chamfer:version", "0.1.0"}};
  one.region = wholeOf(one.a.mean);
  one.tolerance = {0.01, 0.05};

  const unsigned x0 = width * 5 / 8, y0 = height / 4, side = std::max(1u, std::min(width, height) / 8);
  for (unsigned y = y0; y < std::min(height, y0 + side); ++y)
    for (unsigned x = x0; x < std::min(width, x0 + side); ++x)
      for (unsigned c = 0; c < std::min(channels, 3u); ++c)
        one.a.mean.values[(std::size_t(y) * width + x) * channels + c] += 0.25f;
  LargestError largest;
  for (unsigned y = 0; y < height; ++y)
    for (unsigned x = 0; x < width; ++x)
      for (unsigned c = 0; c < channels; ++c) {
        const std::size_t i = (std::size_t(y) * width + x) * channels + c;
        const double a = double(one.a.mean.values[i]), b = double(one.b.mean.values[i]);
        if (std::abs(a - b) > largest.error) largest = {x, y, c, a, b, std::abs(a - b)};
      }
  one.largest = largest;
  one.metrics = {{Metric::Mae, 0.0213, 0.0004, 0.005, Outcome::Differs},
                 {Metric::Psnr, 31.72, 0.05, 30.0, Outcome::Same},
                 {Metric::BiasPercent, -0.62, 0.9, 0.5, Outcome::CannotTell},
                 {Metric::FailingShare, 0.0231, std::nullopt, std::nullopt, Outcome::Same},
                 {Metric::Flip, 0.0417, std::nullopt, std::nullopt, Outcome::Same}};
  StatisticsResult statistics;
  statistics.method = "Differences of samples paired by seed, tested against zero by Student's t.";
  statistics.significance = 0.001;
  statistics.seeds = 8, statistics.mostSeeds = 64;
  statistics.levels = {levelOf("pixel", 1, Outcome::Same, {x0, y0, 1, 1}),
                       levelOf("block", 8, Outcome::Differs, {x0 / 8 * 8, y0 / 8 * 8, 8, 8}),
                       levelOf("image", 0, Outcome::CannotTell, {0, 0, width, height})};
  one.statistics = statistics;
  return one;
}

SuiteResult makeSuite() {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  SuiteResult suite;
  suite.program = "chamferd 0.1.0";
  suite.command = "chamferd compare --suite cases.json --html report.html";
  suite.started = "2026-01-31T12:00:00Z";
  suite.seconds = 61.8;
  suite.cases.push_back(makeCase("room, radius 0.05", 240, 160, 3));
  suite.cases[0].warnings = {"2 solids of room.scene.json stay sharp: their radius is 0"};

  CaseResult same = makeCase("dice against its reference", 320, 200, 4);
  makeSame(same);
  suite.cases.push_back(same);

  CaseResult identical = makeCase("one pixel", 1, 1, 1);
  makeSame(identical);
  identical.a.mean = identical.b.mean;
  identical.metrics = {{Metric::Mae, 0, std::nullopt, 0.0, Outcome::Same},
                       {Metric::Psnr, kInf, std::nullopt, 40.0, Outcome::Same}};
  identical.statistics->identical = true;
  identical.statistics->levels.clear();
  identical.largest = LargestError{};
  suite.cases.push_back(identical);

  CaseResult unsure = makeCase("glass, few seeds", 160, 120, 1);
  unsure.outcome = Outcome::CannotTell;
  unsure.reason =
      "After 64 seeds, all that the budget allows, a difference of up to 1.3 % may still be there.";
  unsure.region.crop = {40, 20, 160, 120};
  unsure.region.text = "mask \"sky.png\": 12800 of 19200 pixels";
  unsure.region.counts.assign(unsure.a.mean.pixels(), 1);
  std::fill_n(unsure.region.counts.begin(), 160 * 40, std::uint8_t(0));
  unsure.region.pixels = 160 * 80;
  unsure.largest->x += 40, unsure.largest->y += 20;
  for (LevelResult& level : unsure.statistics->levels) {
    level = levelOf(level.level, level.block, level.block == 8 ? Outcome::Same : Outcome::CannotTell,
                    level.worst);
    level.worst.x += 40, level.worst.y += 40;
  }
  unsure.b.stale = "made by chamferd 0.0.9; the scene was 11aa22bb33cc44dd then";
  suite.cases.push_back(unsure);

  CaseResult missing;
  missing.name = "a reference that is missing";
  missing.reason = "references/none.exr: no such file.";
  missing.command = "chamferd compare room.scene.json references/none.exr";
  missing.a.label = "room.scene.json", missing.a.isRender = true;
  missing.b.label = "references/none.exr";
  suite.cases.push_back(missing);

  CaseResult broken = makeCase("not a number", 96, 64, 3);
  broken.outcome = Outcome::Error;
  broken.reason = "a has 3 values that are no finite numbers, the first at 10, 12 (R).";
  for (unsigned c = 0; c < 3; ++c)
    broken.a.mean.values[(12 * 96 + 10) * 3 + c] = c == 1 ? float(kInf) : std::nanf("");
  broken.metrics = {{Metric::Mae, std::nan(""), std::nullopt, std::nullopt, Outcome::Error},
                    {Metric::BiasPercent, -kInf, std::nullopt, 1.0, Outcome::Error}};
  broken.statistics.reset();
  broken.largest.reset();
  suite.cases.push_back(broken);

  CaseResult sizes = makeCase("pictures of two sizes", 64, 64, 3);
  sizes.outcome = Outcome::Error;
  sizes.reason = "a is 64 x 64 pixels, b is 80 x 48.";
  sizes.b.mean = makePicture(80, 48, 3, 2, 0.02);
  sizes.metrics.clear();
  sizes.statistics.reset();
  sizes.largest.reset();
  suite.cases.push_back(sizes);

  suite.cases.push_back(makeCase("very wide", 2400, 3, 3));
  CaseResult large = makeCase("large", 2880, 1620, 3);
  large.a.mean.display = large.b.mean.display = true;
  suite.cases.push_back(large);
  return suite;
}

CaseResult makeHostileCase() {
  CaseResult one = makeCase("x", 8, 8, 3);
  one.name = "</script><!-- \"'&]]>\x01\x1b[31m \xff\xfe \xed\xa0\x80 \xef\xbf\xbf @DATA@";
  one.reason = "a\nb\t\x07 <b>no</b> \xc3";
  one.command = "chamferd compare '</script><script>document.title=1</script>' \"b\" \x7f";
  one.a.label = "<img src=x onerror=alert(1)>\x1b]0;title\x07";
  one.a.settings = {{"camera", "]]>\xf0\x28"}, {"camera", "again"}};
  one.b.stale = "<!--\x02";
  one.warnings = {"]]></system-out>\x03", "\xe2\x80\xaetxet"};
  one.region.text = "mask \"<>.png\"\x04";
  one.statistics->method = "<script>\x05";
  one.b.mean.about = {{"chamfer:note\x06", "</SCRIPT >\xff"}};
  return one;
}

} // namespace chamfer::test
