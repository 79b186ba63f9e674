// Sign flips (statistics.h). The studentized difference of a place is u = |sum of D| / sqrt(sum of D^2) over
// the seeds' differences D: the denominator does not change under flips, and u rises with Student's t.
#include "server/jobs/statistics/level_judge.h"

#include "common/error.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <random>
#include <string>
#include <thread>

namespace chamfer {
namespace {

/// Seeds are gathered in so many groups at most: beyond, two and two become one, so that memory is bounded.
constexpr unsigned kMostGroups = 32, kGroupsOfLarge = 16;
constexpr std::size_t kLargeValues = std::size_t{1} << 22;
/// Values handled together: of all groups they stay in the second-level cache.
constexpr std::size_t kStrip = 512;
/// Signs of each flip: [flips][groups], +1 or -1. The same for every comparison, so that a verdict can be
/// repeated.
std::vector<float> randomSigns(std::size_t flips, std::size_t groups) {
  std::mt19937_64 random(0x5eed);
  std::vector<float> signs(flips * groups);
  for (float& sign : signs)
    sign = (random() >> 63) != 0 ? 1.f : -1.f;
  return signs;
}

/// Differences of one level by group: [groups][values].
using Groups = std::vector<std::vector<float>>;

/// Largest |sum of sign * D| * weight over all values, for each flip.
std::vector<float> largestUnderFlips(const Groups& groups, std::span<const float> weights,
                                     const std::vector<float>& signs, unsigned threads,
                                     const std::function<bool()>& cancelled) {
  const std::size_t n = groups.size(), flips = signs.size() / n, values = weights.size();
  const std::size_t strips = (values + kStrip - 1) / kStrip;
  threads = unsigned(std::clamp<std::size_t>(threads, 1, strips));
  std::vector<std::vector<float>> largest(threads, std::vector<float>(flips, 0));
  std::atomic<bool> stopped = false;
  const auto work = [&](unsigned thread) {
    std::vector<float> strip(n * kStrip), sums(kStrip);
    for (std::size_t s = thread; s < strips; s += threads) {
      const std::size_t begin = s * kStrip, count = std::min(kStrip, values - begin);
      bool any = false;
      for (std::size_t k = 0; k < n; ++k)
        for (std::size_t i = 0; i < count; ++i) {
          const float d = groups[k][begin + i] * weights[begin + i];
          strip[k * kStrip + i] = d;
          any = any || d != 0;
        }
      if (stopped || (cancelled && cancelled())) {
        stopped = true;
        return;
      }
      if (!any) continue; // where nothing differs, as in most of a paired comparison
      for (std::size_t f = 0; f < flips; ++f) {
        const float* sign = signs.data() + f * n;
        std::fill_n(sums.begin(), count, 0.f);
        for (std::size_t k = 0; k < n; ++k) {
          const float* d = strip.data() + k * kStrip;
          for (std::size_t i = 0; i < count; ++i)
            sums[i] += sign[k] * d[i];
        }
        float most = largest[thread][f];
        for (std::size_t i = 0; i < count; ++i)
          most = std::max(most, std::abs(sums[i]));
        largest[thread][f] = most;
      }
    }
  };
  {
    std::vector<std::jthread> helpers;
    for (unsigned t = 1; t < threads; ++t)
      helpers.emplace_back(work, t);
    work(0);
  }
  if (stopped) throw Error(ErrorKind::Cancelled, "the comparison was cancelled");
  for (unsigned t = 1; t < threads; ++t)
    for (std::size_t f = 0; f < flips; ++f)
      largest[0][f] = std::max(largest[0][f], largest[t][f]);
  return largest[0];
}

class SignFlips final : public SeedTest {
public:
  SignFlips(const Region& region, unsigned channels, const StatisticsChoice& choice, bool paired)
      : choice_(choice), paired_(paired) {
    for (const LevelRow& row : kLevels)
      levels_.emplace_back(LevelGrid(region, channels, row.block));
    mostGroups_ = levels_[0].grid.size() > kLargeValues ? kGroupsOfLarge : kMostGroups;
  }

  void add(const Picture& a, const Picture& b) override {
    if (seeds_ > 0 && seeds_ == mostGroups_ * seedsInGroup_) halveGroups();
    const bool newGroup = seeds_ % seedsInGroup_ == 0;
    for (Level& level : levels_) {
      const std::vector<float> meansA = level.grid.means(a.values), meansB = level.grid.means(b.values);
      if (seeds_ == 0) level.sumA.assign(meansA.size(), 0), level.sumB.assign(meansB.size(), 0);
      if (newGroup) level.groups.emplace_back(meansA.size(), 0.f);
      std::vector<float>& group = level.groups.back();
      for (std::size_t i = 0; i < meansA.size(); ++i) {
        const float difference = meansA[i] - meansB[i];
        identical_ = identical_ && difference == 0;
        group[i] += difference;
        level.sumA[i] += double(meansA[i]);
        level.sumB[i] += double(meansB[i]);
      }
    }
    ++seeds_;
  }

