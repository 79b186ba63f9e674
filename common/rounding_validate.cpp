// Every invariant that the ray queries rely on for staying in bounds and for ending their loops. A file that
// passes may still be a wrong rounding (that is what its checksums are for), but never makes a query crash or
// hang.
#include "common/error.h"
#include "common/sidecar.h"

#include <cmath>
#include <string>
#include <vector>

namespace chamfer {
namespace {

void require(bool good, const char* what, std::size_t index) {
  if (!good)
    throw Error(ErrorKind::DamagedSidecar, std::string("the sidecar is damaged: ") + what + " " +
                                               std::to_string(index) +
                                               " is not valid; run chamferprep on the mesh again");
}

bool finite(const Float3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

template <class Edge>
void checkHalfEdges(const RoundingView& view, std::size_t s, std::span<const Edge> edges) {
  const SolidRecord &solid = view.solids[s], &end = view.solids[s + 1];
  const std::uint32_t n = solid.halfEdgeCount;
  const std::uint32_t facetCount = end.firstFacet - solid.firstFacet;
  const std::uint32_t sphereCount = end.firstSphere - solid.firstSphere;
  const auto facets = view.facets.subspan(solid.firstFacet, facetCount);
  for (std::uint32_t h = 0; h < n; ++h) {
    const HalfEdge e = edges[h].unpack();
    require(e.sphere < sphereCount && e.facet < facetCount && e.twin < n, "a half-edge of solid", s);
    const HalfEdge twin = edges[e.twin].unpack();
    require(twin.twin == h && e.twin != h && twin.facet != e.facet && twin.sphere != e.sphere,
            "a twin in solid", s);
    const FacetRecord& facet = facets[e.facet];
    const bool begins = h == 0 || edges[h - 1].unpack().facet != e.facet;
    require(!facet.vanished() && (!begins || facet.firstHalfEdge() == h), "a face of solid", s);
    const std::uint32_t next =
        h + 1 < n && edges[h + 1].unpack().facet == e.facet ? h + 1 : facet.firstHalfEdge();
    require(next < n && edges[next].unpack().sphere == twin.sphere, "a loop of solid", s);
  }
  for (std::uint32_t f = 0; f < facetCount; ++f) {
    require(facets[f].firstHalfEdge() < n, "a facet's start in solid", s);
    require(facets[f].vanished() || edges[facets[f].firstHalfEdge()].unpack().facet == f,
            "a facet's loop in solid", s);
  }
}

void checkTrees(const RoundingView& view) {
  std::size_t visited = 0;
  std::vector<std::uint32_t> stack;
  std::size_t flagged = 0;
  for (const FacetRecord& f : view.facets)
    flagged += f.hasTree();
  require(flagged == view.treeRoots.size(), "the number of trees,", flagged);
  for (std::size_t i = 0; i < view.treeRoots.size(); ++i) {
    const TreeRoot& root = view.treeRoots[i];
    require(root.facet < view.facets.size() && (i == 0 || view.treeRoots[i - 1].facet < root.facet) &&
                view.facets[root.facet].hasTree() && !view.facets[root.facet].vanished() &&
                root.node < view.treeNodes.size(),
            "tree", i);
    const SolidRecord& solid = view.solids[view.facets[root.facet].solid];
    const std::uint32_t local = root.facet - solid.firstFacet;
    stack.assign(1, root.node);
    while (!stack.empty()) {
      const std::uint32_t at = stack.back();
      stack.pop_back();
      // Nodes are not shared between trees, so a walk over all of them ends.
      require(++visited <= view.treeNodes.size(), "tree", i);
      const TreeNode& node = view.treeNodes[at];
      const std::size_t first = node.first();
      if (!node.leaf()) {
        require(std::isfinite(node.split) && first > at && first + 1 < view.treeNodes.size(), "tree", i);
        stack.push_back(std::uint32_t(first));
        stack.push_back(std::uint32_t(first + 1));
        continue;
      }
      require(first < solid.halfEdgeCount && node.count <= solid.halfEdgeCount, "tree", i);
      const HalfEdge start = solid.wide() ? view.wide[solid.halfEdgeStart() + first].unpack()
                                          : view.packed[solid.halfEdgeStart() + first].unpack();
      require(start.facet == local, "tree", i);
    }
  }
}

} // namespace

void validate(const RoundingView& view) {
  require(!view.solids.empty(), "the list of solids, of length", 0);
  const SolidRecord& last = view.solids.back();
  require(last.firstFacet == view.facets.size() && last.firstSphere == view.spheres.size(),
          "the end of solid", view.solidCount());
  for (std::size_t i = 0; i < view.spheres.size(); ++i)
    require(finite(view.spheres[i].near) && view.spheres[i].unused == 0, "sphere", i);
  std::size_t packed = 0, wide = 0;
  for (std::size_t s = 0; s < view.solidCount(); ++s) {
    const SolidRecord &solid = view.solids[s], &end = view.solids[s + 1];
    require(std::isfinite(solid.origin[0]) && std::isfinite(solid.origin[1]) &&
                std::isfinite(solid.origin[2]) && std::isfinite(solid.radius) && solid.radius > 0 &&
                std::isfinite(solid.boundRadius) && solid.boundRadius > 0,
            "solid", s);
    require(s != 0 || (solid.firstFacet == 0 && solid.firstSphere == 0), "solid", s);
    require(solid.firstFacet <= end.firstFacet && end.firstFacet <= view.facets.size() &&
                solid.firstSphere <= end.firstSphere && end.firstSphere <= view.spheres.size(),
            "the range of solid", s);
    std::size_t& used = solid.wide() ? wide : packed;
    const std::size_t available = solid.wide() ? view.wide.size() : view.packed.size();
    require(solid.halfEdgeStart() == used && solid.halfEdgeCount <= available - used &&
                solid.halfEdgeCount >= 12,
            "the half-edges of solid", s);
    used += solid.halfEdgeCount;
    for (std::uint32_t f = solid.firstFacet; f < end.firstFacet; ++f) {
      const FacetRecord& facet = view.facets[f];
      const double square = lengthSquared(Vector3(facet.normal));
      require(finite(facet.normal) && std::abs(square - 1) < 1e-5 && std::isfinite(facet.offset) &&
                  facet.solid == s,
              "facet", f);
    }
    if (solid.wide())
      checkHalfEdges(view, s, view.wide.subspan(solid.halfEdgeStart(), solid.halfEdgeCount));
    else
      checkHalfEdges(view, s, view.packed.subspan(solid.halfEdgeStart(), solid.halfEdgeCount));
  }
  require(packed == view.packed.size() && wide == view.wide.size(), "the number of half-edges,",
          packed + wide);
  for (std::size_t t = 0; t < view.facetOfTriangle.size(); ++t)
    require(view.facetOfTriangle[t] == kNone || view.facetOfTriangle[t] < view.facets.size(), "triangle", t);
  checkTrees(view);
}

} // namespace chamfer
