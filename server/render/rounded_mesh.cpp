#include "server/render/rounded_mesh.h"

#include "common/error.h"
#include "preprocess/explicit_mesh.h"

#include <algorithm>

namespace chamfer {
namespace {

/// Some gigabytes: a triangle takes about 150 bytes with its share of vertices, normals and hierarchy.
constexpr std::uint64_t kMostTriangles = 16'000'000;
constexpr double kBytesPerTriangle = 150;

} // namespace

RoundedMesh::RoundedMesh(std::shared_ptr<const TriangleMesh> original,
                         std::shared_ptr<const Rounding> rounding, unsigned segments)
    : original_(std::move(original)), rounding_(std::move(rounding)) {
  const RoundingView& view = rounding_->view();
  ExplicitMesh made = explicitMesh(view, *original_, segments);
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->positions = std::move(made.positions);
  mesh->triangles = std::move(made.triangles);
  normals_.reserve(made.normals.size());
  for (const Vector3& n : made.normals)
    normals_.push_back(toFloat3(n));
  sources_ = std::move(made.meshTriangle);
  features_ = std::move(made.features);
  traced_ = makeTracedMesh(mesh);
  mesh_ = std::move(mesh);

  if (original_->uvTriangles.empty() && original_->materialOfTriangle.empty()) return;
  facetStarts_.assign(view.facets.size() + 1, 0);
  for (const std::uint32_t f : view.facetOfTriangle)
    if (f != kNone) ++facetStarts_[f + 1];
  for (std::size_t f = 1; f < facetStarts_.size(); ++f)
    facetStarts_[f] += facetStarts_[f - 1];
  facetTriangles_.resize(facetStarts_.back());
  severalMaterials_.assign(view.facets.size(), false);
  std::vector<std::uint32_t> filled(facetStarts_.begin(), facetStarts_.end() - 1);
  const std::vector<std::uint32_t>& materials = original_->materialOfTriangle;
  for (std::uint32_t t = 0; t < view.facetOfTriangle.size(); ++t) {
    const std::uint32_t f = view.facetOfTriangle[t];
    if (f == kNone) continue;
    facetTriangles_[filled[f]++] = t;
    if (!materials.empty() && materials[t] != materials[facetTriangles_[facetStarts_[f]]])
      severalMaterials_[f] = true;
  }
}

std::uint32_t RoundedMesh::facetOf(std::uint32_t triangle) const {
  return rounding_->view().facetOfTriangle[sources_[triangle]];
}

Vector3 RoundedMesh::normal(const MeshPlace& place) const {
  const auto& corners = mesh_->triangles[place.triangle];
  const double u = place.u, v = place.v;
  return normalize(Vector3(normals_[corners[0]]) * (1 - u - v) + Vector3(normals_[corners[1]]) * u +
                   Vector3(normals_[corners[2]]) * v);
}

MeshPlace RoundedMesh::placeOn(std::uint32_t originalTriangle, const Point3& p) const {
  const auto& corners = original_->triangles[originalTriangle];
  const Point3& a = original_->positions[corners[0]];
  const Vector3 e1 = original_->positions[corners[1]] - a, e2 = original_->positions[corners[2]] - a;
  const Vector3 n = cross(e1, e2), d = p - a;
  const double square = lengthSquared(n);
  if (!(square > 0)) return {originalTriangle, 0, 0};
  return {originalTriangle, float(dot(cross(d, e2), n) / square), float(dot(cross(e1, d), n) / square)};
}

MeshPlace RoundedMesh::original(const MeshPlace& place) const {
  const std::uint32_t source = sources_[place.triangle], facet = facetOf(place.triangle);
  if (facet == kNone) return {source, place.u, place.v}; // a copy of the sharp triangle
  if (facetStarts_.empty()) return {source, 0, 0};
  const auto& corners = mesh_->triangles[place.triangle];
  const Point3& a = mesh_->positions[corners[0]];
  const Point3 p = a + (mesh_->positions[corners[1]] - a) * double(place.u) +
                   (mesh_->positions[corners[2]] - a) * double(place.v);
  const auto inside = [](const MeshPlace& m) { return std::min({m.u, m.v, 1 - m.u - m.v}); };
  MeshPlace best = placeOn(source, p);
  for (std::uint32_t i = facetStarts_[facet]; i < facetStarts_[facet + 1] && inside(best) < 0; ++i) {
    const MeshPlace other = placeOn(facetTriangles_[i], p);
    if (inside(other) > inside(best)) best = other;
  }
  return best;
}

std::uint32_t RoundedMesh::originalOfAll(std::uint32_t triangle) const {
  const std::uint32_t facet = facetOf(triangle);
  if (facet != kNone && !severalMaterials_.empty() && severalMaterials_[facet]) return kNone;
  return sources_[triangle];
}

std::size_t RoundedMesh::memoryBytes() const {
  return mesh_->positions.size() * (sizeof(Point3) + sizeof(Float3)) +
         mesh_->triangles.size() * (3 * sizeof(std::uint32_t) + sizeof(std::uint32_t) + sizeof(Feature)) +
         (facetStarts_.size() + facetTriangles_.size()) * sizeof(std::uint32_t);
}

void checkSegments(const std::vector<std::shared_ptr<const Rounding>>& roundings, unsigned segments) {
  ExplicitMeshSize size;
  std::vector<const Rounding*> seen;
  for (const auto& r : roundings) {
    if (!r || std::find(seen.begin(), seen.end(), r.get()) != seen.end()) continue;
    seen.push_back(r.get());
    size += ExplicitMeshSize(r->view());
  }
  const std::uint64_t triangles = size.triangles(segments);
  if (triangles <= kMostTriangles) return;
  unsigned most = segments;
  while (most > 0 && size.triangles(most) > kMostTriangles)
    --most;
  char text[256];
  std::snprintf(
      text, sizeof text,
      "rounding \"mesh:%u\" would make %llu triangles of this scene, about %.1f GB; the limit is %llu "
      "triangles: ",
      segments, static_cast<unsigned long long>(triangles), double(triangles) * kBytesPerTriangle * 1e-9,
      static_cast<unsigned long long>(kMostTriangles));
  throw Error(ErrorKind::OutOfRange,
              text + (most > 0 ? "use mesh:" + std::to_string(most) + " or fewer segments"
                               : std::string("use rounding analytic")))
      .with("triangles", double(triangles))
      .with("largest_segments", most);
}

} // namespace chamfer
