#include "server/jobs/statistics/level_grid.h"

#include <algorithm>

namespace chamfer {
namespace {

unsigned blocksAlong(unsigned pixels, unsigned block) { return block == 0 ? 1 : (pixels - 1) / block + 1; }

} // namespace

LevelGrid::LevelGrid(const Region& region, unsigned channels, unsigned block)
    : crop_(region.crop), channels_(channels), block_(block), columns_(blocksAlong(region.crop.width, block)),
      rows_(blocksAlong(region.crop.height, block)), counts_(region.counts),
      pixels_(std::size_t(columns_) * rows_, 0) {
  for (unsigned y = 0; y < crop_.height; ++y)
    for (unsigned x = 0; x < crop_.width; ++x)
      pixels_[blockAt(x, y)] += counts_.empty() || counts_[std::size_t(y) * crop_.width + x] != 0;
}

std::size_t LevelGrid::tests() const {
  return channels_ *
         std::size_t(std::count_if(pixels_.begin(), pixels_.end(), [](unsigned n) { return n > 0; }));
}

std::vector<double> LevelGrid::sums(std::span<const float> values) const {
  std::vector<double> sums(size(), 0);
  for (unsigned y = 0; y < crop_.height; ++y)
    for (unsigned x = 0; x < crop_.width; ++x) {
      const std::size_t pixel = std::size_t(y) * crop_.width + x;
      if (!counts_.empty() && counts_[pixel] == 0) continue;
      const std::size_t at = blockAt(x, y) * channels_;
      for (unsigned c = 0; c < channels_; ++c)
        sums[at + c] += double(values[pixel * channels_ + c]);
    }
  return sums;
}

std::vector<float> LevelGrid::means(std::span<const float> values) const {
  const std::vector<double> sum = sums(values);
  std::vector<float> means(sum.size());
  for (std::size_t i = 0; i < means.size(); ++i)
    means[i] = float(sum[i] / std::max(1u, pixels_[i / channels_]));
  return means;
}

std::vector<float> LevelGrid::variances(std::span<const float> pixelVariances) const {
  const std::vector<double> sum = sums(pixelVariances);
  std::vector<float> variances(sum.size());
  for (std::size_t i = 0; i < variances.size(); ++i) {
    const double n = std::max(1u, pixels_[i / channels_]);
    variances[i] = float(sum[i] / (n * n));
  }
  return variances;
}

std::vector<float> LevelGrid::raisedToNeighbours(std::span<const float> level) const {
  std::vector<float> raised(level.begin(), level.end());
  for (unsigned y = 0; y < rows_; ++y)
    for (unsigned x = 0; x < columns_; ++x)
      for (unsigned c = 0; c < channels_; ++c) {
        double sum = 0;
        unsigned near = 0;
        for (unsigned v = y == 0 ? 0 : y - 1; v <= std::min(y + 1, rows_ - 1); ++v)
          for (unsigned u = x == 0 ? 0 : x - 1; u <= std::min(x + 1, columns_ - 1); ++u) {
            const std::size_t block = std::size_t(v) * columns_ + u;
            if (pixels_[block] == 0) continue;
            sum += double(level[block * channels_ + c]);
            ++near;
          }
        if (near == 0) continue;
        float& value = raised[(std::size_t(y) * columns_ + x) * channels_ + c];
        value = std::max(value, float(sum / near));
      }
  return raised;
}

TileRect LevelGrid::rectOf(std::size_t value) const {
  const std::size_t at = value / channels_;
  const unsigned x = unsigned(at % columns_), y = unsigned(at / columns_);
  if (block_ == 0) return crop_;
  return {crop_.x + x * block_, crop_.y + y * block_, std::min(block_, crop_.width - x * block_),
          std::min(block_, crop_.height - y * block_)};
}

} // namespace chamfer
