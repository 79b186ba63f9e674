#include "common/error.h"
#include "preprocess/rounding/round_solid.h"

#include <cmath>
#include <limits>

namespace chamfer {
namespace {

/// Offsets into the whole mesh's arrays have 30 bits in a tree's nodes and 31 in a solid's record.
void checkTotals(const RoundingArrays& arrays) {
  constexpr std::size_t kTree = std::size_t(1) << 30, kOther = std::size_t(1) << 31;
  if (arrays.treeNodes.size() >= kTree || arrays.packed.size() >= kOther || arrays.wide.size() >= kOther ||
      arrays.spheres.size() >= kOther || arrays.facets.size() >= kOther)
    throw Error(ErrorKind::OutOfRange,
                "the mesh is too large for one sidecar (2^31 half-edges): split it into several files");
}

} // namespace
void appendSolid(RoundingArrays& arrays, const RoundedSolid& solid,
                 std::span<const std::uint32_t> meshTriangles) {
  const std::vector<HalfEdge>& edges = solid.halfEdges;
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

  for (std::uint32_t f = 0; f < solid.facets.size(); ++f)
    arrays.facets.push_back(
        {toFloat3(solid.facets[f].normal), float(solid.facets[f].offset), solid.startOfFacet[f], index});
  for (const Vector3& c : solid.core.vertices)
    arrays.spheres.push_back(encodeSphere(c, sphereQuantum(record)));
  for (const HalfEdge& e : edges) {
    if (wide)
      arrays.wide.push_back(packWideHalfEdge(e));
    else
      arrays.packed.push_back(packHalfEdge(e));
  }
  for (const FacetTree& t : solid.trees) {
    const auto firstNode = std::uint32_t(arrays.treeNodes.size());
    arrays.facets[firstFacet + t.facet].first |= FacetRecord::kHasTree;
    arrays.treeRoots.push_back({firstFacet + t.facet, firstNode});
    for (TreeNode node : t.tree) {
      if (!node.leaf()) node.bits += firstNode << 2;
      arrays.treeNodes.push_back(node);
    }
  }
  for (std::size_t t = 0; t < meshTriangles.size(); ++t)
    arrays.facetOfTriangle[meshTriangles[t]] = firstFacet + solid.facetOfTriangle[t];
}

void finishArrays(RoundingArrays& arrays) {
  checkTotals(arrays);
  SolidRecord end{};
  end.firstFacet = std::uint32_t(arrays.facets.size());
  end.firstSphere = std::uint32_t(arrays.spheres.size());
  arrays.solids.push_back(end);
}

} // namespace chamfer
