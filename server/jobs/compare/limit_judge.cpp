#include "server/jobs/compare/limit_judge.h"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <numeric>
#include <random>

namespace chamfer {
namespace {

constexpr std::size_t kGroups = 8;
/// Patterns of signs whose noise is averaged.
constexpr std::size_t kPatterns = 4;
/// Standard errors by which a pixel is surely beyond its tolerance, or surely within.
constexpr double kSure = 5;

void addTo(Picture& sum, const Picture& picture) {
  if (sum.values.empty()) {
    sum = picture;
    sum.variance.clear();
    return;
  }
  for (std::size_t i = 0; i < sum.values.size(); ++i)
    sum.values[i] += picture.values[i];
}

/// Metrics as norms of the difference, for which noise and difference add at most; and back. Their limits go
/// the same way.
double toNorm(Metric metric, double value) {
  if (metric == Metric::Psnr) return std::pow(10, -value / 20);
  if (metric == Metric::RelMse) return std::sqrt(value);
  return metric == Metric::BiasPercent ? std::abs(value) : value;
}

/// Standard error of a value from what it is without each group.
double jackknifeError(const std::vector<double>& without) {
  if (without.empty()) return 0;
  const auto n = double(without.size());
  const double mean = std::accumulate(without.begin(), without.end(), 0.0) / n;
  double squares = 0;
  for (const double value : without)
    squares += (value - mean) * (value - mean);
  return std::sqrt(squares * (n - 1) / n);
}

} // namespace

LimitJudge::LimitJudge(const Region& region, const PixelTolerance& tolerance, Limits limits,
                       double significance)
    : region_(region), tolerance_(tolerance), limits_(std::move(limits)), significance_(significance),
      groups_(kGroups) {}

void LimitJudge::add(const Picture& a, const Picture& b) {
  Group& group = groups_[seeds_++ % kGroups];
  addTo(group.a, a);
  addTo(group.b, b);
  ++group.seeds;
  if (seeds_ > 1) return;
  for (const Picture* image : {&a, &b}) {
    if (image->variance.empty()) continue;
    variance_.resize(image->variance.size(), 0);
    for (std::size_t i = 0; i < variance_.size(); ++i)
      variance_[i] += image->variance[i];
  }
}

std::size_t LimitJudge::groups() const { return std::min<std::size_t>(seeds_, kGroups); }

/// Of all groups but one; of all where `group` is none of them.
std::pair<Picture, Picture> LimitJudge::meansWithout(std::size_t group) const {
  Picture a, b;
  unsigned seeds = 0;
  for (std::size_t g = 0; g < groups(); ++g) {
    if (g == group) continue;
    addTo(a, groups_[g].a);
    addTo(b, groups_[g].b);
    seeds += groups_[g].seeds;
  }
  for (Picture* sum : {&a, &b})
    for (float& value : sum->values)
      value /= float(seeds);
  return {std::move(a), std::move(b)};
}

/// `b` and noise as the measured difference has it: as many groups count with one sign as with the other.
Picture LimitJudge::noisy(const Picture& b, std::size_t pattern) const {
  Picture result = b;
  const std::size_t pairs = groups() / 2, used = 2 * pairs;
  for (std::size_t i = 0; i < result.values.size(); ++i) {
    double sum = 0;
    for (std::size_t g = 0; g < used; ++g) {
      const Group& group = groups_[g];
      const double mean = (double(group.a.values[i]) - double(group.b.values[i])) / group.seeds;
      sum += (g + pattern) % used < pairs ? mean : -mean;
    }
    if (used > 0) result.values[i] += float(sum / double(used));
  }
  if (variance_.empty()) return result;
  std::mt19937_64 random(0x5eed + pattern); // the same for every comparison: verdicts repeat
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < result.values.size(); ++i)
    result.values[i] += float(normal(random) * std::sqrt(double(variance_[i])));
  return result;
}

