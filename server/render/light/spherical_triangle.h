// A triangle as seen from a point: its solid angle, and directions uniform over it.
//   Arvo, "Stratified Sampling of Spherical Triangles", SIGGRAPH 1995.
//   Van Oosterom and Strackee, "The Solid Angle of a Plane Triangle", IEEE Trans. Biomedical Engineering
//   30(2), 1983.
#pragma once

#include "common/vec.h"
#include "server/render/path/elementary.h"
#include "server/render/path/sampler.h"

namespace chamfer {

/// T: double, float or lanes of floats; `select`, `sqrt`, `abs`, `min` are found for it.
template <class T>
class SphericalTriangleT {
public:
  using Vector = Vector3T<T>;
  /// Corners relative to the point, none of them zero. `volume`: their triple product, any sign.
  SphericalTriangleT(const Vector& a, const Vector& b, const Vector& c, const T& volume) {
    using std::abs, std::sqrt;
    const T toA = T(1) / sqrt(dot(a, a)), toB = T(1) / sqrt(dot(b, b)), toC = T(1) / sqrt(dot(c, c));
    a_ = a * toA;
    b_ = b * toB;
    c_ = c * toC;
    volume_ = abs(volume) * toA * toB * toC;
    ab_ = T(1) + dot(a_, b_);
    const T sum = ab_ + dot(b_, c_) + dot(c_, a_);
    solidAngle_ = T(2) * angleOf(volume_, sum);
  }
  SphericalTriangleT(const Vector& a, const Vector& b, const Vector& c)
      : SphericalTriangleT(a, b, c, dot(a, cross(b, c))) {}

  T solidAngle() const { return solidAngle_; } ///< 0 where the point lies in the triangle's plane
  /// Unit direction, density 1 / solidAngle(); to be asked only where that is well above 0 and below 2 pi.
  /// `ux`, `uy`: uniform in [0, 1).
  Vector sample(const Float2& u) const { return sample(T(u.x), T(u.y)); }
  Vector sample(const T& ux, const T& uy) const {
    using std::max, std::min, std::sqrt;
    // c' on the arc from a to c such that (a, b, c') has the share ux of the area E. With A the angle at a:
    //   tan(E/2) = tan(ab/2) tan(ac'/2) sin A / (1 + tan(ab/2) tan(ac'/2) cos A),
    // which is solved for tan(ac'/2) without any difference of nearly equal numbers.
    T s, c;
    sineCosine(ux * solidAngle_ * T(0.5f), s, c);
    const Vector normalAb = cross(a_, b_), normalAc = cross(a_, c_);
    const T sine = sqrt(dot(normalAc, normalAc)); // of the arc ac
    const T most(1e6f);                           // at half a turn
    const T tangent = max(T(0), min(s * sine * ab_ / (volume_ * c - dot(normalAb, normalAc) * s), most));
    const T scale = T(1) / (T(1) + tangent * tangent);
    const Vector towardsC = c_ - a_ * dot(a_, c_); // of length `sine`
    const Vector on = a_ * ((T(1) - tangent * tangent) * scale) + towardsC * (T(2) * tangent * scale / sine);
    // Then along the arc from b to c', uniform in the cosine.
    const Vector chord = on - b_;
    const T whole = dot(chord, chord) * T(0.5f), drop = uy * whole; // 1 - cos
    const Vector across = on - b_ * (T(1) - whole);
    const T length2 = dot(across, across);
    const T slope = sqrt(max(T(0), drop * (T(2) - drop)) / max(length2, T(1e-30f)));
    return b_ * (T(1) - drop) + across * slope;
  }

private:
  Vector a_, b_, c_; ///< unit
  T volume_;         ///< of those, not below 0
  T ab_;             ///< 1 + a.b
  T solidAngle_;
};

using SphericalTriangle = SphericalTriangleT<double>;

} // namespace chamfer
