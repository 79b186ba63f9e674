// Flat faces that are there twice, whichever way they face and however they are triangulated.
#pragma once

#include "preprocess/components/half_edges.h"

namespace chamfer {

/// Patches are sets of triangles that edges with two triangles hold together. Of the flat ones at crowded
/// edges
/// (`crowded`: their half-edges) that have the same border and lie in one plane the first stays; so it does
/// of single triangles with the same corners. Flat: within `planarity` times the diagonal of all that hangs
/// together in vertices. Answers for each triangle which triangle stays for it, or kNone where it stays
/// itself. `opposite`: kNone at crowded and open edges.
std::vector<std::uint32_t> findDoubledPatches(std::span<const Triangle> triangles,
                                              std::span<const Point3> positions,
                                              std::span<const std::uint32_t> opposite,
                                              std::span<const std::uint32_t> crowded, double planarity,
                                              bool sameWay);

} // namespace chamfer