double LimitJudge::critical() const {
  const double each = significance_ / double(std::max<std::size_t>(1, limits_.size()));
  const double degrees = double(std::max<std::size_t>(2, groups())) - 1;
  return boost::math::quantile(boost::math::complement(boost::math::students_t(degrees), each / 2));
}

/// Pictures that differ in every pixel by as little, and by as much, as the noise leaves possible.
LimitJudge::Bounds LimitJudge::failingBounds(const Picture& a, const Picture& b) const {
  Picture near = a, far = a;
  const auto n = double(groups());
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    double sum = 0, squares = 0;
    for (std::size_t g = 0; g < groups(); ++g) {
      const Group& group = groups_[g];
      const double d = (double(group.a.values[i]) - double(group.b.values[i])) / group.seeds;
      sum += d;
      squares += d * d;
    }
    double variance = n > 1 ? std::max(0.0, squares - sum * sum / n) / (n * (n - 1)) : 0;
    if (!variance_.empty()) variance += double(variance_[i]);
    const double noise = kSure * std::sqrt(variance);
    const double d = double(a.values[i]) - double(b.values[i]);
    near.values[i] = float(double(b.values[i]) + std::copysign(std::max(0.0, std::abs(d) - noise), d));
    far.values[i] = float(double(b.values[i]) + std::copysign(std::abs(d) + noise, d));
  }
  return {metricOf(Metric::FailingShare, near, b, region_, tolerance_),
          metricOf(Metric::FailingShare, far, b, region_, tolerance_)};
}

/// Of the true value, as a norm.
LimitJudge::Bounds LimitJudge::boundsOf(Metric metric, double value, double standardError, const Picture& a,
                                        const Picture& b) const {
  if (metric == Metric::FailingShare) return failingBounds(a, b);
  const double doubt = critical() * standardError;
  if (metric == Metric::BiasPercent) return {value - doubt, value + doubt};
  double noise = 0;
  const bool most = metric == Metric::MaxError;
  for (std::size_t p = 0; p < kPatterns; ++p) {
    const double one = toNorm(metric, metricOf(metric, noisy(b, p), b, region_, tolerance_));
    noise = most ? std::max(noise, one) : noise + one / double(kPatterns);
  }
  return {value - noise - doubt, value + doubt + (most ? noise : 0)};
}

std::vector<MetricResult> LimitJudge::judge() const {
  const auto [a, b] = meansWithout(kGroups);
  const bool exact = seeds_ < 2 && variance_.empty();
  std::vector<std::pair<Picture, Picture>> without;
  if (seeds_ > 1)
    for (std::size_t g = 0; g < groups(); ++g)
      without.push_back(meansWithout(g));
  std::vector<MetricResult> results;
  for (const auto& [metric, limit] : limits_) {
    MetricResult result;
    result.metric = metric;
    result.limit = limit;
    result.value = metricOf(metric, a, b, region_, tolerance_);
    const bool least = metricRow(metric).moreIsBetter;
    if (exact) {
      const bool kept = least ? result.value >= limit : std::abs(result.value) <= limit;
      result.outcome = kept ? Outcome::Same : Outcome::Differs;
      results.push_back(result);
      continue;
    }
    std::vector<double> norms, values;
    for (const auto& [x, y] : without) {
      values.push_back(metricOf(metric, x, y, region_, tolerance_));
      norms.push_back(toNorm(metric, values.back()));
    }
    const double error = jackknifeError(values);
    if (std::isfinite(error)) result.standardError = error;
    // A bias near 0 changes its sign from group to group, which its magnitude would hide.
    const double errorOfNorm = metric == Metric::BiasPercent ? error : jackknifeError(norms);
    const Bounds bounds = boundsOf(metric, toNorm(metric, result.value), errorOfNorm, a, b);
    const double most = toNorm(metric, limit);
    result.outcome = bounds.low > most     ? Outcome::Differs
                     : bounds.high <= most ? Outcome::Same
                                           : Outcome::CannotTell;
    results.push_back(result);
  }
  return results;
}

} // namespace chamfer
