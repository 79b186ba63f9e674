// Convex hull of points as they come from files, by CGAL's exact predicates.
#pragma once

#include "tests/oracle/convex_solid.h"

namespace chamfer::oracle {

/// The hull of `points`, which must not be flat. Facets whose corners lie within `samePlane` diagonals of a
/// larger facet's plane count as part of it, so that slivers, whose own planes mean nothing, do not tilt it.
/// Vertices and faces come in an order that follows from the set of points alone.
ConvexSolid exactHull(std::string name, std::span<const Eigen::Vector3d> points, double samePlane);

} // namespace chamfer::oracle
