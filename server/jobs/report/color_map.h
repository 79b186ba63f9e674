// Colours for numbers: equal steps look equally far apart, and brighter is more (matplotlib's "magma", from
// nine of its colours).
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace chamfer {

/// sRGB-encoded, each 0..1.
using MapColor = std::array<float, 3>;

/// Of 0..1; what is beyond is taken as the nearer end.
MapColor mapColor(float position);

/// "#000004 0%, #1d1147 12.5%, ...": the same as the stops of a CSS gradient.
std::string mapGradient();

/// 0xrrggbb, sRGB-encoded, of what has no place in the map: values that are no finite numbers, and pixels
/// that a region leaves out.
inline constexpr std::uint32_t kNotFiniteColor = 0x00e6ff, kLeftOutColor = 0x808080;
MapColor colorOf(std::uint32_t rrggbb);
/// "#rrggbb".
std::string hexOf(std::uint32_t rrggbb);

} // namespace chamfer
