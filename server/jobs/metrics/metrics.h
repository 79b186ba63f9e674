// Numbers for how two pictures differ: "a" is judged, "b" is what it is judged by.
#pragma once

#include "server/jobs/image/picture.h"
#include "server/jobs/image/region.h"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace chamfer {

enum class Metric : std::uint8_t {
  Mae,          ///< mean |a - b|
  Rmse,         ///< root of the mean of (a - b)^2
  RelMse,       ///< mean of (a - b)^2 / (b^2 + 0.01)   (Rousselle et al. 2011)
  Psnr,         ///< dB, 10 log10(1 / MSE) of the linear values, whatever the file held; +inf for equal ones
  MaxError,     ///< largest |a - b|
  BiasPercent,  ///< 100 (mean a - mean b) / mean |b|; infinite where b is black and the means differ
  FailingShare, ///< share of pixels of which any channel has |a - b| > absolute + relative |b|
  Flip,         ///< mean of the FLIP error map, 0..1
};

struct MetricRow {
  Metric metric;
  std::string_view name; ///< as limits and reports spell it: "mae", "bias_percent"
  std::string_view unit; ///< empty: none
  bool moreIsBetter;     ///< its limit is a least value (psnr), else a largest one of the magnitude
  double most;           ///< largest limit that means anything (share and FLIP: 1)
  std::string_view about;
};
std::span<const MetricRow> metricRows();
const MetricRow& metricRow(Metric metric);
/// Error(Usage) that lists the known names.
Metric parseMetric(std::string_view name);

/// What a pixel of FailingShare may differ by.
struct PixelTolerance {
  double absolute = 0, relative = 0;
  bool operator==(const PixelTolerance&) const = default;
};

/// `a` and `b`: of the region's crop, of one number of channels, every counting value finite (the caller has
/// looked: requireComparable()). Means are over the counting pixels' channels, alpha like the others, in
/// double. What does not count has no influence, on FLIP neither: where it lies beside what does, `a` is
/// taken to be equal to `b` there.
double metricOf(Metric metric, const Picture& a, const Picture& b, const Region& region,
                const PixelTolerance& tolerance = {});

/// Where |a - b| is largest among the counting pixels: the first such place, row by row; of equal pictures
/// the first that counts, with an error of 0.
struct LargestError {
  unsigned x = 0, y = 0, channel = 0; ///< in the frame
  double a = 0, b = 0, error = 0;
};
LargestError largestError(const Picture& a, const Picture& b, const Region& region);

/// Throws Error(OutOfRange) that says what stands against a comparison: other sizes, other channels, display
/// against linear pixels, values that are no finite numbers (how many, where the first is; in pixels that the
/// region leaves out, too: a mask is no excuse for them). `aName`, `bName` stand in messages.
void requireComparable(const Picture& a, const Picture& b, const std::string& aName,
                       const std::string& bName);

} // namespace chamfer
