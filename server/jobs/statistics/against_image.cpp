// Tests of means against an image, or of two images, by their variances (statistics.h).
#include "server/jobs/statistics/level_judge.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

namespace chamfer {
namespace {

namespace math = boost::math;

/// One level of one side: means and the variances of these means; no variances: exact.
struct LevelMeans {
  std::vector<float> mean, variance;
};

/// `degrees`: of freedom of the variances; 0: they are as good as known.
LevelResult judge(const LevelRow& row, const LevelGrid& grid, const LevelMeans& a, const LevelMeans& b,
                  const StatisticsChoice& choice, double significance, double degrees) {
  const std::vector<float> brightness = brightnessOf(grid, a.mean, b.mean);
  const auto places = double(std::max<std::size_t>(1, grid.tests()));
  // Sidak: so small must the p-value of one place be for the level's significance.
  const double each = -std::expm1(std::log1p(-significance) / places);
  const double critical = degrees > 0 ? math::quantile(math::complement(math::students_t(degrees), each / 2))
                                      : math::quantile(math::complement(math::normal(), each / 2));
  std::vector<float> halfWidths(grid.size());
  LevelEvidence evidence{a.mean, b.mean, brightness, {}, 0, 1};
  double most = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const double variance =
        (a.variance.empty() ? 0 : double(a.variance[i])) + (b.variance.empty() ? 0 : double(b.variance[i]));
    const double least = kRoundingShare * double(brightness[i]);
    const double deviation = std::sqrt(std::max(variance, least * least));
    halfWidths[i] = float(critical * deviation);
    const double beyond =
        std::abs(double(a.mean[i]) - double(b.mean[i])) - choice.tolerance.*row.of * double(brightness[i]);
    if (const double z = beyond / deviation; z > most) most = z, evidence.worst = i;
  }
  evidence.halfWidths = halfWidths;
  if (most > 0) {
    const double tail = 2 * (degrees > 0 ? math::cdf(math::complement(math::students_t(degrees), most))
                                         : math::cdf(math::complement(math::normal(), most)));
    evidence.pValue = tail >= 1 ? 1 : -std::expm1(places * std::log1p(-tail));
  }
  return judgeLevel(row, grid, evidence, choice, significance);
}

/// Of an image: its own variances, those of the neighbourhood where they are larger.
LevelMeans levelOf(const LevelGrid& grid, const Picture& image) {
  LevelMeans level{grid.means(image.values), {}};
  if (image.variance.empty()) return level;
  level.variance = grid.raisedToNeighbours(grid.variances(image.variance));
  return level;
}

class AgainstImage final : public SeedTest {
public:
  AgainstImage(const Region& region, const Picture& image, const StatisticsChoice& choice,
               unsigned samplesPerSeed, unsigned imageSamples)
      : choice_(choice), samplesPerSeed_(samplesPerSeed), imageSamples_(imageSamples) {
    for (const LevelRow& row : kLevels) {
      LevelGrid grid(region, image.channels, row.block);
      LevelMeans of = levelOf(grid, image);
      levels_.push_back({std::move(grid), std::move(of), {}, {}});
    }
  }

  void add(const Picture& a, const Picture&) override {
    for (Level& level : levels_) {
      const std::vector<float> means = level.grid.means(a.values);
      level.sum.resize(means.size(), 0);
      level.squares.resize(means.size(), 0);
      for (std::size_t i = 0; i < means.size(); ++i) {
        // About the image's value: what is squared is small, and so is what rounding takes.
        const double d = double(means[i]) - double(level.image.mean[i]);
        level.sum[i] += d;
        level.squares[i] += d * d;
        identical_ = identical_ && d == 0;
      }
    }
    ++seeds_;
  }

  StatisticsResult judge(unsigned, const std::function<bool()>&) const override {
    StatisticsResult result;
    const bool noisy = !levels_[0].image.variance.empty();
    result.method =
        noisy ? "a z-test of every place with the noise of the render and of the image"
              : "a z-test of every place with the noise of the render; the image says nothing of its own "
                "noise and is taken as exact";
    result.significance = choice_.significance;
    result.seeds = seeds_;
    result.mostSeeds = choice_.mostSeeds;
    result.identical = identical_;
    for (std::size_t i = 0; i < kLevels.size(); ++i) {
      const Level& level = levels_[i];
      const double significance = choice_.significance / looksOf(choice_.mostSeeds) * kLevels[i].share;
      const LevelMeans render = meansOf(level);
      result.levels.push_back(chamfer::judge(kLevels[i], level.grid, render, level.image, choice_,
                                             significance, std::max(1u, seeds_ - 1)));
    }
    return result;
  }

private:
  struct Level {
    LevelGrid grid;
    LevelMeans image;
    std::vector<double> sum, squares; ///< of differences from the image
  };

  LevelMeans meansOf(const Level& level) const {
    LevelMeans render;
    const double n = seeds_;
    render.mean.resize(level.sum.size());
    render.variance.resize(level.sum.size());
    for (std::size_t i = 0; i < level.sum.size(); ++i) {
      const double mean = level.sum[i] / n;
      render.mean[i] = float(double(level.image.mean[i]) + mean);
      render.variance[i] = float(std::max(0.0, level.squares[i] / n - mean * mean) / std::max(1.0, n - 1));
    }
    render.variance = level.grid.raisedToNeighbours(render.variance);
    if (level.image.variance.empty() || imageSamples_ == 0 || samplesPerSeed_ == 0) return render;
    const double ratio = imageSamples_ / (n * samplesPerSeed_);
    for (std::size_t i = 0; i < render.variance.size(); ++i)
      render.variance[i] = std::max(render.variance[i], float(double(level.image.variance[i]) * ratio));
    return render;
  }

  StatisticsChoice choice_;
  unsigned samplesPerSeed_, imageSamples_, seeds_ = 0;
  bool identical_ = true;
  std::vector<Level> levels_;
};

} // namespace

std::unique_ptr<SeedTest> referenceTest(const Region& region, const Picture& image,
                                        const StatisticsChoice& choice, unsigned samplesPerSeed,
                                        unsigned imageSamples) {
  return std::make_unique<AgainstImage>(region, image, choice, samplesPerSeed, imageSamples);
}

StatisticsResult compareImages(const Region& region, const Picture& a, const Picture& b,
                               const StatisticsChoice& choice) {
  StatisticsResult result;
  result.method = "a z-test of every place with the variances that the images carry";
  result.significance = choice.significance;
  result.identical = a.values == b.values;
  for (const LevelRow& row : kLevels) {
    const LevelGrid grid(region, a.channels, row.block);
    result.levels.push_back(
        judge(row, grid, levelOf(grid, a), levelOf(grid, b), choice, choice.significance * row.share, 0));
  }
  return result;
}

} // namespace chamfer
