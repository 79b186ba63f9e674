// Half-edges of a triangle list: half-edge 3t + k runs along edge k of triangle t, from its corner k to
// corner k + 1 (mod 3). Pairing them says which triangles are neighbours, and where a surface is open or
// crowded.
#pragma once

#include "common/rounding.h"
#include "common/vec.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace chamfer {

using Triangle = std::array<std::uint32_t, 3>;

constexpr std::uint32_t nextHalfEdge(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
constexpr std::uint32_t previousHalfEdge(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

/// Triangles over one index space, and how they hang together.
struct HalfEdges {
  std::span<const Triangle> triangles;
  std::span<const std::uint32_t> opposite; ///< by half-edge; kNone where there is no partner

  std::uint32_t start(std::uint32_t h) const { return triangles[h / 3][h % 3]; }
  std::uint32_t end(std::uint32_t h) const { return start(nextHalfEdge(h)); }
};

/// What pairing found. An edge with more than two triangles is crowded: its half-edges stay without partners.
struct PairingCounts {
  std::size_t open = 0;    ///< edges with one triangle
  std::size_t crowded = 0; ///< edges with more than two
  std::size_t sameDirection =
      0; ///< pairs that run the same way: their triangles are oriented against each other
  bool closed() const { return open == 0 && crowded == 0; }
};

/// Pairs half-edges by the vertices they join, in O(n log(degree)). Keeps its memory from call to call.
class HalfEdgePairer {
public:
  /// Corners are below `vertexCount`; no triangle names a vertex twice. Fills `opposite` (3 per triangle).
  PairingCounts pair(std::span<const Triangle> triangles, std::size_t vertexCount,
                     std::vector<std::uint32_t>& opposite);
  /// The half-edges of each crowded edge of the last call, ascending, one after the other; a group ends where
  /// crowdedEnds() says.
  const std::vector<std::uint32_t>& crowdedHalfEdges() const { return crowded_; }
  const std::vector<std::uint32_t>& crowdedEnds() const { return crowdedEnds_; }

private:
  std::vector<std::uint32_t> start_;
  std::vector<std::uint64_t> entries_; ///< (larger vertex << 32) + half-edge, grouped by the smaller vertex
  std::vector<std::uint32_t> crowded_, crowdedEnds_;
};

/// Pairs the half-edges of edges that more than two triangles share, by geometry: around the edge, solid lies
/// between a triangle and the next one, in the turning sense in which the inside is. `insideOut`: the
/// triangles around it face inwards. Touching solids come apart by this, and solids that are there more than
/// once: of faces in one place, that of the half-edge named first goes with the first of the others. An edge
/// around which as many triangles do not begin as end solid, or where an angle is not defined, stays as it
/// is; so does, with `repeatsOnly`, one with faces in more than two directions.
void pairCrowdedEdge(std::span<const std::uint32_t> halfEdges, std::span<const Triangle> triangles,
                     std::span<const Point3> positions, bool insideOut, bool repeatsOnly,
                     std::vector<std::uint32_t>& opposite);

} // namespace chamfer
