// What sampling of any light gives to next-event estimation.
#pragma once

#include "common/rounding.h"
#include "common/vec.h"
#include "server/render/image/color.h"

#include <cstdint>

namespace chamfer {

struct LightSample {
  Vector3 toLight;    ///< from the receiving point: to a point on the light, or unit towards infinity
  Vector3f direction; ///< along toLight, unit
  double tfar = 0;    ///< shadow rays along toLight end here (below 1: the light's own surface is left out)
  Color radiance;     ///< arriving if nothing is in the way; over `pdf` for a delta
  float pdf = 0;      ///< per solid angle at the receiving point; 0: no light from here
  bool delta = false; ///< cannot be met by chance: `radiance` is already divided by the density
  /// A rounded emitter, which shines only if it is the first thing that the ray meets; kNone: another light.
  std::uint32_t instance = kNone, solid = kNone;
};

} // namespace chamfer
