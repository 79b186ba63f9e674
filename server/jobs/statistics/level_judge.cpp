#include "server/jobs/statistics/level_judge.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace chamfer {
namespace {

constexpr double kBrightnessFloor = 0.1; ///< of the whole picture's

} // namespace

unsigned looksOf(unsigned mostSeeds) {
  return mostSeeds < kFirstLook ? 1 : unsigned(std::bit_width(mostSeeds / kFirstLook));
}

bool isLook(unsigned seeds, unsigned mostSeeds) {
  if (mostSeeds < kFirstLook) return seeds == mostSeeds;
  return seeds >= kFirstLook && seeds % kFirstLook == 0 && std::has_single_bit(seeds / kFirstLook);
}

unsigned lastLook(unsigned mostSeeds) {
  return mostSeeds < kFirstLook ? mostSeeds : kFirstLook * std::bit_floor(mostSeeds / kFirstLook);
}

std::vector<float> brightnessOf(const LevelGrid& grid, std::span<const float> a, std::span<const float> b) {
  const unsigned channels = grid.channels(), colours = channels == 4 ? 3 : channels;
  std::vector<float> brightness(grid.size());
  double whole = 0;
  for (std::size_t block = 0; block * channels < grid.size(); ++block) {
    double sum = 0;
    for (std::size_t c = 0; c < colours; ++c)
      sum += std::abs(double(a[block * channels + c])) + std::abs(double(b[block * channels + c]));
    sum /= 2 * colours;
    whole += sum;
    std::fill_n(brightness.begin() + std::ptrdiff_t(block * channels), channels, float(sum));
  }
  whole *= double(channels) / double(std::max<std::size_t>(1, grid.tests()));
  const float least =
      whole > 0 ? float(kBrightnessFloor * whole) : 1; // of black pictures: absolute differences
  for (float& value : brightness)
    value = std::max(value, least);
  return brightness;
}

LevelResult judgeLevel(const LevelRow& row, const LevelGrid& grid, const LevelEvidence& e,
                       const StatisticsChoice& choice, double significance) {
  LevelResult result;
  result.level = row.name;
  result.block = row.block;
  result.tests = grid.tests();
  result.pValue = std::min(1.0, e.pValue);
  result.worst = grid.rectOf(e.worst);
  result.channel = unsigned(e.worst % grid.channels());
  result.a = double(e.a[e.worst]);
  result.b = double(e.b[e.worst]);
  result.resolution = choice.resolution.*row.of;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const double unit = double(e.brightness[i]);
    result.seenFrom = std::max(result.seenFrom, double(e.halfWidths[i]) / unit);
    result.boundedBy = std::max(result.boundedBy,
                                (std::abs(double(e.a[i]) - double(e.b[i])) + double(e.halfWidths[i])) / unit);
  }
  if (e.pValue < significance)
    result.outcome = Outcome::Differs;
  else
    result.outcome = result.boundedBy <= result.resolution ? Outcome::Same : Outcome::CannotTell;
  return result;
}

} // namespace chamfer
