// rounding=mesh:K: an explicit rounded mesh in the place of the original one, traced as an ordinary sharp
// mesh and shaded with interpolated vertex normals.
#pragma once

#include "common/ray_query.h"
#include "preprocess/rounding/original_surface.h"
#include "server/render/scene/scene.h"

#include <functional>
#include <vector>

namespace chamfer {

/// Immutable once made.
class RoundedMesh {
public:
  /// `segments` >= 1 strips an edge. `cancelled` as in prepare().
  RoundedMesh(const TriangleMesh& original, const RoundingView& rounding, unsigned segments,
              const std::function<bool()>& cancelled = {});

  const TriangleMesh& mesh() const { return *mesh_; }
  const std::shared_ptr<const TracedMesh>& traced() const { return traced_; }

  Feature feature(std::uint32_t triangle) const { return features_[triangle]; }
  /// A triangle of the original mesh: of the facet that the triangle belongs to, or the triangle itself where
  /// it stays sharp.
  std::uint32_t source(std::uint32_t triangle) const { return sources_[triangle]; }
  /// Object frame, unit, outward: the vertices' normals, which are the exact rounded surface's, interpolated.
  Vector3 normal(const MeshPlace& place) const;
  std::size_t memoryBytes() const; ///< without the hierarchy

private:
  std::shared_ptr<const TriangleMesh> mesh_;
  std::shared_ptr<const TracedMesh> traced_;
  std::vector<Float3> normals_;        ///< by vertex
  std::vector<std::uint32_t> sources_; ///< by triangle
  std::vector<Feature> features_;      ///< by triangle
};

/// Triangles that a rounding of explicit meshes may have, wherever there is memory for them.
inline constexpr std::uint64_t kMostRoundedTriangles = 16'000'000;
/// What one of them takes at most: about 120 bytes with its share of vertices, normals and hierarchy, and the
/// rest while the hierarchy is built (measured on 0.2 to 10 million triangles).
inline constexpr std::uint64_t kBytesPerRoundedTriangle = 160;

/// Bytes that explicit meshes of so many segments will take, each mesh counted once. `roundings` by mesh,
/// null where it stays sharp. Throws Error(OutOfRange) when that is more than `mostBytes`, or the triangles
/// are too many, with their number, the limit and the largest number of segments within it.
std::uint64_t explicitBytes(const std::vector<std::shared_ptr<const Rounding>>& roundings, unsigned segments,
                            std::uint64_t mostBytes);

} // namespace chamfer
