// Which files below the served folder are scenes, and under which names.
#pragma once

#include "common/digest.h"

#include <filesystem>
#include <string>
#include <vector>

namespace chamfer::http {

struct FoundScene {
  std::string name;           ///< path below the root without the extension, '/' between folders
  std::filesystem::path file; ///< absolute
};

struct ScanResult {
  std::vector<FoundScene> scenes;    ///< sorted by name; names are unique
  std::vector<std::string> warnings; ///< what was passed over and why; paths below the root
  Digest files;                      ///< of names, sizes and times of everything that was seen
};

/// Walks `root` (canonical): every `*.scene.json`, and every mesh (.obj .stl .ply .off, any case) with a
/// sidecar beside it. Of files with one name a scene file wins, then the first mesh in alphabetical order;
/// further meshes of that name go by their name with the extension. Hidden files and folders are passed over,
/// and so is every symbolic link that leads out of `root` or to a folder. Throws Error(NotFound) when `root`
/// cannot be read.
ScanResult scanRoot(const std::filesystem::path& root);

} // namespace chamfer::http
