#include "server/jobs/report/color_map.h"

#include "common/text.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>

namespace chamfer {
namespace {

/// At equal distances.
constexpr std::array<std::uint32_t, 9> kPoints = {0x000004, 0x1d1147, 0x51127c, 0x822681, 0xb63679,
                                                  0xe65164, 0xfb8861, 0xfec287, 0xfcfdbf};

float channelOf(std::uint32_t color, unsigned channel) {
  return float((color >> (16 - 8 * channel)) & 0xff) / 255;
}

} // namespace

MapColor mapColor(float position) {
  const float place = std::clamp(position, 0.f, 1.f) * float(kPoints.size() - 1);
  const std::size_t first = std::min(std::size_t(place), kPoints.size() - 2);
  const float rest = place - float(first);
  MapColor color;
  for (unsigned c = 0; c < 3; ++c)
    color[c] = (1 - rest) * channelOf(kPoints[first], c) + rest * channelOf(kPoints[first + 1], c);
  return color;
}

std::string mapGradient() {
  std::string stops;
  for (std::size_t i = 0; i < kPoints.size(); ++i) {
    char hex[16];
    std::snprintf(hex, sizeof hex, "#%06x ", unsigned(kPoints[i]));
    stops +=
        (i == 0 ? "" : ", ") + std::string(hex) + numberText(100.0 * double(i) / (kPoints.size() - 1)) + "%";
  }
  return stops;
}

} // namespace chamfer
