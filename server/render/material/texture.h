// Images looked up at surface points or directions. Immutable; reading files is image_io's business.
#pragma once

#include "common/digest.h"
#include "server/render/image/color.h"

#include <cstddef>
#include <vector>

namespace chamfer {

/// Linear RGB pixels, [height][width], top row first.
class Texture {
public:
  /// Throws Error(Internal) unless width * height pixels are given and there is at least one.
  Texture(unsigned width, unsigned height, std::vector<Color> pixels);

  /// Bilinear, repeating; (0, 0) is the image's lower left corner, as in OBJ files.
  Color at(float u, float v) const;
  const Color& pixel(unsigned x, unsigned y) const { return pixels_[std::size_t(y) * width_ + x]; }
  unsigned width() const { return width_; }
  unsigned height() const { return height_; }
  std::size_t memoryBytes() const { return pixels_.size() * sizeof(Color); }
  Digest contentDigest() const; ///< of size and pixels

private:
  unsigned width_, height_;
  std::vector<Color> pixels_;
};

} // namespace chamfer
