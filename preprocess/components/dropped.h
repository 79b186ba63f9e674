// Triangles that a repair drops: they are no part of any surface, but a ray may still meet them.
#pragma once

#include "preprocess/components/solids.h"

#include <span>

namespace chamfer {

struct Dropped {
  std::vector<std::uint32_t> degenerate;                ///< mesh triangles without height
  std::vector<std::array<std::uint32_t, 2>> duplicates; ///< {mesh triangle, what stays for it}
};

/// Gives them to the components, from `firstComponent` on, in whose surface they lie, and counts them.
/// `standsFor`: by mesh vertex, as welded. Duplicates of which a part stays are none.
void assignDropped(const TriangleMesh& mesh, std::span<const std::uint32_t> standsFor,
                   std::size_t firstComponent, Dropped dropped, Components& components);

} // namespace chamfer
