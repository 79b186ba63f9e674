// The largest ball inside a convex polytope.
#pragma once

#include "preprocess/core/polytope.h"

namespace chamfer {

struct InnerBall {
  Vector3 centre;
  double radius; ///< the inradius; not above 0 when the planes enclose nothing
};

/// The largest ball under all `planes`, whose polytope lies within `boundRadius` of the frame's origin: the
/// linear program "maximise rho with n_f . x + rho <= d_f". The radius is what the centre found really
/// clears, so it is never above the true inradius by more than rounding.
InnerBall largestBall(std::span<const Plane> planes, double boundRadius);

} // namespace chamfer
