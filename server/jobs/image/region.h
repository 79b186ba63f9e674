// The part of a picture that a comparison looks at: a crop, and within it a mask.
#pragma once

#include "server/jobs/image/picture.h"
#include "server/render/path/render.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace chamfer {

/// "x,y,w,h". Error(Usage); Error(OutOfRange) where width or height is 0.
TileRect parsePixelRect(std::string_view text);

/// What a case says about which pixels count, in the frame's coordinates.
struct RegionChoice {
  std::optional<TileRect> crop; ///< nothing: the whole picture
  /// An image of the frame's size: pixels count whose largest colour channel is above half of white as it is
  /// stored (128 to 255 of 8 bits), and whose alpha is, if there is one. Empty: all.
  std::filesystem::path mask;
  std::vector<TileRect> only, except; ///< pixels in any of `only` (empty: all), but in none of `except`
};

/// For one size of pictures.
struct Region {
  TileRect crop;
  std::vector<std::uint8_t> counts; ///< [crop.height][crop.width], 0 or 1; empty: all do
  std::size_t pixels = 0;           ///< that count; at least 1
  /// Of masks and rectangles, for reports, with how many pixels count; empty: there are none of them.
  std::string text;
};

/// Error(OutOfRange): a crop or rectangle beyond the frame, a mask of another size, a region without any
/// pixel. Reads the mask: readPicture()'s errors.
Region regionOf(const RegionChoice& choice, unsigned frameWidth, unsigned frameHeight);

/// The crop's part of the picture, variance and attributes included.
Picture cropped(const Picture& picture, const TileRect& crop);

} // namespace chamfer
