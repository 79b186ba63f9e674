// A picture as comparisons hold it: numbers, whatever file or render they came from.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace chamfer {

struct Picture {
  unsigned width = 0, height = 0;
  unsigned channels = 0;     ///< 1: grey; 3: RGB; 4: RGB and alpha
  std::vector<float> values; ///< [height][width][channels], top row first; linear, Rec. 709 primaries; as
                             ///< they are in the file: NaN and infinities stay
  /// Variance of `values` as the means of random samples, of their shape; empty: not known, taken as exact.
  std::vector<float> variance;
  bool display = false; ///< from integer pixels, sRGB-encoded: no value beyond 0..1 could be stored
  std::map<std::string, std::string> about; ///< attributes of the file whose names begin with "chamfer:"

  std::size_t pixels() const { return std::size_t(width) * height; }
};

/// Values that are no numbers, and the first place of one.
struct NonFinite {
  std::size_t count = 0; ///< values, not pixels
  unsigned x = 0, y = 0, channel = 0;
};

/// In the values; those of the variance count, too.
NonFinite nonFiniteOf(const Picture& picture);

/// Reads EXR, PNG, HDR and whatever else OpenImageIO knows. Of a file with layers those of the names R, G, B,
/// A (or Y) count; a variance stands in channels variance.R and so on (writePicture()). Error(NotFound),
/// Error(Malformed) with the reason.
Picture readPicture(const std::filesystem::path& file);

/// 32-bit float EXR with the variance, if there is one, and the attributes. Atomic. Error(CannotWrite).
void writePicture(const std::filesystem::path& file, const Picture& picture);

} // namespace chamfer
