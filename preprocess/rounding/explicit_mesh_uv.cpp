#include "preprocess/rounding/explicit_mesh_uv.h"

#include "preprocess/components/disjoint_sets.h"
#include "preprocess/rounding/original_surface.h"

#include <tuple>
#include <unordered_map>

namespace chamfer {
namespace {

/// A side of a triangle in its facet, the same from both sides.
struct Side {
  using End = std::tuple<double, double, double, float, float>;
  std::uint32_t facet, triangle;
  End a, b;
  auto key() const { return std::tie(facet, a, b); }
};

/// The pieces of a facet over which the mesh's texture coordinates go on without a cut.
class Charts {
public:
  Charts(const TriangleMesh& mesh, const RoundingView& view) : ofTriangle_(mesh.triangles.size(), kNone) {
    DisjointSets joined(mesh.triangles.size());
    const std::vector<Side> sides = sortedSides(mesh, view);
    for (std::size_t i = 1; i < sides.size(); ++i)
      if (sides[i].key() == sides[i - 1].key()) joined.join(sides[i].triangle, sides[i - 1].triangle);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
      if (view.facetOfTriangle[t] != kNone && uvCorners(mesh, t)) {
        ofTriangle_[t] = joined.find(t);
        triangles_[ofTriangle_[t]].push_back(t);
      }
  }

  /// A name of the triangle's chart; kNone: it has no coordinates.
  std::uint32_t of(std::uint32_t triangle) const { return ofTriangle_[triangle]; }
  const std::vector<std::uint32_t>& triangles(std::uint32_t chart) const { return triangles_.at(chart); }

private:
  static std::vector<Side> sortedSides(const TriangleMesh& mesh, const RoundingView& view) {
    std::vector<Side> sides;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto uv = uvCorners(mesh, t);
      if (!uv || view.facetOfTriangle[t] == kNone) continue;
      Side::End end[3];
      for (std::size_t k = 0; k < 3; ++k) {
        const Point3& p = mesh.positions[mesh.triangles[t][k]];
        end[k] = {p.x, p.y, p.z, (*uv)[k][0], (*uv)[k][1]};
      }
      for (std::size_t k = 0; k < 3; ++k)
        sides.push_back({view.facetOfTriangle[t], t, std::min(end[k], end[(k + 1) % 3]),
                         std::max(end[k], end[(k + 1) % 3])});
    }
    std::sort(sides.begin(), sides.end(), [](const Side& x, const Side& y) {
      return std::tie(x.facet, x.a, x.b, x.triangle) < std::tie(y.facet, y.a, y.b, y.triangle);
    });
    return sides;
  }

  std::vector<std::uint32_t> ofTriangle_;
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> triangles_; ///< of each chart
};

constexpr float kBeyond = 1e-4f; ///< weights of a point within its piece may be this far below 0

class TextureMapper {
public:
  TextureMapper(ExplicitMesh& out, std::shared_ptr<const TriangleMesh> mesh,
                std::shared_ptr<const Rounding> rounding)
      : out_(out), mesh_(*mesh), view_(rounding->view()), surface_(mesh, rounding), charts_(mesh_, view_) {}

  CutTextures run() {
    for (std::size_t t = 0; t < out_.triangles.size(); ++t) {
      const std::uint32_t original = out_.meshTriangle[t];
      const std::uint32_t facet = view_.facetOfTriangle[original];
      out_.uvTriangles.push_back(facet == kNone ? copied(original) : mapped(t, facet));
    }
    return cuts_;
  }

private:
  using Corners = std::array<std::uint32_t, 3>;

  std::uint32_t add(const std::array<float, 2>& uv) {
    out_.uvs.push_back(uv);
    return std::uint32_t(out_.uvs.size() - 1);
  }

  /// A triangle that stays sharp has its original's corners.
  Corners copied(std::uint32_t original) {
    const auto uv = uvCorners(mesh_, original);
    if (!uv) return {kNone, kNone, kNone};
    return {add((*uv)[0]), add((*uv)[1]), add((*uv)[2])};
  }

  Corners mapped(std::size_t t, std::uint32_t facet) {
    const Corners& vertices = out_.triangles[t];
    const std::uint32_t chart = chartUnder(vertices, facet);
    if (chart == kNone) return {kNone, kNone, kNone};
    Corners uv;
    bool cut = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const Corner& corner = cornerOf(vertices[k], facet, chart);
      uv[k] = corner.uv;
      cut |= corner.beyond;
    }
    if (cut && cuts_.triangles++ == 0) cuts_.first = chart;
    return uv;
  }

  /// The chart below the triangle's middle.
  std::uint32_t chartUnder(const Corners& vertices, std::uint32_t facet) const {
    const auto all = surface_.trianglesOf(facet);
    const std::uint32_t first = charts_.of(all[0]);
    if (first == kNone ? std::all_of(all.begin(), all.end(), [&](auto t) { return charts_.of(t) == kNone; })
                       : charts_.triangles(first).size() == all.size())
      return first;
    const Point3 &a = out_.positions[vertices[0]], &b = out_.positions[vertices[1]],
                 &c = out_.positions[vertices[2]];
    return charts_.of(surface_.placeOnFacet(facet, a + ((b - a) + (c - a)) / 3).triangle);
  }

  struct Corner {
    std::uint32_t uv;
    bool beyond; ///< outside of the chart, and the facet has others
  };
  const Corner& cornerOf(std::uint32_t vertex, std::uint32_t facet, std::uint32_t chart) {
    const auto [at, isNew] = corners_.try_emplace((std::uint64_t(vertex) << 32) | chart);
    if (isNew) {
      const auto& triangles = charts_.triangles(chart);
      const MeshPlace place = surface_.placeAmong(triangles, out_.positions[vertex]);
      at->second = {add(*uvAt(mesh_, place)),
                    place.inside() < -kBeyond && triangles.size() < surface_.trianglesOf(facet).size()};
    }
    return at->second;
  }

  ExplicitMesh& out_;
  const TriangleMesh& mesh_;
  const RoundingView& view_;
  OriginalSurface surface_;
  Charts charts_;
  std::unordered_map<std::uint64_t, Corner> corners_; ///< by vertex and chart
  CutTextures cuts_;
};

} // namespace

CutTextures addTextureCoordinates(ExplicitMesh& out, std::shared_ptr<const TriangleMesh> mesh,
                                  std::shared_ptr<const Rounding> rounding) {
  if (mesh->uvTriangles.empty()) return {};
  out.uvTriangles.reserve(out.triangles.size());
  return TextureMapper(out, std::move(mesh), std::move(rounding)).run();
}

} // namespace chamfer
