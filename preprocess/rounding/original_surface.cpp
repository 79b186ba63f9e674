#include "preprocess/rounding/original_surface.h"

#include "common/sidecar.h"

#include <algorithm>
#include <cmath>

namespace chamfer {

std::optional<std::array<std::array<float, 2>, 3>> uvCorners(const TriangleMesh& mesh,
                                                             std::uint32_t triangle) {
  if (triangle >= mesh.uvTriangles.size()) return {};
  const auto& c = mesh.uvTriangles[triangle];
  if (c[0] == kNone || c[1] == kNone || c[2] == kNone) return {};
  return std::array{mesh.uvs[c[0]], mesh.uvs[c[1]], mesh.uvs[c[2]]};
}

std::optional<std::array<float, 2>> uvAt(const TriangleMesh& mesh, const MeshPlace& place) {
  const auto corners = uvCorners(mesh, place.triangle);
  if (!corners) return {};
  const auto& [a, b, c] = *corners;
  const float u = place.u, v = place.v, w = 1 - u - v;
  return std::array{w * a[0] + u * b[0] + v * c[0], w * a[1] + u * b[1] + v * c[1]};
}

OriginalSurface::OriginalSurface(std::shared_ptr<const TriangleMesh> mesh,
                                 std::shared_ptr<const Rounding> rounding)
    : mesh_(std::move(mesh)), rounding_(std::move(rounding)) {
  const RoundingView& view = rounding_->view();
  starts_.assign(view.facets.size() + 1, 0);
  for (const std::uint32_t f : view.facetOfTriangle)
    if (f != kNone) ++starts_[f + 1];
  for (std::size_t f = 1; f < starts_.size(); ++f)
    starts_[f] += starts_[f - 1];
  triangles_.resize(starts_.back());
  std::vector<std::uint32_t> filled(starts_.begin(), starts_.end() - 1);
  for (std::uint32_t t = 0; t < view.facetOfTriangle.size(); ++t)
    if (const std::uint32_t f = view.facetOfTriangle[t]; f != kNone) triangles_[filled[f]++] = t;

  mixedFacets_.assign(view.facets.size(), false);
  mixedSolids_.assign(view.solidCount(), false);
  const std::vector<std::uint32_t>& materials = mesh_->materialOfTriangle;
  if (materials.empty()) return;
  std::vector<std::uint32_t> firstOfSolid(view.solidCount(), kNone);
  for (std::uint32_t f = 0; f < view.facets.size(); ++f)
    for (std::uint32_t i = starts_[f]; i < starts_[f + 1]; ++i) {
      const std::uint32_t solid = view.facets[f].solid;
      if (firstOfSolid[solid] == kNone) firstOfSolid[solid] = triangles_[i];
      if (materials[triangles_[i]] != materials[triangles_[starts_[f]]]) mixedFacets_[f] = true;
      if (materials[triangles_[i]] != materials[firstOfSolid[solid]]) mixedSolids_[solid] = true;
    }
}

MeshPlace OriginalSurface::placeOn(std::uint32_t triangle, const Point3& p) const {
  const auto& corners = mesh_->triangles[triangle];
  const Point3& a = mesh_->positions[corners[0]];
  const Vector3 e1 = mesh_->positions[corners[1]] - a, e2 = mesh_->positions[corners[2]] - a;
  const Vector3 n = cross(e1, e2), d = p - a;
  const double square = lengthSquared(n);
  if (!(square > 0)) return {triangle, -INFINITY, -INFINITY}; // a sliver holds no point
  return {triangle, float(dot(cross(d, e2), n) / square), float(dot(cross(e1, d), n) / square)};
}

MeshPlace OriginalSurface::placeAmong(std::span<const std::uint32_t> triangles, const Point3& p) const {
  MeshPlace best{kNone, -INFINITY, -INFINITY};
  for (std::size_t i = 0; i < triangles.size() && !(best.inside() >= 0); ++i) {
    const MeshPlace other = placeOn(triangles[i], p);
    if (best.triangle == kNone || other.inside() > best.inside()) best = other;
  }
  return std::isfinite(best.u) ? best : MeshPlace{best.triangle, 0, 0};
}

MeshPlace OriginalSurface::placeOfRounding(std::uint32_t solid, const Point3& p,
                                           const Vector3& normal) const {
  const RoundingView& view = rounding_->view();
  std::uint32_t nearest = kNone;
  double cosine = -INFINITY;
  for (std::uint32_t f = view.solids[solid].firstFacet; f < view.solids[solid + 1].firstFacet; ++f) {
    if (starts_[f] == starts_[f + 1]) continue; // a hull's facet over which the mesh has no triangle
    const double c = dot(Vector3(view.facets[f].normal), normal);
    if (c > cosine) cosine = c, nearest = f;
  }
  return placeOnFacet(nearest, p);
}

} // namespace chamfer
