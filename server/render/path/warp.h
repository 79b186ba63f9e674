// Maps from the unit square to domains of integration, and local frames. All densities are stated beside the
// map.
#pragma once

#include "common/vec.h"
#include "server/render/path/elementary.h"
#include "server/render/path/sampler.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace chamfer {

inline constexpr float kPi = std::numbers::pi_v<float>;
inline constexpr float kInvPi = std::numbers::inv_pi_v<float>;

/// Uniform on the unit disk, 1/pi (Shirley and Chiu's concentric map).
inline Float2 warpToDisk(const Float2& u) {
  const float a = 2 * u.x - 1, b = 2 * u.y - 1;
  if (a == 0 && b == 0) return {};
  const bool wide = std::abs(a) > std::abs(b);
  const float radius = wide ? a : b;
  const float angle = wide ? kPi / 4 * (b / a) : kPi / 2 - kPi / 4 * (a / b);
  float sine, cosine;
  sineCosine(angle, sine, cosine);
  return {radius * cosine, radius * sine};
}

/// Hemisphere about +z, density cos(theta) / pi.
inline Vector3f warpToCosineHemisphere(const Float2& u) {
  const Float2 d = warpToDisk(u);
  return {d.x, d.y, std::sqrt(std::max(0.f, 1 - d.x * d.x - d.y * d.y))};
}

/// Cone about +z with cosines in [cosMax, 1], uniform in solid angle: 1 / (2 pi (1 - cosMax)).
/// `oneMinusCosMax` is given in that form so that narrow cones (a sun) keep their digits.
inline Vector3f warpToCone(const Float2& u, float oneMinusCosMax) {
  const float drop = u.x * oneMinusCosMax; // 1 - cos(theta)
  const float sine = std::sqrt(std::max(0.f, drop * (2 - drop)));
  float across, along; // of the angle about z
  sineCosine(2 * kPi * u.y, across, along);
  return {sine * along, sine * across, 1 - drop};
}

/// Barycentric weights (of the second and third corner) of a uniform point in a triangle, without a square
/// root (Heitz, "A Low-Distortion Map Between Triangle and Square", 2019).
inline Float2 warpToTriangle(const Float2& u) {
  if (u.y > u.x) {
    const float b = u.x / 2;
    return {b, u.y - b};
  }
  const float c = u.y / 2;
  return {u.x - c, c};
}

/// Right-handed orthonormal frame with the given z axis (Duff et al., "Building an Orthonormal Basis,
/// Revisited", JCGT 6(1), 2017).
struct Frame {
  Vector3f x, y, z;
  explicit Frame(const Vector3f& normal) : z(normal) {
    const float sign = std::copysign(1.f, normal.z);
    const float a = -1 / (sign + normal.z), b = normal.x * normal.y * a;
    x = {1 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x};
    y = {b, sign + normal.y * normal.y * a, -normal.y};
  }
  Vector3f toLocal(const Vector3f& v) const { return {dot(v, x), dot(v, y), dot(v, z)}; }
  Vector3f toWorld(const Vector3f& v) const { return x * v.x + y * v.y + z * v.z; }
};

} // namespace chamfer
