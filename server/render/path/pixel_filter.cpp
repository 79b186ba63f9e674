#include "server/render/path/pixel_filter.h"

#include <numbers>

namespace chamfer {
namespace {

/// Share of the filter that lies farther out than `x`, a share of the radius.
double beyond(double x) {
  constexpr double a0 = 0.35875, a1 = 0.48829, a2 = 0.14128, a3 = 0.01168, pi = std::numbers::pi;
  return 1 - x -
         (a1 / pi * std::sin(pi * x) + a2 / (2 * pi) * std::sin(2 * pi * x) +
          a3 / (3 * pi) * std::sin(3 * pi * x)) /
             a0;
}

} // namespace

PixelFilter::PixelFilter() {
  for (int i = 0; i <= kCells; ++i) {
    const double share = std::pow(double(i) / kCells, 4);
    double low = 0, high = 1;
    for (int step = 0; step < 60; ++step) {
      const double middle = (low + high) / 2;
      (beyond(middle) > share ? low : high) = middle;
    }
    table_[std::size_t(i)] = float((low + high) / 2) * kRadius;
  }
}

const PixelFilter& PixelFilter::instance() {
  static const PixelFilter filter;
  return filter;
}

} // namespace chamfer
