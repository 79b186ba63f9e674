// Is a closed surface that of a convex solid? Convexity is depth below the surface's own convex hull: of its
// vertices, its edges and its faces, as a share of the diagonal. Height over single face planes would mean
// nothing for slivers.
#pragma once

#include "preprocess/polytope.h"

#include <optional>

namespace chamfer {

/// The cheap and sufficient test for well-made meshes: every vertex under every facet plane, within
/// `tolerance` (a length), no triangle turned against its facet. Raises the planes' offsets to touch the
/// farthest vertex. Says "no" also when a surface has too many facets for it to be cheap.
bool convexByPlanes(const Surface& surface, Polytope& polytope, double tolerance);

/// What the convex hull says of a surface.
struct HullVerdict {
  double depth = 0;           ///< greatest depth of the surface below the hull, a length
  Vector3 place;              ///< where
  std::uint32_t triangle = 0; ///< of the surface
  double coverage = 1; ///< volume that the surface encloses over the hull's: 2 when it winds around twice
};

struct HullResult {
  Surface hull; ///< triangulated, outward
  HullVerdict verdict;
};

/// Convex hull by CGAL (exact predicates) and the surface's depth below it. Nothing when the points are
/// coplanar.
std::optional<HullResult> hullOf(const Surface& surface);

/// For each triangle of `surface` the facet of `polytope` (a polytope of its hull) that it lies on or nearest
/// to.
std::vector<std::uint32_t> nearestFacets(const Surface& surface, const Polytope& polytope);

} // namespace chamfer
