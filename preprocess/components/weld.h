// Welding: which vertices are one because they lie at one place. Works on a map from each vertex to the
// vertex that stands for it (itself at first).
#pragma once

#include "preprocess/components/half_edges.h"

namespace chamfer {

/// Equal for equal positions; 0 and -0 are equal.
std::uint64_t hashOf(const Point3& position);

/// Makes vertices at exactly the same position one (0 and -0 are the same). Looks only at the corners of
/// `triangles`.
void weldExact(std::span<const Triangle> triangles, std::span<const Point3> positions,
               std::vector<std::uint32_t>& standsFor);

/// Makes vertices one that are not further apart than `tolerance` times the diagonal of what they belong to:
/// the connected pieces that contain them, taken together. So pieces as small as one triangle grow together
/// into a solid, nearest vertices first, and the tolerance is in the end relative to that solid. `triangles`
/// name vertices that stand for themselves; only `candidates` (ends of open edges, ascending) are joined.
void weldNear(std::span<const Triangle> triangles, std::span<const Point3> positions,
              std::span<const std::uint32_t> candidates, double tolerance,
              std::vector<std::uint32_t>& standsFor);

} // namespace chamfer
