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
template <class F>
void warpToDisk(const F& ux, const F& uy, F& x, F& y) {
  using std::abs;
  const F a = F(2) * ux - F(1), b = F(2) * uy - F(1);
  const auto wide = abs(a) > abs(b);
  const F radius = select(wide, a, b);
  const F share = select(wide, b, a) / select(radius == F(0), F(1), radius);
  const F angle = select(wide, F(kPi / 4) * share, F(kPi / 2) - F(kPi / 4) * share);
  F sine, cosine;
  sineCosine(angle, sine, cosine);
  x = radius * cosine;
  y = radius * sine;
}
inline Float2 warpToDisk(const Float2& u) {
  Float2 d;
  warpToDisk(u.x, u.y, d.x, d.y);
  return d;
}

/// Hemisphere about +z, density cos(theta) / pi.
template <class F>
Vector3T<F> warpToCosineHemisphere(const F& ux, const F& uy) {
  using std::max, std::sqrt;
  F x, y;
  warpToDisk(ux, uy, x, y);
  return {x, y, sqrt(max(F(0), F(1) - x * x - y * y))};
}
inline Vector3f warpToCosineHemisphere(const Float2& u) { return warpToCosineHemisphere(u.x, u.y); }

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
template <class F>
void warpToTriangle(const F& ux, const F& uy, F& second, F& third) {
  const auto upper = uy > ux;
  const F half = select(upper, ux, uy) * F(0.5f);
  second = select(upper, half, ux - half);
  third = select(upper, uy - half, half);
}
inline Float2 warpToTriangle(const Float2& u) {
  Float2 b;
  warpToTriangle(u.x, u.y, b.x, b.y);
  return b;
}

/// Right-handed orthonormal frame with the given z axis (Duff et al., "Building an Orthonormal Basis,
/// Revisited", JCGT 6(1), 2017).
template <class F>
struct FrameT {
  Vector3T<F> x, y, z;
  explicit FrameT(const Vector3T<F>& normal) : z(normal) {
    using std::copysign;
    const F sign = copysign(F(1), normal.z);
    const F a = F(-1) / (sign + normal.z), b = normal.x * normal.y * a;
    x = {F(1) + sign * normal.x * normal.x * a, sign * b, -sign * normal.x};
    y = {b, sign + normal.y * normal.y * a, -normal.y};
  }
  Vector3T<F> toLocal(const Vector3T<F>& v) const { return {dot(v, x), dot(v, y), dot(v, z)}; }
  Vector3T<F> toWorld(const Vector3T<F>& v) const { return x * v.x + y * v.y + z * v.z; }
};
using Frame = FrameT<float>;

} // namespace chamfer
