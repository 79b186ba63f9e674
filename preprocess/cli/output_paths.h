// Where chamferprep writes, and that no two of its outputs, nor an output and an input, are one file.
#pragma once

#include "preprocess/cli/prep_command.h"

namespace chamfer {

/// The mesh's sidecar: MESH.chamfer beside it, in the folder of --output, or --output itself.
std::filesystem::path sidecarPath(const PrepCommandOptions& options, const std::filesystem::path& mesh);

/// Throws Error(Usage) when something written would replace a mesh that is read, or something else written.
void checkOutputs(const PrepCommandOptions& options);

/// A file under a temporary name, gone unless it is committed.
class StagedFile {
public:
  explicit StagedFile(std::filesystem::path target);
  ~StagedFile();
  StagedFile(const StagedFile&) = delete;
  StagedFile& operator=(const StagedFile&) = delete;
  /// In the target's folder, with its extension.
  const std::filesystem::path& temporary() const { return temporary_; }
  /// Renames it to the target. Throws Error(CannotWrite).
  void commit();

private:
  std::filesystem::path target_, temporary_;
};

} // namespace chamfer
