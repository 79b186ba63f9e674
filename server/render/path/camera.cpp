#include "server/render/path/camera.h"

#include "common/error.h"
#include "common/text.h"
#include "server/render/path/warp.h"

namespace chamfer {
namespace {

constexpr double kMinVfov = 0.001, kMaxVfov = 179;
/// Nearest to parallel that `up` and the view may be: sine of the angle between them.
constexpr double kMinSine = 1e-6;

[[noreturn]] void fail(const std::string& what) { throw Error(ErrorKind::OutOfRange, "camera: " + what); }

} // namespace

void validateCamera(const Camera& c) {
  if (!isFinite(c.eye) || !isFinite(c.target) || !isFinite(c.up)) fail("eye, target and up must be finite");
  const Vector3 view = c.target - c.eye;
  const double distance = length(view), upLength = length(c.up);
  if (!(distance > 0) || !std::isfinite(distance)) fail("eye and target must be two different points");
  if (!(upLength > 0) || !std::isfinite(upLength)) fail("up must be a direction");
  if (!(length(cross(view / distance, c.up / upLength)) > kMinSine)) fail("up must not be along the view");
  if (!(c.vfovDegrees >= kMinVfov && c.vfovDegrees <= kMaxVfov))
    fail("vfov_degrees must be " + numberText(kMinVfov) + " to " + numberText(kMaxVfov) + ", is " +
         numberText(c.vfovDegrees));
  if (!(c.apertureDiameter >= 0) || !std::isfinite(c.apertureDiameter))
    fail("the aperture's diameter must be at least 0, is " + numberText(c.apertureDiameter));
  if (!(c.focusDistance >= 0) || !std::isfinite(c.focusDistance))
    fail("the focus distance must be above 0, is " + numberText(c.focusDistance));
}

Camera fitCamera(const Bounds3& bounds) {
  Camera c;
  const double radius = bounds.diagonal() > 0 ? bounds.diagonal() / 2 : 1;
  c.target = bounds.empty() ? Point3() : bounds.centre();
  c.up = {0, 0, 1};
  c.vfovDegrees = 30;
  // The bounding ball touches the frame's upper and lower edge, with some air around it.
  const double distance = 1.05 * radius / std::sin(c.vfovDegrees * std::numbers::pi / 360);
  c.eye = c.target + normalize(Vector3(0.62, -1, 0.55)) * distance;
  return c;
}

CameraRays::CameraRays(const Camera& c, unsigned width, unsigned height) : eye_(c.eye) {
  validateCamera(c);
  if (width == 0 || height == 0) throw Error(ErrorKind::OutOfRange, "the frame must have at least one pixel");
  const Vector3 forward = normalize(c.target - c.eye);
  const Vector3 right = normalize(cross(forward, c.up)), up = cross(right, forward);
  const double halfHeight = std::tan(c.vfovDegrees * std::numbers::pi / 360), pixel = 2 * halfHeight / height;
  right_ = right * pixel;
  down_ = up * -pixel;
  corner_ = forward - right_ * (width / 2.0) - down_ * (height / 2.0);
  focus_ = c.focusDistance > 0 ? c.focusDistance : length(c.target - c.eye);
  thinLens_ = c.apertureDiameter > 0;
  lensX_ = right * (c.apertureDiameter / 2);
  lensY_ = up * (c.apertureDiameter / 2);
}

Ray CameraRays::ray(double x, double y, const Float2& lens) const {
  const Vector3 view = corner_ + right_ * x + down_ * y;
  if (!thinLens_) return {eye_, normalize(view)};
  const Float2 d = warpToDisk(lens);
  const Vector3 offset = lensX_ * double(d.x) + lensY_ * double(d.y);
  return {eye_ + offset, normalize(view * focus_ - offset)};
}

} // namespace chamfer
