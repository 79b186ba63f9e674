#include "server/render/material/texture.h"

#include "common/error.h"

#include <algorithm>

namespace chamfer {
namespace {

/// The two pixels around coordinate `c` (in units of the image's size) and the weight of the second.
struct Taps {
  unsigned a, b;
  float weight;
};
Taps taps(float c, unsigned size, bool clamp) {
  if (!std::isfinite(c)) return {0, 0, 0};
  if (clamp) {
    const float x = std::clamp(c * float(size) - 0.5f, 0.f, float(size - 1)), low = std::floor(x);
    const auto a = unsigned(low);
    return {a, std::min(a + 1, size - 1), x - low};
  }
  const float x = (c - std::floor(c)) * float(size) - 0.5f, low = std::floor(x);
  const int i = int(low);
  const unsigned a = i < 0 ? size - 1 : std::min(unsigned(i), size - 1);
  return {a, a + 1 == size ? 0 : a + 1, x - low};
}

} // namespace

Texture::Texture(unsigned width, unsigned height, std::vector<Color> pixels)
    : width_(width), height_(height), pixels_(std::make_shared<const std::vector<Color>>(std::move(pixels))) {
  if (pixels_->empty() || pixels_->size() != std::size_t(width) * height)
    throw Error(ErrorKind::Internal, "a texture's pixels do not fill its width and height");
}

Texture Texture::placed(const TexturePlacement& placement) const {
  Texture other = *this;
  other.placement_ = placement;
  return other;
}

Color Texture::at(float u, float v) const {
  const TexturePlacement& p = placement_;
  const Taps x = taps(u * p.scale[0] + p.offset[0], width_, p.clamp),
             y = taps(1 - (v * p.scale[1] + p.offset[1]), height_, p.clamp);
  return lerp(lerp(pixel(x.a, y.a), pixel(x.b, y.a), x.weight),
              lerp(pixel(x.a, y.b), pixel(x.b, y.b), x.weight), y.weight);
}

Digest Texture::contentDigest() const {
  return digestOf(std::to_string(width_) + "x" + digestOf(std::as_bytes(std::span(*pixels_))).hex());
}

} // namespace chamfer
