// The scales at which two pictures' means are compared: single pixels find what is local, blocks and the
// whole picture find what is small.
#pragma once

#include "server/jobs/image/region.h"

#include <cstddef>
#include <span>
#include <vector>

namespace chamfer {

/// A region cut into blocks, the last of a row or column perhaps smaller. Only counting pixels are in their
/// means.
class LevelGrid {
public:
  /// `block`: side in pixels; 0: the whole region is one block.
  LevelGrid(const Region& region, unsigned channels, unsigned block);

  unsigned block() const { return block_; }
  unsigned columns() const { return columns_; }
  unsigned rows() const { return rows_; }
  unsigned channels() const { return channels_; }
  /// Values of the level: [rows][columns][channels].
  std::size_t size() const { return std::size_t(columns_) * rows_ * channels_; }
  /// Of these, how many have a counting pixel.
  std::size_t tests() const;

  /// The blocks' means; 0 where no pixel counts. `values`: [height][width][channels] of the crop.
  std::vector<float> means(std::span<const float> values) const;
  /// The variance of the blocks' means where the pixels' noise is independent, as the sampler's is.
  std::vector<float> variances(std::span<const float> pixelVariances) const;
  /// Each value, or the mean of it and its up to eight neighbours of the same channel (those with counting
  /// pixels) where that is larger. Of few seeds a place's own variance is unreliable: none may have met a
  /// rare path that another meets.
  std::vector<float> raisedToNeighbours(std::span<const float> level) const;
  /// The block of a value of the level, in the frame.
  TileRect rectOf(std::size_t value) const;

private:
  /// The block of a pixel of the crop.
  std::size_t blockAt(unsigned x, unsigned y) const {
    return block_ == 0 ? 0 : std::size_t(y / block_) * columns_ + x / block_;
  }
  std::vector<double> sums(std::span<const float> values) const;

  TileRect crop_;
  unsigned channels_, block_, columns_, rows_;
  std::vector<std::uint8_t> counts_; ///< of the region
  std::vector<unsigned> pixels_;     ///< [rows][columns]: that count
};

} // namespace chamfer
