// A line against one ball or one cylinder. The textbook quadratic cancels; here the line's closest approach
// comes first, and the half chord from (r - distance)(r + distance).
#pragma once

#include "tests/oracle/polytope.h"

#include <cmath>
#include <optional>

namespace chamfer::oracle {

/// Unit direction; the origin is near what the line is tested against.
struct Line {
  Vec3 origin, direction;
  Vec3 at(Real t) const { return origin + t * direction; }
};

struct Chord {
  Real in, out;
};

inline std::optional<Chord> chordOfBall(const Line& line, const Vec3& centre, Real radius) {
  const Vec3 away = centre - line.origin;
  const Real middle = away.dot(line.direction);
  const Real distance = (away - middle * line.direction).norm();
  if (distance > radius) return {};
  const Real half = std::sqrt((radius - distance) * (radius + distance));
  return Chord{middle - half, middle + half};
}

/// Infinite cylinder about the unit `axis` through `point`; nothing when the line runs along it.
inline std::optional<Chord> chordOfCylinder(const Line& line, const Vec3& point, const Vec3& axis,
                                            Real radius) {
  const Vec3 across = line.direction - line.direction.dot(axis) * axis;
  const Real sine2 = across.squaredNorm();
  if (sine2 < 1e-34L) return {};
  const Vec3 from = line.origin - point;
  const Vec3 radial = from - from.dot(axis) * axis;
  const Real middle = -radial.dot(across) / sine2;
  const Real distance = (radial + middle * across).norm();
  if (distance > radius) return {};
  const Real half = std::sqrt((radius - distance) * (radius + distance) / sine2);
  return Chord{middle - half, middle + half};
}

/// Distance between the whole line and the segment from `a` along the unit `axis`.
inline Real distanceToSegment(const Line& line, const Vec3& a, const Vec3& axis, Real length) {
  const auto flatten = [&](const Vec3& v) -> Vec3 { return v - v.dot(line.direction) * line.direction; };
  const Vec3 from = flatten(a - line.origin), along = flatten(axis);
  const Real sine2 = along.squaredNorm();
  const Real s = sine2 > 0 ? std::clamp<Real>(-from.dot(along) / sine2, 0, length) : 0;
  return (from + s * along).norm();
}

} // namespace chamfer::oracle
