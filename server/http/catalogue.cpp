#include "server/http/catalogue.h"

#include "server/http/log.h"
#include "server/http/problem.h"

#include <set>

namespace chamfer::http {
namespace {

namespace fs = std::filesystem;

fs::path canonicalFolder(const fs::path& root) {
  std::error_code error;
  const fs::path real = fs::canonical(root, error);
  if (error || !fs::is_directory(real, error))
    throw Error(ErrorKind::NotFound,
                root.string() + " is not a folder; name the folder that holds the scenes");
  return real;
}

} // namespace

const char* sceneStateWord(SceneState state) {
  switch (state) {
  case SceneState::Loading:
    return "loading";
  case SceneState::Ready:
    return "ready";
  case SceneState::Stale:
    return "stale";
  case SceneState::Damaged:
    return "damaged";
  case SceneState::Failed:
    return "failed";
  }
  return "";
}

Catalogue::Catalogue(const fs::path& root, std::chrono::milliseconds rescan)
    : root_(canonicalFolder(root)), rescan_(rescan) {}

Catalogue::~Catalogue() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void Catalogue::start() {
  thread_ = std::thread([this] { run(); });
}

void Catalogue::run() {
  for (;;) {
    try {
      pass();
    } catch (const std::exception& error) { // the folder is away, or memory is short: try again later
      logMessage(LogLevel::Error, std::string("the scenes cannot be looked at: ") + error.what());
    }
    if (stopping_) return;
    loaded_ = true;
    std::unique_lock lock(mutex_);
    const auto stopped = [this] { return stopping_.load(); };
    if (rescan_.count() == 0)
      wake_.wait(lock, stopped);
    else
      wake_.wait_for(lock, rescan_, stopped);
    if (stopping_) return;
  }
}

void Catalogue::pass() {
  const ScanResult scan = scanRoot(root_);
  std::set<std::string> names;
  {
    const std::lock_guard lock(mutex_);
    if (scan.warnings != warnings_)
      for (const std::string& warning : scan.warnings)
        logMessage(LogLevel::Warning, warning);
    warnings_ = scan.warnings;
    for (const FoundScene& found : scan.scenes) {
      names.insert(found.name);
      if (!byName_.contains(found.name)) {
        auto entry = std::make_shared<CatalogueEntry>();
        entry->name = found.name;
        byName_[found.name] = entry;
      }
    }
    std::erase_if(byName_, [&](const auto& item) { return !names.contains(item.first); });
    std::erase_if(byId_, [&](const auto& item) { return !names.contains(item.second->name); });
  }
  std::erase_if(sources_, [&](const auto& item) { return !names.contains(item.first); });

  for (const FoundScene& found : scan.scenes) {
    if (stopping_) return;
    if (const Entry before = find(found.name); before && current(found, *before, scan.files)) continue;
    // Stamps of before the read: a change during it is seen by the next pass.
    const std::vector<Stamp> own = stampsOf(found, nullptr);
    const Entry entry = load(found);
    std::vector<Stamp> stamps = stampsOf(found, entry->scene.get());
    std::copy(own.begin(), own.end(), stamps.begin());
    sources_[found.name] = {std::move(stamps), scan.files};
    const std::lock_guard lock(mutex_);
    std::erase_if(byId_, [&](const auto& item) { return item.second->name == found.name; });
    byName_[found.name] = entry;
    if (entry->scene) byId_[entry->scene->id.hex()] = entry;
  }
}

bool Catalogue::current(const FoundScene& found, const CatalogueEntry& entry, const Digest& files) const {
  const auto sources = sources_.find(found.name);
  if (sources == sources_.end()) return false;
  if (sources->second.stamps != stampsOf(found, entry.scene.get())) return false;
  // What a scene that could not be loaded names besides is not known: any file may be the one that was
  // mended.
  return entry.state == SceneState::Ready || sources->second.files == files;
}

Catalogue::Entry Catalogue::load(const FoundScene& found) const {
  const auto begin = std::chrono::steady_clock::now();
  auto entry = std::make_shared<CatalogueEntry>();
  entry->name = found.name;
  try {
    entry->scene = loadScene(found.file, root_, found.name);
    entry->state = SceneState::Ready;
  } catch (const Error& error) {
    entry->fault = error.kind();
    entry->state = error.kind() == ErrorKind::StaleSidecar     ? SceneState::Stale
                   : error.kind() == ErrorKind::DamagedSidecar ? SceneState::Damaged
                                                               : SceneState::Failed;
    entry->error = withoutRoot(error.what(), root_.string());
  } catch (const std::exception& error) { // a library's: its text is for the log only
    entry->state = SceneState::Failed;
    entry->error = "it could not be loaded; the server's log has more";
    logMessage(LogLevel::Error, "scene " + found.name + ": " + error.what());
  }
  entry->loadSeconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (entry->state == SceneState::Ready)
    logMessage(LogLevel::Info, "scene " + found.name +
                                   " is ready: " + std::to_string(entry->scene->triangles) + " triangles, " +
                                   std::to_string(entry->scene->roundedEdges) + " rounded edges");
  else
    logMessage(LogLevel::Warning,
               "scene " + found.name + " is " + sceneStateWord(entry->state) + ": " + entry->error);
  return entry;
}

Catalogue::Stamp Catalogue::stampOf(const fs::path& file) {
  Stamp stamp{file};
  std::error_code error;
  stamp.time = fs::last_write_time(file, error);
  stamp.size = fs::file_size(file, error);
  return stamp;
}

std::vector<Catalogue::Stamp> Catalogue::stampsOf(const FoundScene& found, const Scene* scene) {
  const auto sidecar = [](const fs::path& mesh) { return fs::path(mesh.string() + ".chamfer"); };
  std::vector<Stamp> stamps{stampOf(found.file), stampOf(sidecar(found.file))};
  if (scene)
    for (const SceneMesh& mesh : scene->meshes) {
      stamps.push_back(stampOf(mesh.file));
      stamps.push_back(stampOf(sidecar(mesh.file)));
    }
  return stamps;
}

std::vector<Catalogue::Entry> Catalogue::list() const {
  const std::lock_guard lock(mutex_);
  std::vector<Entry> entries;
  for (const auto& [name, entry] : byName_)
    entries.push_back(entry);
  return entries;
}

Catalogue::Entry Catalogue::find(const std::string& nameOrId) const {
  const std::lock_guard lock(mutex_);
  if (const auto found = byName_.find(nameOrId); found != byName_.end()) return found->second;
  if (const auto found = byId_.find(nameOrId); found != byId_.end()) return found->second;
  return nullptr;
}

std::vector<std::string> Catalogue::warnings() const {
  const std::lock_guard lock(mutex_);
  return warnings_;
}

} // namespace chamfer::http
