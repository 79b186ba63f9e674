#include "server/render/material/texture.h"

#include "common/error.h"

namespace chamfer {
namespace {

/// The two pixels around coordinate `c` (in units of the image's size) and the weight of the second.
struct Taps {
  unsigned a, b;
  float weight;
};
Taps taps(float c, unsigned size) {
  if (!std::isfinite(c)) return {0, 0, 0};
  const float x = (c - std::floor(c)) * float(size) - 0.5f, low = std::floor(x);
  const int i = int(low);
  const unsigned a = i < 0 ? size - 1 : std::min(unsigned(i), size - 1);
  return {a, a + 1 == size ? 0 : a + 1, x - low};
}

} // namespace

Texture::Texture(unsigned width, unsigned height, std::vector<Color> pixels)
    : width_(width), height_(height), pixels_(std::move(pixels)) {
  if (pixels_.empty() || pixels_.size() != std::size_t(width) * height)
    throw Error(ErrorKind::Internal, "a texture's pixels do not fill its width and height");
}

Color Texture::at(float u, float v) const {
  const Taps x = taps(u, width_), y = taps(1 - v, height_);
  return lerp(lerp(pixel(x.a, y.a), pixel(x.b, y.a), x.weight),
              lerp(pixel(x.a, y.b), pixel(x.b, y.b), x.weight), y.weight);
}

Digest Texture::contentDigest() const {
  return digestOf(std::to_string(width_) + "x" + digestOf(std::as_bytes(std::span(pixels_))).hex());
}

} // namespace chamfer
