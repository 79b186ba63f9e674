// Sampling of tabulated densities.
#pragma once

#include "server/render/path/sampler.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace chamfer {

/// Discrete choice in constant time (Vose's alias table). Weights are finite and not negative, their sum is
/// above 0.
class AliasTable {
public:
  AliasTable() = default;
  explicit AliasTable(const std::vector<double>& weights);
  struct Choice {
    std::uint32_t index;
    float probability;
  };
  Choice sample(float u) const {
    const float x = u * float(entries_.size());
    const auto i = std::min(std::uint32_t(x), std::uint32_t(entries_.size() - 1));
    const Entry& e = entries_[i];
    const std::uint32_t index = x - float(i) < e.keep ? i : e.alias;
    return {index, entries_[index].probability};
  }
  float probability(std::uint32_t index) const { return entries_[index].probability; }
  std::size_t size() const { return entries_.size(); }
  std::size_t memoryBytes() const { return entries_.size() * sizeof(Entry); }

private:
  struct Entry {
    float keep; ///< chance of the entry itself against its alias
    std::uint32_t alias;
    float probability;
  };
  std::vector<Entry> entries_;
};

/// Piecewise-constant density on the unit square, [height][width] cells, row 0 at y = 0.
class Distribution2D {
public:
  Distribution2D() = default;
  /// Values finite and not negative; where all are zero the density is uniform.
  Distribution2D(unsigned width, unsigned height, const std::vector<float>& values);
  struct Point {
    float x, y;
    float density; ///< with respect to area of the unit square
  };
  Point sample(const Float2& u) const;
  float density(float x, float y) const;
  std::size_t memoryBytes() const { return (rows_.size() + columns_.size()) * sizeof(float); }

private:
  unsigned width_ = 0, height_ = 0;
  std::vector<float> rows_;    ///< [height + 1] cumulative
  std::vector<float> columns_; ///< [height][width + 1] cumulative within a row
};

} // namespace chamfer
