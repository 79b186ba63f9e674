// The triangulation of polygons that are not flat. A file gives their corners, not their diagonals, which are
// the reader's choice: the same warped quadrilateral is convex along one diagonal and concave along the
// other.
#pragma once

#include "preprocess/mesh.h"

namespace chamfer {

/// How far a triangle's polygon is from flat.
struct Warp {
  double distance = 0;     ///< of the farthest corner from the plane through their mean, mesh units
  std::size_t corners = 3; ///< 3: a triangle, which cannot be warped
};
Warp warpOf(const TriangleMesh& mesh, std::size_t triangle);

/// Gives the warped polygons of closed solids the triangulation that bulges outwards, where the solid is then
/// locally convex, and warns of them; whichever corner the file begins a polygon with, the surface is the
/// same. Polygons whose fan is convex within the default tolerance, and those of other components, keep their
/// fan.
void chooseDiagonals(TriangleMesh& mesh);

} // namespace chamfer
