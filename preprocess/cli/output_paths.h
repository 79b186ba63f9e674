// Where chamferprep writes, and that no two of its outputs, nor an output and an input, are one file.
#pragma once

#include "preprocess/cli/prep_command.h"

namespace chamfer {

/// The mesh's sidecar: MESH.chamfer beside it, in the folder of --output, or --output itself.
std::filesystem::path sidecarPath(const PrepCommandOptions& options, const std::filesystem::path& mesh);

/// Throws Error(Usage) when something written would replace a mesh that is read, or something else written.
void checkOutputs(const PrepCommandOptions& options);

} // namespace chamfer
