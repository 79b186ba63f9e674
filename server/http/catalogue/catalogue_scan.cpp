#include "server/http/catalogue/catalogue_scan.h"

#include "common/error.h"
#include "common/text.h"

#include <algorithm>
#include <map>
#include <optional>

namespace chamfer::http {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSceneExtension = ".scene.json";
constexpr std::string_view kMeshExtensions[] = {".obj", ".stl", ".ply", ".off"};

bool isMesh(const fs::path& file) {
  const std::string extension = lowerCase(file.extension().string());
  return std::find(std::begin(kMeshExtensions), std::end(kMeshExtensions), extension) !=
         std::end(kMeshExtensions);
}

bool below(const fs::path& file, const fs::path& root) {
  const fs::path relative = file.lexically_relative(root);
  return !relative.empty() && *relative.begin() != "..";
}

/// Is it a regular file whose content lies below `root`?
bool servable(const fs::path& file, const fs::path& root) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return false;
  const fs::path real = fs::canonical(file, error);
  return !error && below(real, root);
}

/// Names go into URLs, JSON and logs.
bool printable(const std::string& name) {
  return std::none_of(name.begin(), name.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 || byte == 0x7f;
  });
}

/// All entries below `root`, sorted, so that the outcome does not depend on the order of a folder.
std::vector<fs::path> entriesBelow(const fs::path& root) {
  std::vector<fs::path> files;
  std::error_code error;
  auto walk = fs::recursive_directory_iterator(root, fs::directory_options::skip_permission_denied, error);
  if (error) throw Error(ErrorKind::NotFound, "cannot read the folder to serve: " + error.message());
  for (const auto end = fs::recursive_directory_iterator(); walk != end; walk.increment(error)) {
    if (error) break;
    if (walk->path().filename().string().starts_with('.')) {
      walk.disable_recursion_pending();
      continue;
    }
    files.push_back(walk->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

} // namespace

ScanResult scanRoot(const fs::path& root) {
  ScanResult result;
  std::string seen;
  std::map<std::string, fs::path> scenes;
  std::vector<fs::path> meshes;

  for (const fs::path& file : entriesBelow(root)) {
    const std::string relative = file.lexically_relative(root).generic_string();
    std::error_code ignored; // of a folder, or a file that is just going: its name is enough
    seen += relative + '\n' + std::to_string(fs::last_write_time(file, ignored).time_since_epoch().count()) +
            ' ' + std::to_string(fs::file_size(file, ignored)) + '\n';
    const bool scene = relative.ends_with(kSceneExtension);
    if (!scene && !isMesh(file)) continue;
    if (!printable(relative)) {
      result.warnings.push_back("a file whose name holds control characters is passed over");
      continue;
    }
    if (!servable(file, root)) {
      result.warnings.push_back(relative + " is passed over: it is no regular file below the served folder");
      continue;
    }
    if (scene) {
      const std::string name = relative.substr(0, relative.size() - kSceneExtension.size());
      if (!name.empty() && !name.ends_with('/')) scenes[name] = file;
      continue;
    }
    const fs::path sidecar = file.string() + ".chamfer";
    std::error_code error;
    if (!fs::exists(fs::symlink_status(sidecar, error))) continue;
    if (servable(sidecar, root))
      meshes.push_back(file);
    else
      result.warnings.push_back(relative +
                                ".chamfer is passed over: it is no regular file below the served folder");
  }

  result.files = digestOf(seen);

  std::map<std::string, fs::path> named;
  for (const fs::path& mesh : meshes) {
    const fs::path relative = mesh.lexically_relative(root);
    const std::string full = relative.generic_string();
    std::string name = fs::path(relative).replace_extension().generic_string();
    if (scenes.contains(name)) {
      result.warnings.push_back(full + " is not served under its own name: " + name +
                                std::string(kSceneExtension) + " has it");
      continue;
    }
    if (named.contains(name)) {
      result.warnings.push_back(full + " is served as \"" + full + "\": another mesh has the name \"" + name +
                                "\"");
      name = full;
    }
    named.emplace(name, mesh);
  }
  named.merge(scenes);
  for (auto& [name, file] : named)
    result.scenes.push_back({name, file});
  return result;
}

} // namespace chamfer::http
