#include "common/transform.h"

#include "common/error.h"

#include <numbers>

namespace chamfer {

Transform::Transform(const Rows& rows) : m_(rows) {
  const auto& m = m_;
  const Vector3 a{m[0][0], m[1][0], m[2][0]}, b{m[0][1], m[1][1], m[2][1]}, c{m[0][2], m[1][2], m[2][2]};
  const Vector3 t{m[0][3], m[1][3], m[2][3]};
  const Vector3 bc = cross(b, c), ca = cross(c, a), ab = cross(a, b);
  const double det = dot(a, bc);
  // Relative to the volume that columns of these lengths could span, so that no unit of length matters.
  const double full = length(a) * length(b) * length(c);
  if (!std::isfinite(det) || !isFinite(t) || !(std::abs(det) > 1e-12 * full))
    throw Error(ErrorKind::OutOfRange,
                "the transform cannot be inverted: its scale is zero along some direction");
  const Vector3 rowsInv[3] = {bc / det, ca / det, ab / det};
  for (int i = 0; i < 3; ++i)
    inv_[i] = {rowsInv[i].x, rowsInv[i].y, rowsInv[i].z, -dot(rowsInv[i], t)};
}

Transform Transform::translate(const Vector3& by) {
  return Transform(Rows{{{1, 0, 0, by.x}, {0, 1, 0, by.y}, {0, 0, 1, by.z}}});
}

Transform Transform::scale(const Vector3& by) {
  return Transform(Rows{{{by.x, 0, 0, 0}, {0, by.y, 0, 0}, {0, 0, by.z, 0}}});
}

Transform Transform::rotate(const Vector3& axis, double angleDegrees) {
  const Vector3 u = normalize(axis);
  if (!isFinite(u)) throw Error(ErrorKind::OutOfRange, "a rotation needs an axis that is not zero");
  const double angle = angleDegrees * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle),
               k = 1 - c;
  return Transform(Rows{{{c + u.x * u.x * k, u.x * u.y * k - u.z * s, u.x * u.z * k + u.y * s, 0},
                         {u.y * u.x * k + u.z * s, c + u.y * u.y * k, u.y * u.z * k - u.x * s, 0},
                         {u.z * u.x * k - u.y * s, u.z * u.y * k + u.x * s, c + u.z * u.z * k, 0}}});
}

Transform Transform::inverse() const {
  Transform t;
  t.m_ = inv_;
  t.inv_ = m_;
  return t;
}

Transform Transform::operator*(const Transform& b) const {
  const auto product = [](const Rows& p, const Rows& q) {
    Rows r{};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 4; ++j)
        r[i][j] = p[i][0] * q[0][j] + p[i][1] * q[1][j] + p[i][2] * q[2][j] + (j == 3 ? p[i][3] : 0);
    return r;
  };
  Transform t;
  t.m_ = product(m_, b.m_);
  t.inv_ = product(b.inv_, inv_);
  return t;
}

bool Transform::isIdentity() const { return m_ == kIdentity; }

double Transform::determinant() const {
  const auto& m = m_;
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

} // namespace chamfer
