// The mesh of a rounding where components are rounded as their convex hulls: a ray finds a rounding by the
// triangle that it meets, so that each hull needs triangles all over, which a component that is not convex
// lacks.
#pragma once

#include "preprocess/rounding/round_solid.h"

namespace chamfer {

/// Replaces components of a mesh by their hulls. The result is a function of the mesh and the hulls alone.
class HulledMesh {
public:
  /// The mesh must outlive this.
  explicit HulledMesh(const TriangleMesh& mesh) : mesh_(mesh), dropped_(mesh.triangles.size()) {}

  /// Drops all triangles of the component and appends those of its hull. Each takes face, material and
  /// texture coordinates from the component: from a triangle in the same facet where there is one, else from
  /// the one that is nearest among those at its corners. `firstFacet`: number of the solid's facet 0.
  void replace(const Component& component, const RoundedSolid& solid, std::uint32_t firstFacet);

  bool changed() const { return !triangles_.empty(); }
  /// The file's triangles that stay, in order, then those of the hulls. `facetOfTriangle` is the mesh's and
  /// becomes the result's.
  TriangleMesh finish(std::vector<std::uint32_t>& facetOfTriangle) const;

private:
  const TriangleMesh& mesh_;
  std::vector<bool> dropped_;
  std::vector<Point3> positions_; ///< beyond the mesh's own
  std::vector<std::array<std::uint32_t, 3>> triangles_, uvTriangles_;
  std::vector<std::uint32_t> source_; ///< of each: the mesh's triangle that it takes its looks from
  std::vector<std::uint32_t> facets_;
};

} // namespace chamfer
