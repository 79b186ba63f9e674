// kd-trees over the detection cylinders of facets with many edges.
#pragma once

#include "common/rounding.h"
#include "preprocess/core/core.h"

namespace chamfer {

/// A facet with at most this many cylinders is its own leaf: its loop is read in one go, without a tree.
inline constexpr std::size_t kLoopIsLeaf = 8;

/// One facet's tree. The root is nodes[0]; children count from there, leaves name half-edges of the solid.
using DetectionTree = std::vector<TreeNode>;

/// Tree for points of one facet, which lie within `domain` (solid's frame). `loop`: E's vertices around the
/// facet's face; the half-edges are firstHalfEdge, firstHalfEdge + 1, ... in the loop's order. A node is
/// split along the longer side of its part of the facet, the fullest first; a leaf keeps the cylinders that
/// can be the deepest one at some point of it, so that both the zone test and the start of the walk are right
/// with the leaf alone. The size is linear in the loop: where splitting does not separate the cylinders (they
/// may all meet in one place) a leaf stays long.
DetectionTree buildDetectionTree(const Plane& facet, std::span<const Vector3> vertices,
                                 std::span<const std::uint32_t> loop, std::uint32_t firstHalfEdge,
                                 const Bounds3& domain);

} // namespace chamfer
