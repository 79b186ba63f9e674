// The filters of FLIP, one-dimensional: all of its kernels are products of these, or sums of two products.
#pragma once

#include <cstddef>
#include <vector>

namespace chamfer {

/// An odd number of weights about the middle one.
struct FlipFilter {
  std::vector<float> weights;
  unsigned radius() const { return unsigned(weights.size() / 2); }
};

struct FlipFilters {
  /// Contrast sensitivity of the eye: achromatic, red-green; blue-yellow is the sum of two, filtered apart.
  FlipFilter achromatic, redGreen, blueYellow[2];
  /// A Gaussian and its derivatives, for edges and points.
  FlipFilter gauss, first, second;
  unsigned radius = 0; ///< the largest of all

  explicit FlipFilters(double pixelsPerDegree);
};

/// Rows are filtered so many numbers at a time: they begin where they like, but this many more can be read
/// and written behind their last multiple of it.
inline constexpr std::size_t kFlipLanes = 32;

/// to[i] = the sum over k of weights[k] * rows[k][i], for i below `count`, rounded up to whole lanes.
void weightedSum(const float* const* rows, const FlipFilter& filter, float* to, std::size_t count);

} // namespace chamfer
