// The rounded solids as an explicit triangle mesh: for engines without analytic rounding, and as the baseline
// that analytic rounding is compared with.
#pragma once

#include "common/atomic_file.h"
#include "common/ray_query.h"
#include "common/rounding.h"
#include "preprocess/mesh.h"

#include <functional>

namespace chamfer {

/// Closed and manifold for each rounded solid; unwelded between solids.
struct ExplicitMesh {
  std::vector<Point3> positions; ///< mesh coordinates
  std::vector<Vector3> normals;  ///< unit, one per position: the rounded surface's own normal there
  std::vector<std::array<std::uint32_t, 3>> triangles; ///< counter-clockwise seen from outside
  /// For each triangle one of the original mesh, in the facet that it is turned to most: it takes its
  /// material and its texture coordinates from there.
  std::vector<std::uint32_t> meshTriangle;
  std::vector<Feature> features;         ///< of each triangle; Flat for those that stay sharp
  std::vector<std::array<float, 2>> uvs; ///< texture coordinates (explicit_mesh_uv.h), or empty
  std::vector<std::array<std::uint32_t, 3>> uvTriangles; ///< into uvs, kNone where there are none; or empty
};

/// Each rounded edge becomes `segments` (>= 1) strips, each sphere a grid with as many segments along its
/// sides, each flat a polygon. All vertices lie on the exact surface R. Triangles of `mesh` that stay sharp
/// are copied. `cancelled` is asked often; true: Error(Cancelled).
ExplicitMesh explicitMesh(const RoundingView& view, const TriangleMesh& mesh, unsigned segments,
                          const std::function<bool()>& cancelled = {});

/// How many triangles explicitMesh() makes, without making them.
class ExplicitMeshSize {
public:
  ExplicitMeshSize() = default;
  explicit ExplicitMeshSize(const RoundingView& view);
  std::uint64_t triangles(std::uint64_t segments) const {
    return grids_ * segments * segments + 2 * edges_ * segments + fixed_;
  }
  ExplicitMeshSize& operator+=(const ExplicitMeshSize& o);

private:
  std::uint64_t grids_ = 0; ///< of segments * segments triangles, on the spheres
  std::uint64_t edges_ = 0, fixed_ = 0;
};

/// Writes an OBJ with vertex normals, and texture coordinates where there are any, into a file that is then
/// to be committed. Throws Error(CannotWrite), Error(Internal) when a solid's surface is not closed and
/// manifold.
void writeExplicitMesh(AtomicFile& file, const ExplicitMesh& mesh);

} // namespace chamfer
