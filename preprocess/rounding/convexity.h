// Is a closed surface that of a convex solid? Convexity is depth below the surface's own convex hull: of its
// vertices, its edges and its faces, as a share of the diagonal. Height over single face planes would mean
// nothing for slivers.
#pragma once

#include "preprocess/core/polytope.h"

#include <functional>
#include <optional>

namespace chamfer {

/// The cheap and sufficient test for well-made meshes: every vertex under every facet plane, within
/// `tolerance` (a length), no triangle turned against its facet. Raises the planes' offsets to touch the
/// farthest vertex. "No" means that the hull must judge, and is the answer also where comparing all vertices
/// with all facets would not be cheap.
bool cheapToCompare(const Surface& surface, const Polytope& polytope);
bool convexByPlanes(const Surface& surface, Polytope& polytope, double tolerance);

/// What the convex hull says of a surface.
struct HullVerdict {
  double depth = 0;           ///< greatest depth of the surface below the hull, a length
  Vector3 place;              ///< where
  std::uint32_t triangle = 0; ///< of the surface
  double coverage = 1; ///< volume that the surface encloses over the hull's: 2 when it winds around twice
};

struct HullResult {
  Surface hull;                        ///< triangulated, outward
  std::vector<std::uint32_t> vertexOf; ///< of each of the hull's vertices: the surface's, ascending
  Polytope facets;                     ///< of the hull
  HullVerdict verdict;
};

/// Convex hull by CGAL (exact predicates) and the surface's depth below it. Nothing when the points are
/// coplanar. `planarity`: the tolerance (a length) for merging the hull's triangles into facets. `share` is
/// told how much is done, 0 to 1, and may throw. O(n log n) for surfaces near their hull.
using Share = std::function<void(double)>;
std::optional<HullResult> hullOf(const Surface& surface, double planarity, const Share& share);

/// For each triangle of `surface` the facet of its hull that all three corners lie on, else the nearest one.
std::vector<std::uint32_t> facetsOnHull(const Surface& surface, const Surface& hull, const Polytope& facets);

} // namespace chamfer
