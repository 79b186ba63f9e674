// A convex solid as tests make it: vertices and outward polygons, with affine maps and OBJ text.
#pragma once

#include "tests/oracle/polytope.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace chamfer::oracle {

struct ConvexSolid {
  std::string name;
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::vector<std::uint32_t>> faces; ///< counter-clockwise seen from outside, one a facet

  Eigen::Vector3d centroid() const; ///< mean of the vertices: a point inside
  double diagonal() const;          ///< of the axis-aligned bounding box
  /// Facet planes relative to `origin`, from the vertices as they are, in long double.
  std::vector<Plane> planes(const Eigen::Vector3d& origin) const;
};

/// The polyhedron that `planes` bound around the origin. Facets keep the planes' order; planes that bound
/// nothing are left out. `reach` bounds its distance from the origin.
ConvexSolid solidFromPlanes(std::string name, std::span<const Plane> planes, Real reach);
/// The convex hull of `points`, which must not be flat. Coplanar points share a facet. Points are kept bit
/// for bit; those inside are left out.
ConvexSolid solidFromPoints(std::string name, std::span<const Eigen::Vector3d> points);

/// x -> linear * x + offset.
struct Affine {
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
};
Affine randomRotation(std::uint64_t seed);
Affine scaling(double x, double y, double z);
/// Mirroring maps turn the loops, so that faces stay outward.
ConvexSolid transformed(const ConvexSolid& solid, const Affine& map);
/// Turned at random, scaled by `scale`, then moved `offsetDiagonals` of its own diagonals along a random
/// direction.
ConvexSolid placed(const ConvexSolid& solid, double scale, double offsetDiagonals, std::uint64_t seed);

enum class ObjFaces : std::uint8_t { Polygons, Triangles };
/// One OBJ with every solid in it, 17 significant digits, an `o` line each.
std::string toObj(std::span<const ConvexSolid> solids, ObjFaces faces);
inline std::string toObj(const ConvexSolid& solid, ObjFaces faces) {
  return toObj(std::span(&solid, 1), faces);
}

} // namespace chamfer::oracle
