// Intersection of half-spaces by the plainest method there is: every facet's polygon is a large square in its
// plane, cut by every other plane. O(n^2), in long double, no clever data structure. The tests' truth and the
// tests' solids are made with it; nothing of the code under test is.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace chamfer::oracle {

using Real = long double;
using Vec3 = Eigen::Matrix<Real, 3, 1>;

/// The half-space normal.x <= offset; `normal` is unit and points outward.
struct Plane {
  Vec3 normal;
  Real offset;
};

struct PolytopeEdge {
  std::uint32_t a, b;        ///< vertices; `left`'s loop runs from a to b, `right`'s from b to a
  std::uint32_t left, right; ///< planes
};

/// Closed convex polyhedron.
struct Polytope {
  std::vector<Vec3> vertices;
  /// One loop a plane, counter-clockwise seen from outside; empty where the plane bounds no area.
  std::vector<std::vector<std::uint32_t>> faces;
  std::vector<PolytopeEdge> edges; ///< each once
  /// Every edge has the two faces that it names, and Euler's formula holds. Where planes are almost the same,
  /// rounding noise can leave a surface open: its vertices, edges and faces are all there, some edges twice.
  bool closed = false;
};

/// The bounded polyhedron common to all `planes`, which must be distinct. `reach` is about its largest
/// distance from the origin (up to 1e4 times as much is tried); vertices nearer to each other than `weld *
/// reach` become one (up to 1e-8, if that closes the surface). Throws std::runtime_error when the
/// intersection is empty or unbounded.
Polytope intersectHalfSpaces(std::span<const Plane> planes, Real reach, Real weld);

/// Newell's area-weighted normal of a loop, not of unit length.
Vec3 loopNormal(std::span<const Vec3> loop);

} // namespace chamfer::oracle
