#include "common/error.h"
#include "preprocess/round_solid.h"

#include <algorithm>
#include <cmath>
#include <limits>

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

std::vector<HalfEdge> halfEdges(const Core& core, const Lists& leaving) {
  const Lists& loops = core.loops;
  std::vector<HalfEdge> edges(loops.items.size());
  std::vector<std::uint32_t> endOf(edges.size());
  for (std::uint32_t f = 0; f < loops.size(); ++f)
    for (std::uint32_t h = loops.start[f]; h < loops.start[f + 1]; ++h) {
      edges[h] = {loops.items[h], kNone, f};
      endOf[h] = loops.items[h + 1 < loops.start[f + 1] ? h + 1 : loops.start[f]];
    }
  for (std::uint32_t h = 0; h < edges.size(); ++h) {
    for (const std::uint32_t back : leaving[endOf[h]])
      if (endOf[back] == edges[h].sphere) edges[h].twin = back;
    if (edges[h].twin == kNone)
      throw Error(ErrorKind::Internal, "an edge of a solid's core has one side only");
  }
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

void appendSolid(RoundingArrays& arrays, const RoundedSolid& solid,
                 std::span<const std::uint32_t> meshTriangles) {
  const Lists& loops = solid.core.loops;
  const Lists leaving = outgoing(solid.core);
  const std::vector<HalfEdge> edges = halfEdges(solid.core, leaving);
  const bool wide =
      edges.size() >= 65536 || solid.core.vertices.size() >= 65536 || solid.facets.size() >= 65536;
  const auto index = std::uint32_t(arrays.solids.size());
  const auto firstFacet = std::uint32_t(arrays.facets.size());

  SolidRecord record{};
  for (std::size_t k = 0; k < 3; ++k)
    record.origin[k] = solid.origin[k];
  record.radius = float(solid.radius);
  record.boundRadius =
      std::nextafter(float(solid.boundRadius * (1 + 1e-6)), std::numeric_limits<float>::max());
  record.firstFacet = firstFacet;
  record.firstSphere = std::uint32_t(arrays.spheres.size());
  record.firstHalfEdge =
      wide ? std::uint32_t(arrays.wide.size()) | SolidRecord::kWide : std::uint32_t(arrays.packed.size());
  record.halfEdgeCount = std::uint32_t(edges.size());
  arrays.solids.push_back(record);

  std::uint32_t top = 0;
  for (std::uint32_t f = 0; f < solid.facets.size(); ++f) {
    FacetRecord facet{toFloat3(solid.facets[f].normal), float(solid.facets[f].offset), loops.start[f], index};
    if (loops[f].empty()) {
      top = highest(solid.core, leaving, edges, solid.facets[f].normal, top);
      facet.first = leaving[top].front() | FacetRecord::kVanished;
    }
    arrays.facets.push_back(facet);
  }
  for (const Vector3& c : solid.core.vertices)
    arrays.spheres.push_back(encodeSphere(c, sphereQuantum(record)));
  for (const HalfEdge& e : edges) {
    if (wide)
      arrays.wide.push_back(e);
    else
      arrays.packed.push_back({std::uint16_t(e.sphere), std::uint16_t(e.twin), std::uint16_t(e.facet)});
  }
  for (const FacetTree& t : solid.trees) {
    const auto firstNode = std::uint32_t(arrays.treeNodes.size()),
               firstLeaf = std::uint32_t(arrays.treeLeaves.size());
    arrays.facets[firstFacet + t.facet].first |= FacetRecord::kHasTree;
    arrays.treeRoots.push_back({firstFacet + t.facet, firstNode});
    for (TreeNode node : t.tree.nodes) {
      node.bits += (node.leaf() ? firstLeaf : firstNode) << 2;
      arrays.treeNodes.push_back(node);
    }
    arrays.treeLeaves.insert(arrays.treeLeaves.end(), t.tree.leaves.begin(), t.tree.leaves.end());
  }
  for (std::size_t t = 0; t < meshTriangles.size(); ++t)
    arrays.facetOfTriangle[meshTriangles[t]] = firstFacet + solid.facetOfTriangle[t];
}

void finishArrays(RoundingArrays& arrays) {
  SolidRecord end{};
  end.firstFacet = std::uint32_t(arrays.facets.size());
  end.firstSphere = std::uint32_t(arrays.spheres.size());
  arrays.solids.push_back(end);
}

} // namespace chamfer
