#include "server/jobs/report/color_map.h"

#include "common/text.h"

#include <algorithm>
#include <cstdio>

namespace chamfer {
namespace {

/// At equal distances.
constexpr std::array<std::uint32_t, 9> kPoints = {0x000004, 0x1d1147, 0x51127c, 0x822681, 0xb63679,
                                                  0xe65164, 0xfb8861, 0xfec287, 0xfcfdbf};

} // namespace

MapColor colorOf(std::uint32_t rrggbb) {
  return {float(rrggbb >> 16 & 0xff) / 255, float(rrggbb >> 8 & 0xff) / 255, float(rrggbb & 0xff) / 255};
}

std::string hexOf(std::uint32_t rrggbb) {
  char text[16];
  std::snprintf(text, sizeof text, "#%06x", unsigned(rrggbb));
  return text;
}

MapColor mapColor(float position) {
  const float place = std::clamp(position, 0.f, 1.f) * float(kPoints.size() - 1);
  const std::size_t first = std::min(std::size_t(place), kPoints.size() - 2);
  const float rest = place - float(first);
  MapColor color = colorOf(kPoints[first]);
  const MapColor next = colorOf(kPoints[first + 1]);
  for (unsigned c = 0; c < 3; ++c)
    color[c] = (1 - rest) * color[c] + rest * next[c];
  return color;
}

std::string mapGradient() {
  std::string stops;
  for (std::size_t i = 0; i < kPoints.size(); ++i)
    stops += (i == 0 ? "" : ", ") + hexOf(kPoints[i]) + ' ' +
             numberText(100.0 * double(i) / double(kPoints.size() - 1)) + '%';
  return stops;
}

} // namespace chamfer
