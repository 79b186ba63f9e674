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

enum class Servable { Yes, No, Unknown };

/// The file is not there, or is a link that leads nowhere; every other error says nothing of what is there.
bool saysAbsent(const std::error_code& error) {
  return error == std::errc::no_such_file_or_directory || error == std::errc::not_a_directory ||
         error == std::errc::too_many_symbolic_link_levels;
}

/// Is it a regular file whose content lies below `root`?
Servable servable(const fs::path& file, const fs::path& root) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (status.type() == fs::file_type::none) return Servable::Unknown;
  if (status.type() != fs::file_type::regular) return Servable::No;
  const fs::path real = fs::canonical(file, error);
  if (error) return saysAbsent(error) ? Servable::No : Servable::Unknown;
  return below(real, root) ? Servable::Yes : Servable::No;
}

/// Names go into URLs, JSON and logs.
bool printable(const std::string& name) {
  return std::none_of(name.begin(), name.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 || byte == 0x7f;
  });
}

class Walk {
public:
  explicit Walk(fs::path root) : root_(std::move(root)) {
    if (const std::error_code error = read(root_))
      throw Error(ErrorKind::NotFound, "cannot read the folder to serve: " + error.message());
    // Sorted, so that the outcome does not depend on the order of a folder.
    std::sort(files_.begin(), files_.end());
  }

  /// All entries below the root but hidden ones.
  const std::vector<fs::path>& files() const { return files_; }
  void cannotTell(const fs::path& file) { unread_.push_back(file.parent_path()); }
  const std::vector<fs::path>& unread() const { return unread_; }

private:
  /// One folder at a time: the library's recursive iterator ends without a word at the first folder that it
  /// cannot read, and what follows would be taken for removed.
  std::error_code read(const fs::path& folder) {
    std::vector<fs::path> folders;
    std::error_code error;
    auto entry = fs::directory_iterator(folder, error);
    while (!error && entry != fs::directory_iterator()) {
      if (!entry->path().filename().string().starts_with('.')) {
        files_.push_back(entry->path());
        std::error_code unknown;
        const fs::file_status status = entry->symlink_status(unknown);
        if (status.type() == fs::file_type::directory) folders.push_back(entry->path());
        if (status.type() == fs::file_type::none) cannotTell(entry->path());
      }
      entry.increment(error); // the end, where there is an error
    }
    if (error) return error;
    for (const fs::path& below : folders)
      if (const std::error_code fault = read(below); fault && !saysAbsent(fault)) unread_.push_back(below);
    return {};
  }

  const fs::path root_;
  std::vector<fs::path> files_, unread_;
};

} // namespace

bool ScanResult::mayHold(const std::string& file) const {
  return std::any_of(unread.begin(), unread.end(), [&](const std::string& folder) {
    return folder == "." || file.starts_with(folder + '/');
  });
}

ScanResult scanRoot(const fs::path& root) {
  ScanResult result;
  std::string seen;
  std::map<std::string, fs::path> scenes;
  std::vector<fs::path> meshes;

  Walk walk(root);
  for (const fs::path& file : walk.files()) {
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
    const Servable here = servable(file, root);
    if (here == Servable::Unknown) walk.cannotTell(file);
    if (here == Servable::No)
      result.warnings.push_back(relative + " is passed over: it is no regular file below the served folder");
    if (here != Servable::Yes) continue;
    if (scene) {
      const std::string name = relative.substr(0, relative.size() - kSceneExtension.size());
      if (!name.empty() && !name.ends_with('/')) scenes[name] = file;
      continue;
    }
    const fs::path sidecar = file.string() + ".chamfer";
    std::error_code error;
    if (fs::symlink_status(sidecar, error).type() == fs::file_type::not_found) continue;
    switch (servable(sidecar, root)) {
    case Servable::Yes:
      meshes.push_back(file);
      break;
    case Servable::No:
      result.warnings.push_back(relative +
                                ".chamfer is passed over: it is no regular file below the served folder");
      break;
    case Servable::Unknown:
      walk.cannotTell(file);
    }
  }

  result.files = digestOf(seen);
  for (const fs::path& folder : walk.unread()) {
    const std::string name = folder.lexically_relative(root).generic_string();
    if (std::find(result.unread.begin(), result.unread.end(), name) != result.unread.end()) continue;
    result.unread.push_back(name);
    result.warnings.push_back((name == "." ? "the served folder" : name) +
                              " cannot be read as a whole now; scenes that were found there before stay");
  }

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
