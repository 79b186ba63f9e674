// The materials of an OBJ: its libraries found, read and matched with the names that its faces use.
#pragma once

#include "preprocess/mesh.h"
#include "preprocess/read/read_warnings.h"

#include <filesystem>
#include <string>
#include <vector>

namespace chamfer {

/// What an OBJ names.
struct MaterialNames {
  std::filesystem::path mesh; ///< the OBJ: libraries are looked for beside it
  std::filesystem::path top;  ///< nothing outside of this folder is read
  std::vector<std::string>
      libraries; ///< the rest of each mtllib line: one name, with blanks or without, or several
  std::vector<std::size_t> libraryLines;
  std::vector<std::string>
      materials; ///< what usemtl lines name: what mesh.materialOfTriangle holds indices into
  std::vector<std::size_t> materialLines; ///< of the first usemtl of each
};

/// Adds the materials of the libraries to `mesh` and turns materialOfTriangle into indices into them. Where
/// no library can be read, one beside the OBJ with the OBJ's own name is taken. A library that is missing or
/// unreadable, a name that none has, and a value that is no number or out of range are warnings, never
/// errors.
void addMaterials(TriangleMesh& mesh, const MaterialNames& names, ReadWarnings& warnings);

} // namespace chamfer
