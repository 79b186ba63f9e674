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

/// Reads EXR, PNG, HDR and whatever else OpenImageIO knows. Channels R, G, B and A, or Y, count, in any
/// order; a single channel of another name is grey, too; grey with alpha becomes RGBA. Where they stand in
/// layers only ("ViewLayer.Combined.R"), the only layer that has them. Other channels are left out. A
/// variance stands in channels variance.R and so on, for all of the picture's channels. Integer pixels are
/// sRGB unless the file says that they are linear. Error(NotFound), Error(Malformed) with the reason:
/// unreadable, several layers or none (the message lists the channels), several pictures in one file, a part
/// of a frame, a variance of some channels only or a negative one.
Picture readPicture(const std::filesystem::path& file);

/// 32-bit float EXR with the variance, if there is one, and the attributes. Deterministic bytes; atomic. That
/// a picture came from sRGB pixels is not kept: it is read back as a linear one. Error(CannotWrite).
void writePicture(const std::filesystem::path& file, const Picture& picture);

} // namespace chamfer
