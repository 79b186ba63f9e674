// A triangle as seen from a point: its solid angle, and directions uniform over it.
//   Arvo, "Stratified Sampling of Spherical Triangles", SIGGRAPH 1995.
//   Van Oosterom and Strackee, "The Solid Angle of a Plane Triangle", IEEE Trans. Biomedical Engineering
//   30(2), 1983.
#pragma once

#include "common/vec.h"
#include "server/render/path/sampler.h"

namespace chamfer {

class SphericalTriangle {
public:
  /// Corners relative to the point, none of them zero.
  SphericalTriangle(const Vector3& a, const Vector3& b, const Vector3& c);
  double solidAngle() const { return solidAngle_; } ///< 0 where the point lies in the triangle's plane
  /// Unit direction, density 1 / solidAngle(); to be asked only where that is well above 0 and below 2 pi.
  Vector3 sample(const Float2& u) const;

private:
  Vector3 a_, b_, c_; ///< unit
  double solidAngle_;
};

} // namespace chamfer
