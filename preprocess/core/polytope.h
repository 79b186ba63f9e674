// A convex solid as preprocessing sees it: its facets' planes, and where the mesh has them its corners and
// edges. All coordinates are relative to the solid's own origin.
#pragma once

#include "common/vec.h"
#include "preprocess/components/solids.h"

#include <cstdint>
#include <span>
#include <vector>

namespace chamfer {

struct Plane {
  Vector3 normal; ///< unit, outward
  double offset;  ///< normal . x = offset
};

/// Triangles with their neighbours; a view on a component or a hull. Positions are relative to the solid's
/// origin.
struct Surface {
  std::vector<Vector3> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> opposite; ///< as Component::opposite
};

/// Lists of lists in two arrays: entries of list i are items[start[i] .. start[i + 1]).
struct Lists {
  std::vector<std::uint32_t> start{0};
  std::vector<std::uint32_t> items;
  std::size_t size() const { return start.size() - 1; }
  std::span<const std::uint32_t> operator[](std::size_t i) const {
    return std::span(items).subspan(start[i], start[i + 1] - start[i]);
  }
  void close() { start.push_back(std::uint32_t(items.size())); }
};

struct Polytope {
  std::vector<Plane> facets;
  std::vector<std::uint32_t> facetOfTriangle; ///< of the surface's triangles
  /// Corner loops of the facets, counter-clockwise, indices into the surface's positions; vertices inside
  /// facets and inside edges are left out. Empty where a facet's border is not one loop: then only the planes
  /// are to be used.
  Lists loops;
  std::size_t cornersOver3 = 0; ///< vertices where more than three facets meet
  bool simple = false;          ///< loops are complete and every corner has three facets
};

/// Merges coplanar neighbours into facets: triangles whose vertices all lie within `tolerance` (a length) of
/// the plane of a larger triangle join its facet; slivers lower than that, whose own planes mean nothing,
/// join the neighbour across their longest edge. A facet's plane has the direction of its vector area and
/// touches its farthest vertex.
Polytope findFacets(const Surface& surface, double tolerance);

} // namespace chamfer
