#include "preprocess/rounding/hulled_mesh.h"

#include "preprocess/components/weld.h"

#include <algorithm>
#include <tuple>
#include <unordered_map>

namespace chamfer {
namespace {

using Corners = std::array<std::uint32_t, 3>;

/// Where the triangles of a hull take their looks from.
class Looks {
public:
  Looks(const TriangleMesh& mesh, const Component& component, const RoundedSolid& solid)
      : mesh_(mesh), c_(component), solid_(solid), around_(component.positions.size()) {
    for (std::uint32_t t = 0; t < c_.triangles.size(); ++t)
      for (const std::uint32_t v : c_.triangles[t])
        around_[v].push_back(t);
  }

  /// The component's triangle for a triangle of its hull: of those at its corners one in the hull's facet
  /// before any other, then the one with the most common corners, then the nearest.
  std::uint32_t source(const Corners& hull, std::uint32_t facet) const {
    using Rank = std::tuple<int, std::ptrdiff_t, double, std::uint32_t>; // the lowest is the best
    Rank best{2, 0, 0, kNone};
    for (const std::uint32_t v : hull)
      for (const std::uint32_t t : around_[v]) {
        const Corners& own = c_.triangles[t];
        const std::ptrdiff_t common = std::count_if(own.begin(), own.end(), [&](std::uint32_t w) {
          return std::find(hull.begin(), hull.end(), w) != hull.end();
        });
        const Rank rank{inFacet(t, facet) ? 0 : 1, -common, lengthSquared(middle(own) - middle(hull)), t};
        best = std::min(best, rank);
      }
    return std::get<3>(best);
  }

  /// Texture coordinates of the source at its own corners; elsewhere those of a triangle there, one in the
  /// facet before any other.
  Corners uvs(const Corners& hull, std::uint32_t facet, std::uint32_t source) const {
    Corners uv{};
    for (std::size_t k = 0; k < 3; ++k) {
      uv[k] = uvAt(source, hull[k]);
      for (const bool anywhere : {false, true})
        for (const std::uint32_t t : around_[hull[k]])
          if (uv[k] == kNone && (anywhere || inFacet(t, facet))) uv[k] = uvAt(t, hull[k]);
    }
    return uv;
  }

private:
  Vector3 middle(const Corners& t) const {
    return ((c_.positions[t[0]] - c_.bounds.lower) + (c_.positions[t[1]] - c_.bounds.lower) +
            (c_.positions[t[2]] - c_.bounds.lower)) /
           3;
  }
  /// Does it lie in the facet, so that it looks the hull's way?
  bool inFacet(std::uint32_t t, std::uint32_t facet) const {
    if (solid_.facetOfTriangle[t] != facet) return false;
    const Corners& v = c_.triangles[t];
    const Vector3 area =
        cross(c_.positions[v[1]] - c_.positions[v[0]], c_.positions[v[2]] - c_.positions[v[0]]);
    return dot(area, solid_.facets[facet].normal) > 0.99 * length(area);
  }
  std::uint32_t uvAt(std::uint32_t t, std::uint32_t vertex) const {
    const std::uint32_t m = c_.meshTriangle[t];
    for (std::size_t k = 0; k < 3; ++k)
      if (mesh_.positions[mesh_.triangles[m][k]] == c_.positions[vertex]) return mesh_.uvTriangles[m][k];
    return kNone;
  }

  const TriangleMesh& mesh_;
  const Component& c_;
  const RoundedSolid& solid_;
  std::vector<std::vector<std::uint32_t>> around_; ///< the component's triangles at each of its vertices
};

} // namespace

void HulledMesh::replace(const Component& component, const RoundedSolid& solid, std::uint32_t firstFacet) {
  std::unordered_multimap<std::uint64_t, std::uint32_t> vertexAt; // the mesh's, by position
  for (const std::uint32_t m : component.meshTriangle) {
    dropped_[m] = true;
    for (const std::uint32_t v : mesh_.triangles[m])
      vertexAt.emplace(hashOf(mesh_.positions[v]), v);
  }
  for (const std::uint32_t m : component.degenerate)
    dropped_[m] = true;
  for (const auto& [repeat, stays] : component.duplicates)
    dropped_[repeat] = true;
  std::vector<std::uint32_t> meshVertex(component.positions.size(), kNone);
  const auto named = [&](std::uint32_t v) {
    std::uint32_t& name = meshVertex[v];
    if (name != kNone) return name;
    const Point3& p = component.positions[v];
    for (auto [at, end] = vertexAt.equal_range(hashOf(p)); at != end; ++at)
      if (mesh_.positions[at->second] == p) name = std::min(name, at->second);
    if (name == kNone) { // welded to a vertex of another component
      name = std::uint32_t(mesh_.positions.size() + positions_.size());
      positions_.push_back(p);
    }
    return name;
  };
  const Looks looks(mesh_, component, solid);
  for (std::size_t i = 0; i < solid.hullTriangles.size(); ++i) {
    const Corners& t = solid.hullTriangles[i];
    const std::uint32_t facet = solid.hullFacets[i], source = looks.source(t, facet);
    triangles_.push_back({named(t[0]), named(t[1]), named(t[2])});
    source_.push_back(component.meshTriangle[source]);
    if (!mesh_.uvTriangles.empty()) uvTriangles_.push_back(looks.uvs(t, facet, source));
    facets_.push_back(firstFacet + facet);
  }
}

TriangleMesh HulledMesh::finish(std::vector<std::uint32_t>& facetOfTriangle) const {
  TriangleMesh out = mesh_;
  const auto keep = [&](auto& list) {
    std::size_t kept = 0;
    for (std::size_t t = 0; t < list.size(); ++t)
      if (!dropped_[t]) list[kept++] = list[t];
    list.resize(kept);
  };
  keep(out.triangles);
  keep(out.faceOfTriangle);
  keep(out.uvTriangles);
  keep(out.materialOfTriangle);
  keep(facetOfTriangle);
  out.positions.insert(out.positions.end(), positions_.begin(), positions_.end());
  out.triangles.insert(out.triangles.end(), triangles_.begin(), triangles_.end());
  out.uvTriangles.insert(out.uvTriangles.end(), uvTriangles_.begin(), uvTriangles_.end());
  facetOfTriangle.insert(facetOfTriangle.end(), facets_.begin(), facets_.end());
  for (const std::uint32_t m : source_) {
    if (!mesh_.faceOfTriangle.empty()) out.faceOfTriangle.push_back(mesh_.faceOfTriangle[m]);
    if (!mesh_.materialOfTriangle.empty()) out.materialOfTriangle.push_back(mesh_.materialOfTriangle[m]);
  }
  out.soup = false; // the hulls share vertices
  return out;
}

} // namespace chamfer
