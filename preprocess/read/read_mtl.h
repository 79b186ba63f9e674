// Material libraries (MTL), read by tinyobjloader: base colour, and the PBR keys where a library has them.
#pragma once

#include "preprocess/mesh.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace chamfer {

struct MaterialTable {
  std::vector<MeshMaterial> materials;
  std::map<std::string, std::uint32_t, std::less<>>
      index; ///< by name, into materials; the first of a name counts
  std::vector<std::string> warnings;
  std::vector<std::filesystem::path> files; ///< that were looked for, there or not
};

/// Adds the materials of the libraries that one mtllib line names: one file whose name may hold blanks, or
/// several names between blanks. Files are looked for in `folder` and below it, nowhere else, whatever the
/// line says, and not through symbolic links either. A library that is missing, unreadable or holds values
/// out of range is a warning, never an error.
void readMaterialLibraries(const std::string& line, const std::filesystem::path& folder,
                           MaterialTable& table);

} // namespace chamfer
