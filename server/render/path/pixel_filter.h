// The reconstruction filter, sampled: every sample of a pixel is drawn from the filter around the pixel's
// centre and weighs the same (Ernst, Stamminger, Greiner, "Filter Importance Sampling", IEEE RT 2006). So a
// pixel depends on its own samples alone, and a tile is the crop of the frame, bit for bit.
#pragma once

#include "server/render/path/sampler.h"

#include <algorithm>
#include <array>
#include <cmath>

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
    // By symmetry from the share of the filter that lies beyond the offset. Its fourth root opens up the
    // tail, where the offset changes fast.
    const float side = 2 * u - 1;
    const float x = std::sqrt(std::sqrt(std::max(0.f, 1 - std::abs(side)))) * kCells;
    const auto i = std::min(std::size_t(x), std::size_t(kCells - 1));
    return std::copysign(table_[i] + (table_[i + 1] - table_[i]) * (x - float(i)), side);
  }
  static constexpr int kCells = 256;
  std::array<float, kCells + 1> table_; ///< offset by fourth root of the share beyond it, from kRadius to 0
};

} // namespace chamfer
