#include "common/error.h"
#include "preprocess/rounding/round_solid.h"

namespace chamfer {
namespace {

/// Half-edges that leave each vertex of E, as one list per vertex.
Lists outgoing(const Core& core) {
  Lists lists;
  const std::size_t vertices = core.vertices.size();
  lists.start.assign(vertices + 1, 0);
  for (const std::uint32_t v : core.loops.items)
    ++lists.start[v + 1];
  for (std::size_t v = 0; v < vertices; ++v)
    lists.start[v + 1] += lists.start[v];
  lists.items.resize(core.loops.items.size());
  std::vector<std::uint32_t> fill(lists.start.begin(), lists.start.end() - 1);
  for (std::uint32_t h = 0; h < core.loops.items.size(); ++h)
    lists.items[fill[core.loops.items[h]]++] = h;
  return lists;
}

std::vector<HalfEdge> linkHalfEdges(const Core& core, const Lists& leaving) {
  const Lists& loops = core.loops;
  std::vector<HalfEdge> edges(loops.items.size());
  std::vector<std::uint32_t> endOf(edges.size());
  for (std::uint32_t f = 0; f < loops.size(); ++f)
    for (std::uint32_t h = loops.start[f]; h < loops.start[f + 1]; ++h) {
      edges[h] = {loops.items[h], kNone, f};
      endOf[h] = loops.items[h + 1 < loops.start[f + 1] ? h + 1 : loops.start[f]];
    }
  // From the end where fewer edges meet, so that the apex of a cone is not searched once for each of its
  // edges.
  for (std::uint32_t h = 0; h < edges.size(); ++h) {
    const std::uint32_t from = edges[h].sphere, to = endOf[h];
    if (leaving[to].size() > leaving[from].size()) continue;
    for (const std::uint32_t back : leaving[to])
      if (endOf[back] == from) {
        edges[h].twin = back;
        edges[back].twin = h;
      }
  }
  for (const HalfEdge& e : edges)
    if (e.twin == kNone) throw Error(ErrorKind::Internal, "an edge of a solid's core has one side only");
  return edges;
}

/// The vertex of E that lies highest along `normal`, by climbing from `from`: E is convex, so a local top is
/// the top.
std::uint32_t highest(const Core& core, const Lists& leaving, const std::vector<HalfEdge>& edges,
                      const Vector3& normal, std::uint32_t from) {
  double height = dot(normal, core.vertices[from]);
  for (bool moved = true; moved;) {
    moved = false;
    for (const std::uint32_t h : leaving[from]) {
      const std::uint32_t other = edges[edges[h].twin].sphere;
      const double there = dot(normal, core.vertices[other]);
      if (there > height) {
        height = there;
        from = other;
        moved = true;
        break;
      }
    }
  }
  return from;
}

} // namespace

void linkCore(RoundedSolid& solid) {
  const Lists& loops = solid.core.loops;
  const Lists leaving = outgoing(solid.core);
  solid.halfEdges = linkHalfEdges(solid.core, leaving);
  if (solid.halfEdges.size() >= WideHalfEdge::kLimit)
    throw Error(ErrorKind::OutOfRange, "a solid would have " + std::to_string(solid.halfEdges.size() / 2) +
                                           " rounded edges; one solid may have up to " +
                                           std::to_string(WideHalfEdge::kLimit / 2 - 1) + ": simplify it");
  solid.startOfFacet.reserve(loops.size());
  std::uint32_t top = 0;
  for (std::uint32_t f = 0; f < loops.size(); ++f) {
    if (!loops[f].empty()) {
      solid.startOfFacet.push_back(loops.start[f]);
      continue;
    }
    top = highest(solid.core, leaving, solid.halfEdges, solid.facets[f].normal, top);
    solid.startOfFacet.push_back(leaving[top].front() | FacetRecord::kVanished);
  }
}

} // namespace chamfer
