// What is to be compared, and how: cases in a checked-in file (data/COMPARISONS.md describes it), in the body
// of a request, or from a command line.
#pragma once

#include "server/jobs/image/region.h"
#include "server/jobs/metrics/metrics.h"
#include "server/jobs/statistics/statistics.h"
#include "server/jobs/suite/side.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace chamfer {

inline constexpr unsigned kUsualSeeds = 128, kMostSeeds = 4096;
inline constexpr unsigned kUsualSamples = 4;
inline constexpr unsigned kUsualWidth = 640, kUsualHeight = 360;

struct CaseChoice {
  std::string name;
  SideChoice a, b;                  ///< a is judged by b
  unsigned width = 0, height = 0;   ///< of the frame; 0: the other side's, else kUsualWidth x kUsualHeight
  unsigned samples = kUsualSamples; ///< of each pixel, of every seed
  /// The budget. 1: the pictures themselves are compared, noise and all. Nothing: kUsualSeeds.
  std::optional<unsigned> seeds;
  double seconds = 0; ///< the budget in time, checked between seeds; 0: none
  RegionChoice region;
  PixelTolerance tolerance; ///< of failing_share
  std::vector<std::pair<Metric, double>> limits;
  /// Nothing: where a side is rendered from several seeds and there are no limits.
  std::optional<bool> wantsStatistics;
  StatisticsChoice statistics; ///< its mostSeeds is the case's

  bool renders() const { return a.isRender() || b.isRender(); }
  unsigned budget() const { return renders() ? seeds.value_or(kUsualSeeds) : 0; }
  bool judgesStatistics() const {
    return wantsStatistics.value_or(budget() > 1 && limits.empty() && b.kind != SideKind::Digest);
  }
};

/// Throws Error(Usage), Error(OutOfRange) for choices that do not go together: statistics of one seed, a
/// digest as the judged side, settings of renders where there is none.
void checkCase(const CaseChoice& choice);

/// Strict: every unknown key, wrong kind and value outside its limits is an Error(Malformed) that names the
/// key's path in `file`. Files are named relative to the suite's folder. Every case has been checked.
std::vector<CaseChoice> parseSuite(const std::string& json, const std::string& file);

} // namespace chamfer
