// The oracle's solids as the programs' meshes.
#pragma once

#include "preprocess/mesh.h"
#include "tests/oracle/convex_solid.h"

#include <span>

namespace chamfer {

/// One triangle fan a face; the solids do not share vertices.
inline TriangleMesh meshOf(std::span<const oracle::ConvexSolid> solids) {
  TriangleMesh mesh;
  for (const auto& solid : solids) {
    const auto base = std::uint32_t(mesh.positions.size());
    for (const auto& v : solid.vertices)
      mesh.positions.push_back({v.x(), v.y(), v.z()});
    for (const auto& face : solid.faces) {
      for (std::size_t i = 2; i < face.size(); ++i) {
        mesh.triangles.push_back({base + face[0], base + face[i - 1], base + face[i]});
        mesh.faceOfTriangle.push_back(std::uint32_t(mesh.lineOfFace.size()));
      }
      mesh.lineOfFace.push_back(std::uint32_t(mesh.lineOfFace.size() + 1));
    }
  }
  return mesh;
}
inline TriangleMesh meshOf(const oracle::ConvexSolid& solid) { return meshOf(std::span(&solid, 1)); }

} // namespace chamfer
