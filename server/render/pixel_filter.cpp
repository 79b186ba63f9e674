#include "server/render/pixel_filter.h"

#include <cmath>
#include <numbers>

namespace chamfer {
namespace {

/// Integral of the window from -1 to x (both as shares of the radius), 0..1.
double cumulative(double x) {
  constexpr double a0 = 0.35875, a1 = 0.48829, a2 = 0.14128, a3 = 0.01168, pi = std::numbers::pi;
  return (a0 * (x + 1) + a1 / pi * std::sin(pi * x) + a2 / (2 * pi) * std::sin(2 * pi * x) +
          a3 / (3 * pi) * std::sin(3 * pi * x)) /
         (2 * a0);
}

} // namespace

PixelFilter::PixelFilter() {
  for (int i = 0; i <= kCells; ++i) {
    const double u = double(i) / kCells;
    double low = -1, high = 1;
    for (int step = 0; step < 60; ++step) {
      const double middle = (low + high) / 2;
      (cumulative(middle) < u ? low : high) = middle;
    }
    table_[std::size_t(i)] = float((low + high) / 2) * kRadius;
  }
}

const PixelFilter& PixelFilter::instance() {
  static const PixelFilter filter;
  return filter;
}

} // namespace chamfer
