// Solids that are given twice, as exporters do that write each face once for either side, and loose faces
// that repeat a solid's.
#pragma once

#include "preprocess/components/solids.h"

namespace chamfer {

/// Drops each component all of whose triangles lie in the surface of one other, closed component, with
/// corners at that one's vertices (equal positions) and within `planarity` times its diagonal: the same solid
/// again, facing either way and triangulated in any way, or faces of it. Its triangles become duplicates of
/// the one that stays, the earlier one of two solids. Counts and warns in `components`; `mesh` is for naming
/// places.
void dropRepeats(const TriangleMesh& mesh, double planarity, Components& components);

} // namespace chamfer
