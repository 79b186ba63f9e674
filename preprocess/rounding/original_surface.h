// Where on the original mesh a rounded surface takes its material and texture coordinates from. On a flat
// that is the point itself. A point of a rounding belongs to the facet that it is turned to most, and to that
// facet's point straight above it: the same for every ray that meets it, exact or explicit, and without a gap
// where two roundings meet.
#pragma once

#include "common/rounding.h"
#include "preprocess/mesh.h"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace chamfer {

class Rounding;

/// A place on a mesh: a triangle and the barycentric weights of its second and third corner.
struct MeshPlace {
  std::uint32_t triangle = kNone;
  float u = 0, v = 0;
  /// The least of the three weights: below 0 outside of the triangle.
  float inside() const { return std::min({u, v, 1 - u - v}); }
};

/// Texture coordinates of a triangle's corners; nothing where the mesh has none there.
std::optional<std::array<std::array<float, 2>, 3>> uvCorners(const TriangleMesh& mesh,
                                                             std::uint32_t triangle);

/// Texture coordinates at a place; nothing where the mesh has none there.
std::optional<std::array<float, 2>> uvAt(const TriangleMesh& mesh, const MeshPlace& place);

/// Immutable. Points and normals in the mesh's frame.
class OriginalSurface {
public:
  /// Does anything depend on the place: texture coordinates, or materials of triangles?
  static bool matters(const TriangleMesh& mesh) {
    return !mesh.uvTriangles.empty() || !mesh.materialOfTriangle.empty();
  }
  OriginalSurface(std::shared_ptr<const TriangleMesh> mesh, std::shared_ptr<const Rounding> rounding);

  /// The place for a point of `solid`'s rounded surface with outward `normal`; on flats as well.
  MeshPlace placeOfRounding(std::uint32_t solid, const Point3& p, const Vector3& normal) const;
  /// The place for a point of facet `facet`, or above which the facet is: its triangle that holds the point,
  /// or the nearest one, with weights below 0.
  MeshPlace placeOnFacet(std::uint32_t facet, const Point3& p) const {
    return placeAmong(trianglesOf(facet), p);
  }
  /// The same among some triangles of one facet.
  MeshPlace placeAmong(std::span<const std::uint32_t> triangles, const Point3& p) const;
  std::span<const std::uint32_t> trianglesOf(std::uint32_t facet) const {
    return std::span(triangles_).subspan(starts_[facet], starts_[facet + 1] - starts_[facet]);
  }
  bool severalMaterialsOnFacet(std::uint32_t facet) const { return mixedFacets_[facet]; }
  bool severalMaterialsOnSolid(std::uint32_t solid) const { return mixedSolids_[solid]; }
  std::size_t memoryBytes() const { return (starts_.size() + triangles_.size()) * sizeof(std::uint32_t); }

private:
  MeshPlace placeOn(std::uint32_t triangle, const Point3& p) const;

  std::shared_ptr<const TriangleMesh> mesh_;
  std::shared_ptr<const Rounding> rounding_;
  std::vector<std::uint32_t> starts_, triangles_; ///< facet f has triangles_[starts_[f] .. starts_[f + 1])
  std::vector<bool> mixedFacets_, mixedSolids_;
};

} // namespace chamfer
