// One material library (MTL, Wavefront's appendix B5, with the PBR keys that exporters have added). Which
// keys are used stands at MeshMaterial; every other key is named in one warning a library, unless its value
// leaves nothing to drop. A reader of our own: tinyobjloader knows no lines, returns 0 for keys that are
// missing as for those that are 0, and takes options behind a texture's name for a part of it.
#pragma once

#include "preprocess/mesh.h"
#include "preprocess/read/read_warnings.h"

#include <filesystem>
#include <map>
#include <string>

namespace chamfer {

/// By name, into a mesh's materials; the first of a name counts.
using MaterialIndex = std::map<std::string, std::uint32_t, std::less<>>;

/// Adds the library's materials. Values that are no number or out of range are warnings. Throws what
/// readFile() throws, and Error(Malformed) for UTF-16.
void readMaterialLibrary(const std::filesystem::path& file, TriangleMesh& mesh, MaterialIndex& index,
                         ReadWarnings& warnings);

} // namespace chamfer
