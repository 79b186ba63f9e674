// Texture coordinates for an explicit mesh, by the rule of original_surface.h: a triangle takes those of the
// facet that it is turned to most, at the points straight above its corners.
#pragma once

#include "common/sidecar.h"
#include "preprocess/rounding/explicit_mesh.h"

#include <memory>

namespace chamfer {

/// What could not be carried over exactly.
struct CutTextures {
  std::size_t triangles = 0; ///< of the explicit mesh, across a cut of the texture within a facet
  std::uint32_t first = 0;   ///< one of the original mesh's triangles beside such a cut
};

/// Fills `out.uvs` and `out.uvTriangles` where `mesh` has texture coordinates; `out` is explicitMesh() of the
/// same rounding and mesh. Within a facet coordinates go on from triangle to triangle where the mesh's do;
/// where its layout is cut, a triangle of `out` belongs to the piece under its middle, whose coordinates are
/// carried on past the cut.
CutTextures addTextureCoordinates(ExplicitMesh& out, std::shared_ptr<const TriangleMesh> mesh,
                                  std::shared_ptr<const Rounding> rounding);

} // namespace chamfer
