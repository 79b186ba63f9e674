// What the file's indices leave open, closed by position where that is possible: welding, and pairing around
// edges that more than two triangles share.
#pragma once

#include "preprocess/components/solids.h"

#include <functional>

namespace chamfer {

/// Calls body(i) for i in 0 .. count-1, over threads or not.
using ForEach = std::function<void(std::size_t count, const std::function<void(std::size_t)>& body)>;

/// Makes components of the mesh triangles in `crowded` (sets that have no open edges by index: pairing alone
/// may part them) and `open` (those that must be welded), both ascending. Stages: pair around crowded edges;
/// weld exactly equal positions; weld positions within the tolerance; drop flat faces that are there twice;
/// split at vertices on edges. What a stage closes is done; what is left in the end has a fault. Appends to
/// `result` and counts there.
void repairComponents(const TriangleMesh& mesh, const InputTolerances& tolerances,
                      const std::vector<std::uint32_t>& crowded, const std::vector<std::uint32_t>& open,
                      const ForEach& forEach, Components& result);

} // namespace chamfer
