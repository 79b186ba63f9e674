// A mesh as read from a file: plain validated arrays. Nothing is welded, dropped or reordered here.
#pragma once

#include "common/digest.h"
#include "common/vec.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace chamfer {

/// Material as an OBJ's MTL library gives it; PBR keys where present.
struct MeshMaterial {
  std::string name;
  std::array<double, 3> baseColor{0.8, 0.8, 0.8};                ///< Kd, linear
  double roughness = 0.5;                                        ///< Pr, else from Ns
  double metallic = 0;                                           ///< Pm
  double transmission = 0;                                       ///< 1 - d (or Tr)
  double ior = 1.5;                                              ///< Ni
  std::array<double, 3> emission{0, 0, 0};                       ///< Ke
  std::string baseColorTexture, roughnessTexture, normalTexture; ///< paths as written; empty: none
};

struct TriangleMesh {
  std::vector<Point3> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles; ///< polygons are fans, or convex where they are warped
  std::vector<std::uint32_t> faceOfTriangle; ///< the file's face (0-based) of each triangle, for messages
  std::vector<std::uint32_t> lineOfFace;     ///< line in the file of each face; empty for binary formats
  std::vector<std::array<float, 2>> uvs;     ///< texture coordinates; empty: none
  std::vector<std::array<std::uint32_t, 3>>
      uvTriangles;                               ///< into uvs, kNone where a corner has none; empty: none
  std::vector<std::uint32_t> materialOfTriangle; ///< into materials, kNone: none; empty: none
  std::vector<MeshMaterial> materials;
  std::vector<std::filesystem::path> materialFiles; ///< libraries that were looked for, there or not
  std::vector<std::string> warnings;                ///< what was read past, for the report
  bool soup = false; ///< the format has no shared vertices (STL): connectivity must come from positions
};

/// Reads .obj, .stl, .ply or .off (by extension, any case) strictly: every number finite, every index in
/// range, polygons with at least three corners. Error(Malformed) names line (or byte / element) and value;
/// Error(NotFound).
TriangleMesh readMesh(const std::filesystem::path& path);

/// For messages: "face 7 (line 30)" that a triangle belongs to, as the file counts from 1.
std::string placeOfTriangle(const TriangleMesh& mesh, std::size_t triangle);

/// Digest of positions and triangles: what a sidecar belongs to.
Digest geometryDigest(const TriangleMesh& mesh);

} // namespace chamfer
