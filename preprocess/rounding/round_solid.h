// One solid, from its closed surface to everything that rounding it needs; and the packing of many into one
// Rounding.
#pragma once

#include "common/sidecar.h"
#include "preprocess/core/core.h"
#include "preprocess/preprocess.h"
#include "preprocess/rounding/detection_tree.h"

#include <optional>

namespace chamfer {

struct FacetTree {
  std::uint32_t facet;
  DetectionTree tree;
};

/// A rounded solid before packing, in its own frame.
struct RoundedSolid {
  Vector3 origin; ///< mesh coordinates
  double radius = 0, inradius = 0, boundRadius = 0;
  std::vector<Plane> facets;
  Core core;
  std::vector<HalfEdge> halfEdges; ///< in the order of the core's loops
  /// First half-edge of each facet's loop, or a start for the walk with FacetRecord::kVanished set.
  std::vector<std::uint32_t> startOfFacet;
  std::vector<FacetTree> trees;               ///< ascending facet
  std::vector<std::uint32_t> facetOfTriangle; ///< of the component's triangles
  /// The hull's surface where `usedHull`: the component's vertices, counter-clockwise, and each triangle's
  /// facet.
  std::vector<std::array<std::uint32_t, 3>> hullTriangles;
  std::vector<std::uint32_t> hullFacets;
  std::size_t cornersOver3 = 0;
  double depth = 0; ///< accepted depth below the hull, relative to the diagonal
  bool usedHull = false, clamped = false;
  std::optional<Fault> fault;  ///< not a convex solid
  bool radiusTooLarge = false; ///< inradius is set
};

/// What the component is like is said in the result; throws Error(OutOfRange) only for more edges than can be
/// stored. `times`: thread time is added.
RoundedSolid roundSolid(const Component& component, const PreprocessOptions& options, StageTimes& times);

/// Fills halfEdges and startOfFacet from the core.
void linkCore(RoundedSolid& solid);

/// Adds one solid at the end of the arrays; `meshTriangles`: the mesh triangle of each of the solid's. The
/// arrays' facetOfTriangle must have the mesh's size already.
void appendSolid(RoundingArrays& arrays, const RoundedSolid& solid,
                 std::span<const std::uint32_t> meshTriangles);
/// Ends the ranges; to be called once after the last solid.
void finishArrays(RoundingArrays& arrays);

} // namespace chamfer
