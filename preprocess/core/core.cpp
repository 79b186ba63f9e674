#include "preprocess/core/core.h"

#include <algorithm>

namespace chamfer {

MergeTolerance mergeTolerance(double boundRadius, double inradius, double radius) {
  // Eight steps of the numbers that centres are stored in (rounding.h): a shorter edge has no direction
  // there.
  const double least = 8 * 0x1p-39 * boundRadius;
  // A core that is itself thin must keep its shape: its thickness is about twice what the inradius leaves.
  return {std::max(least, std::min(2e-9 * boundRadius, 0.02 * (inradius - radius))), least};
}

std::optional<Core> offsetCore(const Polytope& polytope, std::span<const Vector3> positions, double radius,
                               double shortestEdge) {
  if (!polytope.simple) return std::nullopt;
  struct Corner {
    std::uint32_t facets[3];
    std::uint32_t count = 0, vertex = 0xffffffffu;
  };
  // Scratch that keeps its capacity from solid to solid of a thread.
  thread_local std::vector<Corner> corners;
  corners.assign(positions.size(), {});
  const Lists& loops = polytope.loops;
  for (std::uint32_t f = 0; f < loops.size(); ++f)
    for (const std::uint32_t v : loops[f]) {
      if (corners[v].count == 3) return std::nullopt;
      corners[v].facets[corners[v].count++] = f;
    }
  Core core;
  core.loops.start.reserve(loops.start.size());
  core.loops.items.reserve(loops.items.size());
  for (std::size_t v = 0; v < corners.size(); ++v) {
    Corner& c = corners[v];
    if (c.count == 0) continue;
    if (c.count != 3) return std::nullopt;
    const Plane &p = polytope.facets[c.facets[0]], &q = polytope.facets[c.facets[1]],
                &s = polytope.facets[c.facets[2]];
    const Vector3 qs = cross(q.normal, s.normal), sp = cross(s.normal, p.normal),
                  pq = cross(p.normal, q.normal);
    const double det = dot(p.normal, qs);
    if (!(std::abs(det) > 1e-6)) return std::nullopt; // too flat for a plain solve
    c.vertex = std::uint32_t(core.vertices.size());
    core.vertices.push_back((qs * (p.offset - radius) + sp * (q.offset - radius) + pq * (s.offset - radius)) /
                            det);
  }
  const double shortest = shortestEdge * shortestEdge;
  for (std::uint32_t f = 0; f < loops.size(); ++f) {
    const auto loop = loops[f];
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const std::uint32_t from = loop[i], to = loop[i + 1 == loop.size() ? 0 : i + 1];
      const Vector3 edge = core.vertices[corners[to].vertex] - core.vertices[corners[from].vertex];
      if (!(dot(edge, positions[to] - positions[from]) > 0) || lengthSquared(edge) < shortest)
        return std::nullopt;
      core.loops.items.push_back(corners[from].vertex);
    }
    core.loops.close();
  }
  return core;
}

} // namespace chamfer
