#include "server/render/light/spherical_triangle.h"

#include <algorithm>
#include <numbers>

namespace chamfer {
namespace {

double angleBetween(const Vector3& a, const Vector3& b) { // of unit vectors, with all its digits when small
  return 2 * std::atan2(length(a - b), length(a + b));
}

/// Unit part of v that is orthogonal to unit w.
Vector3 orthogonalTo(const Vector3& w, const Vector3& v) { return normalize(v - w * dot(v, w)); }

} // namespace

SphericalTriangle::SphericalTriangle(const Vector3& a, const Vector3& b, const Vector3& c)
    : a_(normalize(a)), b_(normalize(b)), c_(normalize(c)) {
  solidAngle_ = 2 * std::abs(std::atan2(dot(a_, cross(b_, c_)), 1 + dot(a_, b_) + dot(b_, c_) + dot(c_, a_)));
}

Vector3 SphericalTriangle::sample(const Float2& u) const {
  const Vector3 ab = normalize(cross(a_, b_)), ca = normalize(cross(c_, a_));
  const double alpha = angleBetween(ab, -ca); // the dihedral angle at a
  const double cosAlpha = std::cos(alpha), sinAlpha = std::sin(alpha);
  // c' on the arc from a to c such that (a, b, c') has the share u.x of the area.
  const double area = u.x * solidAngle_;
  const double s = std::sin(area - alpha), t = std::cos(area - alpha); // Arvo's s and t
  const double p = t - cosAlpha, q = s + sinAlpha * dot(a_, b_);
  const double cosArc =
      std::clamp(((q * t - p * s) * cosAlpha - q) / ((q * s + p * t) * sinAlpha), -1.0, 1.0);
  const Vector3 c = a_ * cosArc + orthogonalTo(a_, c_) * std::sqrt(std::max(0.0, 1 - cosArc * cosArc));
  // Then along the arc from b to c', uniform in the cosine.
  const double z = 1 - u.y * (1 - dot(c, b_));
  return b_ * z + orthogonalTo(b_, c) * std::sqrt(std::max(0.0, 1 - z * z));
}

} // namespace chamfer
