// rounding=mesh:K: an explicit rounded mesh in the place of the original one, traced as an ordinary sharp
// mesh and shaded with interpolated vertex normals.
#pragma once

#include "common/ray_query.h"
#include "server/render/scene.h"

#include <vector>

namespace chamfer {

/// A place on a mesh: a triangle and the barycentric weights of its second and third corner.
struct MeshPlace {
  std::uint32_t triangle = kNone;
  float u = 0, v = 0;
};

/// Immutable once made.
class RoundedMesh {
public:
  /// `segments` >= 1 strips an edge. The original mesh and its rounding are kept alive.
  RoundedMesh(std::shared_ptr<const TriangleMesh> original, std::shared_ptr<const Rounding> rounding,
              unsigned segments);

  const TriangleMesh& mesh() const { return *mesh_; }
  const std::shared_ptr<const TracedMesh>& traced() const { return traced_; }

  Feature feature(std::uint32_t triangle) const { return features_[triangle]; }
  /// Object frame, unit, outward: the vertices' normals, which are the exact rounded surface's, interpolated.
  Vector3 normal(const MeshPlace& place) const;
  /// The place on the original mesh straight above: on the facet that the triangle belongs to, beside its
  /// triangles nowhere but where the rounded surface is beside the facet. Weights may then be below 0.
  MeshPlace original(const MeshPlace& place) const;
  /// A triangle of the original mesh for all of `triangle`; kNone where the facet above has triangles of
  /// several materials.
  std::uint32_t originalOfAll(std::uint32_t triangle) const;
  std::size_t memoryBytes() const; ///< without the hierarchy

private:
  MeshPlace placeOn(std::uint32_t originalTriangle, const Point3& p) const;
  std::uint32_t facetOf(std::uint32_t triangle) const;

  std::shared_ptr<const TriangleMesh> original_, mesh_;
  std::shared_ptr<const Rounding> rounding_;
  std::shared_ptr<const TracedMesh> traced_;
  std::vector<Float3> normals_;        ///< by vertex
  std::vector<std::uint32_t> sources_; ///< by triangle, one of the original ones
  std::vector<Feature> features_;      ///< by triangle
  /// The original triangles of facet f are facetTriangles_[facetStarts_[f] .. facetStarts_[f + 1]); empty
  /// where neither textures nor materials depend on the place.
  std::vector<std::uint32_t> facetStarts_, facetTriangles_;
  std::vector<bool> severalMaterials_; ///< by facet
};

/// Refuses a choice of segments that would make too many triangles of the scene's meshes, each counted once.
/// `roundings` by mesh, null where it stays sharp. Throws Error(OutOfRange) with the number of triangles, the
/// limit and the largest number of segments within it.
void checkSegments(const std::vector<std::shared_ptr<const Rounding>>& roundings, unsigned segments);

} // namespace chamfer
