// Affine transforms, named target-from-source: `worldFromObject` takes object coordinates to world ones.
#pragma once

#include "common/vec.h"

#include <array>

namespace chamfer {

/// 3x4 affine matrix, row-major, last row (0 0 0 1) understood, kept with its inverse.
class Transform {
public:
  Transform() = default; ///< identity
  /// `rows` is [3][4], row-major. Throws Error (ErrorKind::OutOfRange) when it is singular or not finite.
  explicit Transform(const std::array<std::array<double, 4>, 3>& rows);

  static Transform translate(const Vector3& by);
  static Transform scale(const Vector3& by); ///< no component may be 0; a negative one mirrors
  /// Rotation by `angleDegrees` about `axis` (any length but 0), right-handed.
  static Transform rotate(const Vector3& axis, double angleDegrees);

  Point3 operator()(const Point3& p) const { return apply(m_, p); }
  Vector3 operator()(const Vector3& v) const { return applyLinear(m_, v); }
  /// Covariant: multiplies by the inverse transpose. The result is not of unit length, and stays outward
  /// under mirroring.
  Normal3 operator()(const Normal3& n) const { return applyTransposed(inv_, n); }
  Ray operator()(const Ray& r) const { return {(*this)(r.origin), (*this)(r.direction)}; }

  Transform inverse() const;
  /// As inverse()(p), without making the inverse.
  Point3 applyInverse(const Point3& p) const { return apply(inv_, p); }
  Ray applyInverse(const Ray& r) const { return {apply(inv_, r.origin), applyLinear(inv_, r.direction)}; }
  /// (a * b)(p) == a(b(p))
  Transform operator*(const Transform& b) const;
  const std::array<std::array<double, 4>, 3>& rows() const { return m_; }
  bool isIdentity() const;
  double determinant() const;

private:
  using Rows = std::array<std::array<double, 4>, 3>;
  static Point3 apply(const Rows& m, const Point3& p) {
    return {m[0][0] * p.x + m[0][1] * p.y + m[0][2] * p.z + m[0][3],
            m[1][0] * p.x + m[1][1] * p.y + m[1][2] * p.z + m[1][3],
            m[2][0] * p.x + m[2][1] * p.y + m[2][2] * p.z + m[2][3]};
  }
  static Vector3 applyLinear(const Rows& m, const Vector3& v) {
    return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
            m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
  }
  static Normal3 applyTransposed(const Rows& m, const Normal3& n) {
    return {m[0][0] * n.x + m[1][0] * n.y + m[2][0] * n.z, m[0][1] * n.x + m[1][1] * n.y + m[2][1] * n.z,
            m[0][2] * n.x + m[1][2] * n.y + m[2][2] * n.z};
  }
  static constexpr Rows kIdentity{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
  Rows m_ = kIdentity;
  Rows inv_ = kIdentity;
};

} // namespace chamfer
