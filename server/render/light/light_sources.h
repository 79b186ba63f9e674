// Lights that are no object: they are sampled, and suns wider than a point are found by rays that leave the
// scene.
#pragma once

#include "common/vec.h"
#include "server/render/image/color.h"

namespace chamfer {

/// A sun: light from a cone of directions, or from exactly one.
struct DistantLight {
  Vector3 direction;                 ///< towards the light, unit
  Color irradiance;                  ///< on a surface that faces it
  double angularDiameterDegrees = 0; ///< 0: a single direction
};

struct PointLight {
  Point3 position;
  Color intensity; ///< radiant intensity, power per solid angle
};

} // namespace chamfer
