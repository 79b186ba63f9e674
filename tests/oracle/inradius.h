// Largest ball inside a polyhedron: the linear programme max r, n.x + r <= d, by the simplex method over its
// four unknowns, with a certificate.
#pragma once

#include "tests/oracle/polytope.h"

namespace chamfer::oracle {

struct Inball {
  Vec3 centre;
  Real radius;
  /// Duality: no ball inside is larger than `radius + gap`, and this one fits but for `gap`. Rounding noise
  /// in size.
  Real gap;
};

/// `inside` is any point strictly inside all `planes`, whose intersection is bounded. Throws
/// std::runtime_error when no optimum is found.
Inball largestBall(std::span<const Plane> planes, const Vec3& inside);

} // namespace chamfer::oracle
