// Colours for numbers: equal steps look equally far apart, and brighter is more (matplotlib's "magma", from
// nine of its colours).
#pragma once

#include <array>
#include <string>

namespace chamfer {

/// sRGB-encoded, each 0..1.
using MapColor = std::array<float, 3>;

/// Of 0..1; what is beyond is taken as the nearer end.
MapColor mapColor(float position);

/// "#000004 0%, #1d1147 12.5%, ...": the same as the stops of a CSS gradient.
std::string mapGradient();

/// For what has no place in the map: values that are no finite numbers.
inline constexpr MapColor kNotFiniteColor = {0, 0.9f, 1};

} // namespace chamfer
