#include "server/render/surface/rounded_mesh.h"

#include "common/error.h"
#include "preprocess/rounding/explicit_mesh.h"

#include <algorithm>

namespace chamfer {
RoundedMesh::RoundedMesh(const TriangleMesh& original, const RoundingView& rounding, unsigned segments,
                         const std::function<bool()>& cancelled) {
  ExplicitMesh made = explicitMesh(rounding, original, segments, cancelled);
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->positions = std::move(made.positions);
  mesh->triangles = std::move(made.triangles);
  normals_.reserve(made.normals.size());
  for (const Vector3& n : made.normals)
    normals_.push_back(toFloat3(n));
  sources_ = std::move(made.meshTriangle);
  features_ = std::move(made.features);
  traced_ = makeTracedMesh(mesh, cancelled);
  mesh_ = std::move(mesh);
}

Vector3 RoundedMesh::normal(const MeshPlace& place) const {
  const auto& corners = mesh_->triangles[place.triangle];
  const double u = place.u, v = place.v;
  return normalize(Vector3(normals_[corners[0]]) * (1 - u - v) + Vector3(normals_[corners[1]]) * u +
                   Vector3(normals_[corners[2]]) * v);
}

std::size_t RoundedMesh::memoryBytes() const {
  return mesh_->positions.size() * (sizeof(Point3) + sizeof(Float3)) +
         mesh_->triangles.size() * (4 * sizeof(std::uint32_t) + sizeof(Feature));
}

std::uint64_t explicitBytes(const std::vector<std::shared_ptr<const Rounding>>& roundings, unsigned segments,
                            std::uint64_t mostBytes) {
  ExplicitMeshSize size;
  std::vector<const Rounding*> seen;
  for (const auto& r : roundings) {
    if (!r || std::find(seen.begin(), seen.end(), r.get()) != seen.end()) continue;
    seen.push_back(r.get());
    size += ExplicitMeshSize(r->view());
  }
  const std::uint64_t triangles = size.triangles(segments);
  const std::uint64_t limit = std::min(kMostRoundedTriangles, mostBytes / kBytesPerRoundedTriangle);
  if (triangles <= limit) return triangles * kBytesPerRoundedTriangle;
  unsigned most = segments;
  while (most > 0 && size.triangles(most) > limit)
    --most;
  char text[256];
  std::snprintf(
      text, sizeof text,
      "rounding \"mesh:%u\" would make %llu triangles of this scene, about %.1f GB; the limit is %llu "
      "triangles: ",
      segments, static_cast<unsigned long long>(triangles),
      double(triangles * kBytesPerRoundedTriangle) * 1e-9, static_cast<unsigned long long>(limit));
  throw Error(ErrorKind::OutOfRange,
              text + (most > 0 ? "use mesh:" + std::to_string(most) + " or fewer segments"
                               : std::string("use rounding analytic")))
      .with("triangles", double(triangles))
      .with("largest_segments", most);
}

} // namespace chamfer
