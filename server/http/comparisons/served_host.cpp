#include "server/http/comparisons/served_host.h"

#include "common/digest.h"
#include "common/error.h"
#include "common/text.h"
#include "server/http/routes/problem.h"
#include "server/http/schema/limits.h"
#include "server/render/scene/scene_files.h"

#include <algorithm>
#include <array>
#include <thread>

namespace chamfer::http {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

/// Work of one tile, pixels times samples: it is over within some hundredths of a second, and requests that
/// come meanwhile have the cores from then on alone.
constexpr unsigned kTileWork = 1u << 14;
constexpr unsigned kLargestTile = 128, kSmallestTile = 8; ///< pixels a side
/// So long a tile waits for a moment without requests; then it is rendered beside them.
constexpr milliseconds kPatience{50};
constexpr milliseconds kPause{200};

bool isHidden(const fs::path& relative) {
  return std::any_of(relative.begin(), relative.end(),
                     [](const fs::path& part) { return part.string().starts_with('.'); });
}

unsigned tileSide(unsigned samples) {
  unsigned side = kLargestTile;
  while (side > kSmallestTile && std::uint64_t{side} * side * samples > kTileWork)
    side /= 2;
  return side;
}

} // namespace

std::shared_ptr<const CatalogueEntry> findScene(const Catalogue& catalogue, const std::string& source) {
  const std::string name = fs::path(source).lexically_normal().generic_string();
  if (auto entry = catalogue.find(name)) return entry;
  for (const std::string_view ending : {".scene.json", ".obj", ".stl", ".ply", ".off"}) {
    if (!name.ends_with(ending)) continue;
    const auto entry = catalogue.find(name.substr(0, name.size() - ending.size()));
    if (!entry || !entry->scene) return entry;
    // Another file may have the name: a scene file goes before a mesh, one mesh before another.
    const auto& files = entry->scene->files;
    return std::find(files.begin(), files.end(), catalogue.root() / name) != files.end() ? entry : nullptr;
  }
  return nullptr;
}

fs::path servedFile(const fs::path& root, const std::string& name) {
  const fs::path file = resolveBelow(root, root, name);
  if (isHidden(fs::path(name).lexically_normal()) || isHidden(file.lexically_relative(root)))
    throw Error(ErrorKind::NotFound, fileInQuotes(name) + ": there is no such file");
  std::error_code error;
  if (const auto size = fs::file_size(file, error); error || size > kMaxComparisonFileBytes)
    throw Error(ErrorKind::PayloadTooLarge, fileInQuotes(name) + ": " + std::to_string(size) +
                                                " bytes, at most " + std::to_string(kMaxComparisonFileBytes) +
                                                " are read");
  return file;
}

std::string fileDigest(const fs::path& file) {
  return digestOf(readFileText(file, kMaxComparisonFileBytes)).hex();
}

void ServedHost::pause() const {
  for (auto waited = milliseconds(0); waited < kPause; waited += milliseconds(20)) {
    if (stop_()) throw Error(ErrorKind::Cancelled, "the comparison was cancelled");
    std::this_thread::sleep_for(milliseconds(20));
  }
}

std::shared_ptr<const Scene> ServedHost::scene(const SideChoice& side) {
  const Catalogue& catalogue = parts_.catalogue;
  const std::string& id = origins_.scenes.at(side.source);
  for (;; pause()) {
    // By its id, whatever its name is by now.
    if (const auto entry = catalogue.find(id); entry && entry->scene) return entry->scene;
    const auto entry = findScene(catalogue, side.source);
    if (!catalogue.loaded() || (entry && entry->state == SceneState::Loading)) continue;
    if (!entry)
      throw Error(ErrorKind::NotFound, "the scene is not there any more; it had the id " + id +
                                           " when the comparison was submitted");
    if (entry->scene)
      throw Error(ErrorKind::Usage, "the scene is not what it was when the comparison was submitted: it had "
                                    "the id " +
                                        id + ", now " + entry->scene->id.hex() + "; submit it again");
    throw Error(entry->fault,
                std::string("the scene is ") + sceneStateWord(entry->state) + ": " + entry->error);
  }
}

fs::path ServedHost::file(const std::string& name) {
  fs::path file = servedFile(parts_.catalogue.root(), name);
  if (fileDigest(file) != origins_.files.at(name))
    throw Error(ErrorKind::Usage, fileInQuotes(name) +
                                      ": the file is not what it was when the comparison was submitted; "
                                      "submit it again");
  return file;
}

std::shared_ptr<const PreparedScene> ServedHost::prepared(const std::shared_ptr<const Scene>& scene,
                                                          const RoundingChoice& choice) const {
  for (;; pause()) {
    const auto place = parts_.queue.acquireBackground(kPatience, stop_);
    try {
      return parts_.cache.get(scene, choice, stop_);
    } catch (const ProblemError& error) { // the memory is in use by requests, for now
      if (error.problem().status != 503) throw Error(ErrorKind::OutOfRange, error.what());
    }
  }
}

RenderResult ServedHost::render(const std::shared_ptr<const Scene>& scene, const TileRequest& request) {
  const auto ready = prepared(scene, request.rounding);
  const RenderControl control{parts_.options.threads, stop_, nullptr};
  const TileRect& whole = request.tile;
  const unsigned side = tileSide(request.samples());
  RenderResult result;
  result.image = {whole.width, whole.height, std::vector<float>(std::size_t{whole.width} * whole.height * 4)};
  for (unsigned y = 0; y < whole.height; y += side)
    for (unsigned x = 0; x < whole.width; x += side) {
      const TileRect tile{whole.x + x, whole.y + y, std::min(side, whole.width - x),
                          std::min(side, whole.height - y)};
      const auto place = parts_.queue.acquireBackground(kPatience, stop_);
      const RenderResult part = renderTile(*ready, request.settings, tile, control);
      result.statistics += part.statistics;
      for (unsigned row = 0; row < tile.height; ++row)
        std::copy_n(part.image.rgba.data() + std::size_t{row} * tile.width * 4, std::size_t{tile.width} * 4,
                    result.image.rgba.data() + (std::size_t{y + row} * whole.width + x) * 4);
    }
  parts_.metrics.traced(result.statistics);
  return result;
}

} // namespace chamfer::http
