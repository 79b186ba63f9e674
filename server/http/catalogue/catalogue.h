// The scenes that a server has: found below one folder, loaded in the background, loaded again when their
// files change. Entries are immutable snapshots: a request keeps the one it began with.
#pragma once

#include "common/error.h"
#include "server/http/catalogue/catalogue_scan.h"
#include "server/http/catalogue/file_stamp.h"
#include "server/render/scene/scene.h"

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
  std::size_t bytes = 0; ///< memory of the scene
  /// Ready only: the files have changed since and cannot be loaded as they are now, for this reason; empty:
  /// they have not. A file that is half written when it is looked at does no harm in this way.
  std::string outdated;
  /// Ready and a bare mesh: the same with its other axis up (Scene::otherUp), found by its id only.
  std::shared_ptr<const CatalogueEntry> otherUp;
};

class Catalogue {
public:
  /// Throws Error(NotFound) when `root` is not a folder. `rescan`: how often files are looked at again; 0:
  /// never. `memory`: bytes that all scenes together may take; one that does not fit is not ready, and says
  /// so. `meshUp`: as loadScene()'s.
  Catalogue(const std::filesystem::path& root, std::chrono::milliseconds rescan,
            std::size_t memory = SIZE_MAX, UpAxis meshUp = UpAxis::Z);
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
  std::size_t memoryLimit() const { return memory_; }
  /// The served folder, canonical.
  const std::filesystem::path& root() const { return root_; }

private:
  using Entry = std::shared_ptr<const CatalogueEntry>;
  /// What an entry was loaded from.
  struct Sources {
    std::filesystem::path file; ///< the scene's own
    std::vector<FileStamp> stamps;
    Digest files; ///< of everything below the root then
  };
  void run();
  void pass();
  void forget(const ScanResult& scan);
  void put(const Entry& entry);
  void indexIds();
  bool current(const FoundScene& found, const CatalogueEntry& entry, const Digest& files) const;
  Entry load(const FoundScene& found, const Entry& before) const;
  void checkMemory(const CatalogueEntry& entry) const;

  const std::filesystem::path root_;
  const std::chrono::milliseconds rescan_;
  const std::size_t memory_;
  const UpAxis meshUp_;
  std::atomic<bool> loaded_ = false, stopping_ = false;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::map<std::string, Entry> byName_;
  std::map<std::string, Entry> byId_; ///< of names with equal contents, which share an id, the first
  std::vector<std::string> warnings_;
  std::map<std::string, Sources> sources_; ///< by name; the loading thread's own
  std::thread thread_;
};

} // namespace chamfer::http
