#include "server/render/light/distribution.h"

#include <algorithm>
#include <numeric>

namespace chamfer {
namespace {

constexpr float kBelowOne = 0x1.fffffep-1f;

/// Writes `count` + 1 cumulative values from 0 to 1 of `values`; uniform where their sum is 0. Returns the
/// sum.
double accumulate(const double* values, unsigned count, float* out) {
  const double sum = std::accumulate(values, values + count, 0.0);
  double running = 0;
  for (unsigned i = 0; i < count; ++i) {
    out[i] = sum > 0 ? float(running / sum) : float(i) / float(count);
    running += values[i];
  }
  out[count] = 1;
  return sum;
}

/// The cell of a cumulative table that holds `u`, and where in it.
struct Cell {
  unsigned index;
  float offset, probability;
};
Cell find(const float* cumulative, unsigned count, float u) {
  // The last entry is 1 > u, so the upper bound exists; cells of no width are never found.
  const auto above = std::upper_bound(cumulative, cumulative + count + 1, u);
  const unsigned i = std::min(unsigned(above - cumulative) - 1, count - 1);
  const float width = cumulative[i + 1] - cumulative[i];
  return {i, width > 0 ? std::min((u - cumulative[i]) / width, kBelowOne) : 0, width};
}

} // namespace

AliasTable::AliasTable(const std::vector<double>& weights) : entries_(weights.size()) {
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  std::vector<double> scaled(weights.size());
  std::vector<std::uint32_t> small, large;
  for (std::uint32_t i = 0; i < weights.size(); ++i) {
    entries_[i] = {1, i, float(weights[i] / sum)};
    scaled[i] = weights[i] / sum * double(weights.size());
    (scaled[i] < 1 ? small : large).push_back(i);
  }
  while (!small.empty() && !large.empty()) {
    const std::uint32_t s = small.back(), l = large.back();
    small.pop_back();
    entries_[s].keep = float(scaled[s]);
    entries_[s].alias = l;
    scaled[l] -= 1 - scaled[s];
    if (scaled[l] < 1) {
      large.pop_back();
      small.push_back(l);
    }
  }
}

Distribution2D::Distribution2D(unsigned width, unsigned height, const std::vector<float>& values)
    : width_(width), height_(height), rows_(height + 1), columns_(std::size_t(height) * (width + 1)) {
  std::vector<double> sums(height), row(width);
  for (unsigned y = 0; y < height; ++y) {
    std::copy_n(values.begin() + std::ptrdiff_t(y) * width, width, row.begin());
    sums[y] = accumulate(row.data(), width, columns_.data() + std::size_t(y) * (width + 1));
  }
  accumulate(sums.data(), height, rows_.data());
}

Distribution2D::Point Distribution2D::sample(const Float2& u) const {
  const Cell y = find(rows_.data(), height_, u.y);
  const Cell x = find(columns_.data() + std::size_t(y.index) * (width_ + 1), width_, u.x);
  return {(float(x.index) + x.offset) / float(width_), (float(y.index) + y.offset) / float(height_),
          x.probability * y.probability * float(width_) * float(height_)};
}

float Distribution2D::density(float x, float y) const {
  const unsigned i = std::min(unsigned(std::max(0.f, x) * float(width_)), width_ - 1);
  const unsigned j = std::min(unsigned(std::max(0.f, y) * float(height_)), height_ - 1);
  const float* column = columns_.data() + std::size_t(j) * (width_ + 1) + i;
  return (column[1] - column[0]) * (rows_[j + 1] - rows_[j]) * float(width_) * float(height_);
}

} // namespace chamfer
