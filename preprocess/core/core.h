// The core E of a solid: its polytope eroded by the rounding radius. Vertices of E are the centres of the
// rounding spheres, edges the axes of the cylinders, faces moved out by r the flats.
#pragma once

#include "preprocess/core/polytope.h"

#include <functional>
#include <optional>

namespace chamfer {

struct Core {
  std::vector<Vector3> vertices; ///< solid's frame
  /// One loop per facet of the polytope, counter-clockwise from outside; empty where the facet's face has
  /// vanished.
  Lists loops;
};

/// Distances below which vertices of E count as one: `preferred` where that leaves a proper core, else
/// `least`, the spacing of the float32 numbers that the centres are stored in.
struct MergeTolerance {
  double preferred;
  double least;
};
MergeTolerance mergeTolerance(double boundRadius, double inradius, double radius);

/// The fast path: every corner has three facets and every edge keeps its direction, so E has the polytope's
/// combinatorics and each vertex is one 3x3 solve. Nothing when that does not hold. `positions`: the
/// surface's.
std::optional<Core> offsetCore(const Polytope& polytope, std::span<const Vector3> positions, double radius,
                               double shortestEdge);

/// The general path: the hull (CGAL, exact predicates) of the dual points n_f / (d_f - r) about the frame's
/// origin, which must lie inside E. Vertices nearer than the tolerance are merged. Nothing when what is left
/// after merging is not the surface of a polytope (a core thinner than its storage can tell). `share` is told
/// how much is done, 0 to 1, and may throw.
std::optional<Core> exactCore(std::span<const Plane> planes, double radius, const MergeTolerance& tolerance,
                              const std::function<void(double)>& share);

} // namespace chamfer
