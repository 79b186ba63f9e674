// What both tests (statistics.h) share: the scales with their shares of the significance, brightness, and the
// verdict that follows from differences and their bounds.
#pragma once

#include "server/jobs/statistics/level_grid.h"
#include "server/jobs/statistics/statistics.h"

#include <array>
#include <span>

namespace chamfer {

struct LevelRow {
  const char* name;
  unsigned block;       ///< as LevelGrid's
  double share;         ///< of the significance of a look
  double PerLevel::*of; ///< its place in choices
};
inline constexpr std::array<LevelRow, 3> kLevels = {{{"pixel", 1, 0.5, &PerLevel::pixel},
                                                     {"block", 8, 0.25, &PerLevel::block},
                                                     {"image", 0, 0.25, &PerLevel::image}}};

/// Differences below this part of the brightness are float32's rounding.
inline constexpr double kRoundingShare = 1e-6;

/// Of each value of the level: what differences there are relative to. Above 0.
std::vector<float> brightnessOf(const LevelGrid& grid, std::span<const float> a, std::span<const float> b);

/// What a test knows about one level.
struct LevelEvidence {
  std::span<const float> a, b; ///< means, as the grid's values
  std::span<const float> brightness;
  std::span<const float> halfWidths; ///< of simultaneous confidence intervals about a - b
  std::size_t worst = 0;             ///< the value that stands out most
  double pValue = 1;                 ///< that something as far out as it would be seen if nothing differed
};

/// The level's result; `significance`: of this look at this level. Differs where the p-value is below it.
LevelResult judgeLevel(const LevelRow& row, const LevelGrid& grid, const LevelEvidence& evidence,
                       const StatisticsChoice& choice, double significance);

} // namespace chamfer
