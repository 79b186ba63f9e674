// The scenes that a server has: found below one folder, loaded in the background, loaded again when their
// files change. Entries are immutable snapshots: a request keeps the one it began with.
#pragma once

#include "common/error.h"
#include "server/http/catalogue_scan.h"
#include "server/render/scene.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace chamfer::http {

enum class SceneState : std::uint8_t { Loading, Ready, Stale, Damaged, Failed };
inline constexpr std::size_t kSceneStates = 5;
const char* sceneStateWord(SceneState state);

struct CatalogueEntry {
  std::string name;
  SceneState state = SceneState::Loading;
  ErrorKind fault = ErrorKind::Internal; ///< why it is neither loading nor ready
  std::string error;                     ///< the same for people; paths below the root only
  std::shared_ptr<const Scene> scene;    ///< Ready only
  double loadSeconds = 0;
};

class Catalogue {
public:
  /// Throws Error(NotFound) when `root` is not a folder. `rescan`: how often files are looked at again; 0:
  /// never.
  Catalogue(const std::filesystem::path& root, std::chrono::milliseconds rescan);
  ~Catalogue();
  Catalogue(const Catalogue&) = delete;
  Catalogue& operator=(const Catalogue&) = delete;

  /// Begins to load in the background.
  void start();
  /// Every scene was tried once.
  bool loaded() const { return loaded_; }
  /// By name, in order.
  std::vector<std::shared_ptr<const CatalogueEntry>> list() const;
  /// By name, or by the id of a scene that is ready; nullptr when there is none.
  std::shared_ptr<const CatalogueEntry> find(const std::string& nameOrId) const;
  /// What the last scan passed over.
  std::vector<std::string> warnings() const;
  /// The served folder, canonical.
  const std::filesystem::path& root() const { return root_; }

private:
  using Entry = std::shared_ptr<const CatalogueEntry>;
  /// What a file looked like when it was read.
  struct Stamp {
    std::filesystem::path file;
    std::filesystem::file_time_type time{};
    std::uintmax_t size = 0;
    bool operator==(const Stamp&) const = default;
  };
  /// What an entry was loaded from.
  struct Sources {
    std::vector<Stamp> stamps;
    Digest files; ///< of everything below the root then
  };
  void run();
  void pass();
  bool current(const FoundScene& found, const CatalogueEntry& entry, const Digest& files) const;
  Entry load(const FoundScene& found) const;
  static Stamp stampOf(const std::filesystem::path& file);
  static std::vector<Stamp> stampsOf(const FoundScene& found, const Scene* scene);

  const std::filesystem::path root_;
  const std::chrono::milliseconds rescan_;
  std::atomic<bool> loaded_ = false, stopping_ = false;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::map<std::string, Entry> byName_;
  std::map<std::string, Entry> byId_;
  std::vector<std::string> warnings_;
  std::map<std::string, Sources> sources_; ///< by name; the loading thread's own
  std::thread thread_;
};

} // namespace chamfer::http
