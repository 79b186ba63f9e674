// The search for the place where a line enters the rounded solid, over the Voronoi cells of its core E.
// Internal to common/; the interface for others is ray_query.h.
#pragma once

#include "common/core_view.h"
#include "common/ray_query.h"

namespace chamfer {

/// Where the line `o + t d` enters the core's offset by r, or nothing when it misses that. Solid's frame; `o`
/// should be near the solid. Any `startHalfEdge` gives the same answer, a near one gives it sooner.
std::optional<RoundedEnd> walkEntry(const CoreView& core, const Vector3& o, const Vector3& d,
                                    std::uint32_t startHalfEdge);

/// Is the point within r of the core?
bool nearCore(const CoreView& core, const Vector3& p, std::uint32_t startHalfEdge);

} // namespace chamfer
