// What chamferprep does, behind its command line.
#pragma once

#include "preprocess/preprocess.h"

#include <filesystem>
#include <vector>

namespace chamfer {

struct PrepCommandOptions {
  std::vector<std::filesystem::path> meshes;
  std::filesystem::path
      output; ///< empty: MESH.chamfer beside each mesh; a folder, or a file for a single mesh
  std::filesystem::path
      explicitMesh;      ///< not empty: also write the rounded solids as an OBJ (single mesh only)
  unsigned segments = 4; ///< of the explicit mesh, across each edge
  PreprocessOptions preprocess;
  bool json = false, quiet = false, dryRun = false;
};

/// Rounds each mesh and prints its report; goes on after one that fails. Returns the exit status of the first
/// failure, or 0.
int runPrepCommand(const PrepCommandOptions& options);

} // namespace chamfer
