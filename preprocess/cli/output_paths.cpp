#include "preprocess/cli/output_paths.h"

#include "common/error.h"

#include <map>

namespace chamfer {
namespace fs = std::filesystem;
namespace {

/// One name for each file, whether it exists or not.
fs::path fileOf(const fs::path& path) {
  std::error_code error;
  const fs::path real = fs::weakly_canonical(path, error);
  return error ? fs::absolute(path, error).lexically_normal() : real;
}

} // namespace

fs::path sidecarPath(const PrepCommandOptions& options, const fs::path& mesh) {
  fs::path beside = mesh;
  beside += ".chamfer";
  if (options.output.empty()) return beside;
  std::error_code notThere;
  if (options.meshes.size() > 1 || fs::is_directory(options.output, notThere))
    return options.output / beside.filename();
  return options.output;
}

void checkOutputs(const PrepCommandOptions& options) {
  std::map<fs::path, fs::path> inputs, writers; // the file -> the mesh that it is, or is written for
  for (const fs::path& mesh : options.meshes)
    inputs.emplace(fileOf(mesh), mesh);
  const auto add = [&](const fs::path& output, const fs::path& writer) {
    const fs::path file = fileOf(output);
    if (inputs.contains(file))
      throw Error(ErrorKind::Usage,
                  "writing " + output.string() + " would replace the mesh that is read: choose another name");
    const auto [other, isNew] = writers.emplace(file, writer);
    if (!isNew && other->second != writer)
      throw Error(ErrorKind::Usage, output.string() + " would be written twice, for " +
                                        other->second.string() + " and for " + writer.string() +
                                        ": choose other names or folders");
  };
  for (const auto& [file, mesh] : inputs)
    add(sidecarPath(options, mesh), mesh);
  if (!options.explicitMesh.empty()) add(options.explicitMesh, "--mesh");
}

} // namespace chamfer
