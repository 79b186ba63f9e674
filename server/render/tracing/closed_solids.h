// The closed surfaces of a sharp mesh: what a path can be inside of. Needed where light goes through, and
// only there: an opaque surface is met from either side alike.
#pragma once

#include "preprocess/mesh.h"

#include <cstdint>
#include <vector>

namespace chamfer {

struct ClosedSolids {
  static constexpr std::uint32_t kTurned = 0x80000000u; ///< the triangle is wound inside out

  /// By the mesh's triangle: its solid, with kTurned perhaps; kNone: a triangle of an open surface.
  std::vector<std::uint32_t> ofTriangle;
  struct Solid {
    Bounds3 bounds; ///< object units
    bool cavity;    ///< wound inside out, inside another: a hole in that
  };
  std::vector<Solid> solids;

  std::size_t bytes() const { return 4 * ofTriangle.size() + sizeof(Solid) * solids.size(); }
};

/// The mesh's connected components that close, of any genus, welded where the file leaves them open
/// (preprocess/components).
ClosedSolids closedSolids(const TriangleMesh& mesh);

} // namespace chamfer
