// T-junctions: vertices that lie on an edge of a triangle which does not know them. They close nothing and
// open nothing; splitting the triangle there lets its half-edges meet those of its neighbours.
#pragma once

#include "preprocess/components/half_edges.h"

namespace chamfer {

/// Splits triangles at the ends of half-edges without partner (`opposite`, kNone) that lie on their edges:
/// not further off than `tolerance` times the diagonal of the connected pieces that edge and vertex belong
/// to, and further than that from the edge's own ends. The parts stand where their triangle stood, each with
/// its `meshTriangle`. Returns how many half-edges were split. O(n log n).
std::size_t splitAtEdgeVertices(std::span<const Point3> positions, std::span<const std::uint32_t> opposite,
                                double tolerance, std::vector<Triangle>& triangles,
                                std::vector<std::uint32_t>& meshTriangle);

/// Triangles whose third corner lies on an edge of theirs, by the same measure: splitting at vertices does
/// their work. None where all triangles of a connected piece are so.
std::vector<bool> findFlatTriangles(std::span<const Point3> positions, std::span<const Triangle> triangles,
                                    double tolerance);

} // namespace chamfer
