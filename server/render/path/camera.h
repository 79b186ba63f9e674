// From pixels to rays.
#pragma once

#include "server/render/path/sampler.h"
#include "server/render/scene/scene.h"

namespace chamfer {

/// Throws Error(OutOfRange) unless every value is finite and within its limits (vfov 0.001 to 179 degrees),
/// `eye` and `target` differ and `up` is not along the view.
void validateCamera(const Camera& camera);

/// A camera that sees all of `bounds` from a little above, with `up` = z.
Camera fitCamera(const Bounds3& bounds);

/// The rays of one frame. Directions are unit.
class CameraRays {
public:
  /// Throws as validateCamera(), and Error(OutOfRange) for an empty frame.
  CameraRays(const Camera& camera, unsigned width, unsigned height);
  bool usesLens() const { return thinLens_; } ///< false: rays do not depend on `lens`
  /// Through (x, y) of the frame, pixels from its upper left corner; `lens` uniform on the unit square.
  Ray ray(double x, double y, const Float2& lens) const;

private:
  Point3 eye_;
  Vector3 corner_, right_, down_; ///< to the frame's upper left corner at distance 1; one pixel right, down
  Vector3 lensX_, lensY_;         ///< radii of the aperture; zero for a pinhole
  double focus_;                  ///< distance of the focal plane along the view
  bool thinLens_;
};

} // namespace chamfer
