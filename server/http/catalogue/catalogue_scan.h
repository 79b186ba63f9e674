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
  /// Folders of which not everything could be looked at now (paths below the root): what was known in them
  /// may still be there.
  std::vector<std::string> unread;
  Digest files; ///< of names, sizes and times of everything that was seen

  /// Does `file` (path below the root) lie in one of the folders `unread`?
  bool mayHold(const std::string& file) const;
};

/// Walks `root` (canonical): every `*.scene.json`, and every mesh (.obj .stl .ply .off, any case) with a
/// sidecar beside it. Of files with one name a scene file wins, then the first mesh in alphabetical order;
/// further meshes of that name go by their name with the extension. Hidden files and folders are passed over,
/// and so is every symbolic link that leads out of `root` or to a folder. A folder that is removed meanwhile
/// is one that is not there; any other fault of the file system puts its folder among the unread ones. Throws
/// Error(NotFound) when `root` itself cannot be read.
ScanResult scanRoot(const std::filesystem::path& root);

} // namespace chamfer::http