  StatisticsResult judge(unsigned threads, const std::function<bool()>& cancelled) const override {
    if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
    StatisticsResult result;
    result.method =
        paired_ ? "both sides were rendered with the same seeds, and the differences of their paths tested "
                  "by sign flips"
                : "each side was rendered with seeds of its own, and the differences tested by sign flips";
    result.significance = choice_.significance;
    result.seeds = seeds_;
    result.mostSeeds = choice_.mostSeeds;
    result.identical = identical_;
    for (std::size_t i = 0; i < kLevels.size(); ++i)
      result.levels.push_back(judge(kLevels[i], levels_[i], threads, cancelled));
    return result;
  }

private:
  struct Level {
    explicit Level(LevelGrid g) : grid(std::move(g)) {}
    LevelGrid grid;
    Groups groups; ///< sums of differences over each group's seeds
    std::vector<double> sumA, sumB;
  };

  void halveGroups() {
    for (Level& level : levels_) {
      for (std::size_t k = 0; k < level.groups.size() / 2; ++k) {
        std::vector<float>& into = level.groups[k];
        for (std::size_t i = 0; i < into.size(); ++i)
          into[i] = level.groups[2 * k][i] + level.groups[2 * k + 1][i];
      }
      level.groups.resize(level.groups.size() / 2);
    }
    seedsInGroup_ *= 2;
  }

  LevelResult judge(const LevelRow& row, const Level& level, unsigned threads,
                    const std::function<bool()>& cancelled) const {
    const std::size_t n = level.groups.size(), values = level.grid.size();
    const double significance = choice_.significance / looksOf(choice_.mostSeeds) * row.share;
    std::vector<float> a(values), b(values);
    for (std::size_t i = 0; i < values; ++i) {
      a[i] = float(level.sumA[i] / seeds_);
      b[i] = float(level.sumB[i] / seeds_);
    }
    const std::vector<float> brightness = brightnessOf(level.grid, a, b);
    const double tolerance = choice_.tolerance.*row.of;
    const Groups shifted = tolerance > 0 ? withoutTolerated(level.groups, brightness, tolerance) : Groups();
    const Groups& groups = tolerance > 0 ? shifted : level.groups; // large: no copy without need

    std::vector<double> sums(values);
    std::vector<float> moments(values), variances(values); // of a group's difference
    for (std::size_t i = 0; i < values; ++i) {
      double sum = 0, squares = 0;
      for (std::size_t k = 0; k < n; ++k) {
        const double d = double(groups[k][i]);
        sum += d;
        squares += d * d;
      }
      sums[i] = sum;
      moments[i] = float(squares);
      variances[i] = float(std::max(0.0, squares - sum * sum / double(n)) / double(n > 1 ? n - 1 : 1));
    }
    moments = level.grid.raisedToNeighbours(moments);
    variances = level.grid.raisedToNeighbours(variances);
    std::vector<float> weights(values);
    LevelEvidence evidence{a, b, brightness, {}, 0, 1};
    double most = 0;
    for (std::size_t i = 0; i < values; ++i) {
      const double least = kRoundingShare * double(brightness[i]) * seedsInGroup_;
      weights[i] = float(1 / std::sqrt(std::max(double(moments[i]), double(n) * least * least)));
      if (const double u = std::abs(sums[i]) * double(weights[i]); u > most) most = u, evidence.worst = i;
    }

    const auto flips = std::size_t(std::ceil(2 / significance));
    std::vector<float> largest =
        largestUnderFlips(groups, weights, randomSigns(flips, n), threads, cancelled);
    // The observed signs are one of the flips: the p-value is exact (Phipson and Smyth 2010). Equal sums can
    // differ by rounding.
    const float observed = float(most * (1 - 1e-5));
    const auto asLarge =
        std::count_if(largest.begin(), largest.end(), [&](float u) { return u >= observed; });
    evidence.pValue = most == 0 ? 1 : (double(asLarge) + 1) / (double(flips) + 1);

    const std::size_t rank = std::min(flips - 1, std::size_t(std::ceil((1 - significance) * double(flips))));
    std::nth_element(largest.begin(), largest.begin() + std::ptrdiff_t(rank), largest.end());
    const double u2 = std::min(double(largest[rank]) * double(largest[rank]), double(n) * (1 - 1e-6));
    const double t = std::sqrt(u2 * double(n - 1) / (double(n) - u2)); // Student's, as u is of it
    std::vector<float> halfWidths(values);
    for (std::size_t i = 0; i < values; ++i)
      halfWidths[i] = float(t * std::sqrt(double(variances[i]) / double(n)) / seedsInGroup_);
    evidence.halfWidths = halfWidths;
    return judgeLevel(row, level.grid, evidence, choice_, significance);
  }

  /// The groups' differences less what is tolerated: their mean moves towards 0 by it, or to 0.
  Groups withoutTolerated(Groups groups, std::span<const float> brightness, double tolerance) const {
    for (std::size_t i = 0; i < brightness.size(); ++i) {
      double sum = 0;
      for (const std::vector<float>& group : groups)
        sum += double(group[i]);
      const double mean = sum / double(groups.size());
      const double tolerated = tolerance * double(brightness[i]) * seedsInGroup_;
      const auto shift = float(std::clamp(mean, -tolerated, tolerated));
      for (std::vector<float>& group : groups)
        group[i] -= shift;
    }
    return groups;
  }

  StatisticsChoice choice_;
  bool paired_, identical_ = true;
  std::vector<Level> levels_;
  unsigned seeds_ = 0, seedsInGroup_ = 1, mostGroups_ = kMostGroups;
};

} // namespace

std::unique_ptr<SeedTest> signFlipTest(const Region& region, unsigned channels,
                                       const StatisticsChoice& choice, bool paired) {
  return std::make_unique<SignFlips>(region, channels, choice, paired);
}

} // namespace chamfer
