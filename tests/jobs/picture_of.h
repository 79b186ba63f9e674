// A picture made of its numbers.
#pragma once

#include "server/jobs/image/picture.h"

#include <utility>

namespace chamfer::test {

/// `values`: [height][width][channels].
inline Picture pictureOf(unsigned width, unsigned height, unsigned channels, std::vector<float> values) {
  Picture p;
  p.width = width;
  p.height = height;
  p.channels = channels;
  p.values = std::move(values);
  return p;
}

} // namespace chamfer::test
