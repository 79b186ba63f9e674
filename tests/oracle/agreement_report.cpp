// The words and numbers of an AgreementReport.
#include "tests/oracle/agreement.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace chamfer::oracle {
namespace {

constexpr std::size_t kExamples = 8;   // kept of a whole comparison
constexpr double kMostExcused = 0.005; // up to 0.2 % are in 2000 rays at one solid

std::string format(const char* pattern, auto... values) {
  char text[640];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

} // namespace

void ErrorHistogram::add(double value) {
  const double bin = value > 0 ? (std::log10(value) - kLowest) * kPerDecade + 1 : 0;
  ++bins_[std::size_t(std::clamp(bin, 0.0, double(bins_.size() - 1)))];
  ++count_;
  largest_ = std::max(largest_, value);
}

void ErrorHistogram::merge(const ErrorHistogram& other) {
  for (std::size_t i = 0; i < bins_.size(); ++i)
    bins_[i] += other.bins_[i];
  count_ += other.count_;
  largest_ = std::max(largest_, other.largest_);
}

double ErrorHistogram::quantile(double share) const {
  const double wanted = share * double(count_);
  double seen = 0;
  for (std::size_t i = 0; i < bins_.size() && count_ > 0; ++i) {
    seen += double(bins_[i]);
    if (seen >= wanted) return std::min(largest_, i ? std::pow(10, kLowest + double(i) / kPerDecade) : 0);
  }
  return 0;
}

const char* faultWord(Fault fault) {
  constexpr std::array kWords{"hit/miss", "position", "normal", "feature", "not finite"};
  return kWords[std::size_t(fault)];
}

std::string Disagreement::text() const {
  std::string s =
      format("%s off by %.3g: origin (%.17g, %.17g, %.17g) direction (%.17g, %.17g, %.17g) tnear %.17g;",
             faultWord(fault), measure, ray.origin.x(), ray.origin.y(), ray.origin.z(), ray.direction.x(),
             ray.direction.y(), ray.direction.z(), ray.tnear);
  if (answer)
    s += format(" answer t %.12g normal (%.6f, %.6f, %.6f) %s;", answer->t, answer->normal.x(),
                answer->normal.y(), answer->normal.z(), featureWord(answer->feature));
  else
    s += " answer none;";
  if (truth)
    s += format(" truth t %.12Lg normal (%.6Lf, %.6Lf, %.6Lf) %s, part %zu", truth->t, truth->normal.x(),
                truth->normal.y(), truth->normal.z(), featureWord(truth->feature), truth->part);
  else
    s += " truth none";
  return s;
}

std::size_t AgreementReport::disagreements() const {
  std::size_t sum = 0;
  for (const std::size_t n : faults)
    sum += n;
  return sum;
}

bool AgreementReport::agrees(double mostExcused) const {
  const bool excusable = excused <= 1 || double(excused) <= mostExcused * double(rays);
  return rays > 0 && disagreements() == 0 && excusable;
}

bool AgreementReport::agrees() const { return agrees(kMostExcused); }

std::string AgreementReport::summary() const {
  return format(
      "%zu rays, %zu hits (%zu rounded), %zu excused, faults: hit/miss %zu position %zu normal %zu feature "
      "%zu not-finite %zu; p50/p99/max across %.1e/%.1e/%.1e D, %.1e/%.1e/%.1e r; along %.1e/%.1e/%.1e D, "
      "%.1e/%.1e/%.1e r; normal %.1e/%.1e/%.1e deg",
      rays, hits, roundedHits, excused, faults[0], faults[1], faults[2], faults[3], faults[4],
      across.quantile(.5), across.quantile(.99), across.largest(), acrossOfRadius.quantile(.5),
      acrossOfRadius.quantile(.99), acrossOfRadius.largest(), along.quantile(.5), along.quantile(.99),
      along.largest(), alongOfRadius.quantile(.5), alongOfRadius.quantile(.99), alongOfRadius.largest(),
      normalDegrees.quantile(.5), normalDegrees.quantile(.99), normalDegrees.largest());
}

std::string AgreementReport::complaint() const {
  std::string s = summary();
  if (disagreements() == 0) s += "\n  no faults, but too many of the rays are excused";
  for (const Disagreement& example : examples)
    s += "\n  " + example.text();
  return s;
}

void AgreementReport::merge(const AgreementReport& other) {
  rays += other.rays;
  hits += other.hits;
  roundedHits += other.roundedHits;
  excused += other.excused;
  for (std::size_t i = 0; i < faults.size(); ++i)
    faults[i] += other.faults[i];
  across.merge(other.across);
  along.merge(other.along);
  acrossOfRadius.merge(other.acrossOfRadius);
  alongOfRadius.merge(other.alongOfRadius);
  normalDegrees.merge(other.normalDegrees);
  for (const Disagreement& example : other.examples)
    if (examples.size() < kExamples) examples.push_back(example);
}

} // namespace chamfer::oracle
