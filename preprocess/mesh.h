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

/// An image that a material library names.
struct MeshTexture {
  std::string file;             ///< as written; empty: none
  std::filesystem::path folder; ///< of the library: where relative names begin
  std::string place;            ///< library and line, for messages: "wood.mtl:12"
  std::array<double, 2> scale{1, 1},
      offset{0, 0};    ///< -s, -o: looked up at texture coordinate * scale + offset
  bool clamp = false;  ///< -clamp: outside of 0..1 its border, else it repeats
  double strength = 1; ///< -bm: what turns the normal is taken times this

  bool operator==(const MeshTexture&) const = default;
};

/// Material as an OBJ's MTL library gives it; PBR keys where present. Keys in any letter case.
struct MeshMaterial {
  std::string name;                               ///< newmtl
  std::array<double, 3> baseColor{0.8, 0.8, 0.8}; ///< Kd, linear; 1 where there is only a map_Kd
  double roughness = 0.5;                         ///< Pr, else from Ns
  double metallic = 0;                            ///< Pm
  double transmission = 0;                        ///< 1 - d, else Tr
  double ior = 1.5;                               ///< Ni
  std::array<double, 3> emission{0, 0, 0};        ///< Ke
  MeshTexture baseColorTexture, roughnessTexture,
      normalTexture; ///< map_Kd, map_Pr, norm or else map_Bump or bump
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
  std::vector<std::string>
      warnings;      ///< what was dropped or guessed, by kind with its first line; a bounded number
  bool soup = false; ///< the format has no shared vertices (STL): connectivity must come from positions
};

/// Reads .obj, .stl, .ply or .off (by extension, any case) strictly: every coordinate finite, every index in
/// range, polygons with at least three corners. Error(Malformed) names line (or byte / element) and value;
/// Error(NotFound). What a file holds beside its shape never refuses it: what of that is dropped or guessed
/// is a warning. Material libraries are read only below `top`; empty: the mesh's own folder.
TriangleMesh readMesh(const std::filesystem::path& path, const std::filesystem::path& top = {});

/// For messages: "face 7 (line 30)" that a triangle belongs to, as the file counts from 1.
std::string placeOfTriangle(const TriangleMesh& mesh, std::size_t triangle);

/// Digest of positions and triangles: what a sidecar belongs to.
Digest geometryDigest(const TriangleMesh& mesh);

} // namespace chamfer
