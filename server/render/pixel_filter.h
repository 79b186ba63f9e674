// The reconstruction filter, sampled: every sample of a pixel is drawn from the filter around the pixel's
// centre and weighs the same (Ernst, Stamminger, Greiner, "Filter Importance Sampling", IEEE RT 2006). So a
// pixel depends on its own samples alone, and a tile is the crop of the frame, bit for bit.
#pragma once

#include "server/render/sampler.h"

#include <array>

namespace chamfer {

/// Blackman-Harris, separable, radius 1.5 pixels.
class PixelFilter {
public:
  static const PixelFilter& instance();
  /// Offset from the pixel's centre, each coordinate within +-1.5.
  Float2 sample(const Float2& u) const { return {inverse(u.x), inverse(u.y)}; }
  static constexpr float kRadius = 1.5f;

private:
  PixelFilter();
  float inverse(float u) const {
    const float x = u * kCells;
    const int i = int(x);
    return table_[std::size_t(i)] + (table_[std::size_t(i) + 1] - table_[std::size_t(i)]) * (x - float(i));
  }
  static constexpr int kCells = 512;
  std::array<float, kCells + 1> table_; ///< inverse of the cumulative filter
};

} // namespace chamfer
