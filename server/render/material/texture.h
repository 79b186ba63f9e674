// Images looked up at surface points or directions. Immutable; reading files is image_io's business.
#pragma once

#include "common/digest.h"
#include "server/render/image/color.h"

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

namespace chamfer {

/// How an image lies over texture coordinates: looked up at coordinate * scale + offset, beyond 0..1 repeated
/// or, when clamped, as its border.
struct TexturePlacement {
  std::array<float, 2> scale{1, 1}, offset{0, 0};
  bool clamp = false;

  auto operator<=>(const TexturePlacement&) const = default;
};

/// Linear RGB pixels, [height][width], top row first, and their placement. Copies share the pixels.
class Texture {
public:
  /// Throws Error(Internal) unless width * height pixels are given and there is at least one.
  Texture(unsigned width, unsigned height, std::vector<Color> pixels);

  /// The same image, placed otherwise.
  Texture placed(const TexturePlacement& placement) const;

  /// Bilinear; (0, 0) is the image's lower left corner, as in OBJ files.
  Color at(float u, float v) const;
  const TexturePlacement& placement() const { return placement_; }
  const Color& pixel(unsigned x, unsigned y) const { return (*pixels_)[std::size_t(y) * width_ + x]; }
  const void* pixels() const { return pixels_.get(); } ///< the same for all that share them
  unsigned width() const { return width_; }
  unsigned height() const { return height_; }
  std::size_t memoryBytes() const { return pixels_->size() * sizeof(Color); } ///< of the pixels
  Digest contentDigest() const; ///< of size and pixels, whatever the placement

private:
  unsigned width_, height_;
  std::shared_ptr<const std::vector<Color>> pixels_;
  TexturePlacement placement_;
};

} // namespace chamfer
