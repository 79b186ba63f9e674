#include "server/http/catalogue/catalogue.h"

#include "server/http/monitoring/log.h"
#include "server/http/routes/problem.h"

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

Catalogue::Catalogue(const fs::path& root, std::chrono::milliseconds rescan, std::size_t memory,
                     UpAxis meshUp)
    : root_(canonicalFolder(root)), rescan_(rescan), memory_(memory), meshUp_(meshUp) {}

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
  forget(scan);
  for (const FoundScene& found : scan.scenes) {
    if (stopping_) return;
    const Entry before = find(found.name);
    if (before && current(found, *before, scan.files)) continue;
    const timespec begin = fileClock();
    const Entry entry = load(found, before);
    std::vector<fs::path> files{found.file};
    if (entry->scene) files = entry->scene->files;
    sources_[found.name] = {found.file, stampsOf(files, begin), scan.files};
    put(entry);
  }
}

/// Lets go of what is no longer there, and lists what is new.
void Catalogue::forget(const ScanResult& scan) {
  std::set<std::string> names;
  for (const FoundScene& found : scan.scenes)
    names.insert(found.name);
  std::erase_if(sources_, [&](const auto& item) {
    if (names.contains(item.first)) return false;
    if (!scan.mayHold(item.second.file.lexically_relative(root_).generic_string())) return true;
    names.insert(item.first);
    return false;
  });

  const std::lock_guard lock(mutex_);
  if (scan.warnings != warnings_)
    for (const std::string& warning : scan.warnings)
      logMessage(LogLevel::Warning, warning);
  warnings_ = scan.warnings;
  for (const FoundScene& found : scan.scenes)
    if (!byName_.contains(found.name)) {
      auto entry = std::make_shared<CatalogueEntry>();
      entry->name = found.name;
      byName_[found.name] = entry;
    }
  std::erase_if(byName_, [&](const auto& item) { return !names.contains(item.first); });
  indexIds();
}

void Catalogue::put(const Entry& entry) {
  const std::lock_guard lock(mutex_);
  byName_[entry->name] = entry;
  indexIds();
}

/// Made anew from the names, so that an id lives as long as any name has its content.
void Catalogue::indexIds() {
  std::map<std::string, Entry> ids;
  for (const auto& [name, entry] : byName_)
    for (const Entry& e : {entry, entry->otherUp})
      if (e && e->scene) ids.emplace(e->scene->id.hex(), e);
  byId_.swap(ids);
}

bool Catalogue::current(const FoundScene& found, const CatalogueEntry& entry, const Digest& files) const {
  const auto sources = sources_.find(found.name);
  if (sources == sources_.end() || sources->second.file != found.file) return false;
  if (entry.state == SceneState::Ready && entry.outdated.empty()) return unchanged(sources->second.stamps);
  // What a scene that could not be loaded names besides is not known: any file may be the one that was
  // mended.
  return sources->second.files == files && unchanged(sources->second.stamps);
}

Catalogue::Entry Catalogue::load(const FoundScene& found, const Entry& before) const {
  const auto begin = std::chrono::steady_clock::now();
  auto entry = std::make_shared<CatalogueEntry>();
  entry->name = found.name;
  try {
    entry->scene = loadScene(found.file, root_, found.name, meshUp_);
    entry->bytes = memoryBytes(*entry->scene);
    checkMemory(*entry);
    entry->state = SceneState::Ready;
  } catch (const Error& error) {
    entry->fault = error.kind();
    entry->state = error.kind() == ErrorKind::StaleSidecar     ? SceneState::Stale
                   : error.kind() == ErrorKind::DamagedSidecar ? SceneState::Damaged
                                                               : SceneState::Failed;
    entry->error = withoutRoot(error.what(), root_.string());
  } catch (const std::bad_alloc&) {
    entry->fault = ErrorKind::PayloadTooLarge;
    entry->state = SceneState::Failed;
    entry->error = "there is not memory enough to load it";
  } catch (const std::exception& error) { // a library's: its text is for the log only
    entry->state = SceneState::Failed;
    entry->error = "it could not be loaded; the server's log has more";
    logMessage(LogLevel::Error, "scene " + found.name + ": " + error.what());
  }
  entry->loadSeconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (entry->state == SceneState::Ready) {
    logMessage(LogLevel::Info, "scene " + found.name +
                                   " is ready: " + std::to_string(entry->scene->triangles) + " triangles, " +
                                   std::to_string(entry->scene->roundedEdges) + " rounded edges");
    if (entry->scene->otherUp) {
      auto other = std::make_shared<CatalogueEntry>(*entry);
      other->scene = entry->scene->otherUp;
      entry->otherUp = std::move(other);
    }
    return entry;
  }
  if (before && before->state == SceneState::Ready) {
    auto kept = std::make_shared<CatalogueEntry>(*before);
    kept->outdated = "its files have changed and cannot be loaded as they are now, the scene is served as it "
                     "was before: " +
                     entry->error;
    logMessage(LogLevel::Warning, "scene " + found.name + ": " + kept->outdated);
    return kept;
  }
  entry->scene.reset();
  entry->bytes = 0;
  logMessage(LogLevel::Warning,
             "scene " + found.name + " is " + sceneStateWord(entry->state) + ": " + entry->error);
  return entry;
}

void Catalogue::checkMemory(const CatalogueEntry& entry) const {
  std::size_t others = 0;
  for (const Entry& other : list())
    if (other->name != entry.name) others += other->bytes;
  const auto megabytes = [](std::size_t bytes) { return std::to_string((bytes >> 20) + 1) + " MB"; };
  if (entry.bytes > memory_ || others > memory_ - entry.bytes)
    throw Error(ErrorKind::PayloadTooLarge,
                "it takes " + megabytes(entry.bytes) + " of memory, beside " + megabytes(others) +
                    " of other scenes, and all together may " + "take " + megabytes(memory_) +
                    "; raise --scene-megabytes or serve less in one process");
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
