#include "server/jobs/cli/local_host.h"

#include "common/error.h"
#include "common/text.h"

#include <algorithm>
#include <array>

namespace chamfer {
namespace {

/// Both sides of a case, and of the next one.
constexpr std::size_t kKept = 4;
constexpr std::array kSceneEndings = {".scene.json", "", ".obj", ".stl", ".ply", ".off"};

} // namespace

LocalHost::LocalHost(std::filesystem::path base, std::filesystem::path root, unsigned threads)
    : base_(std::move(base)), root_(std::move(root)), threads_(threads) {}

std::filesystem::path LocalHost::sceneFile(const SideChoice& side) const {
  if (side.kind == SideKind::Scene) return base_ / side.source;
  const std::filesystem::path root = root_.empty() ? base_ : root_;
  for (const char* ending : kSceneEndings)
    if (const auto file = root / (side.source + ending); std::filesystem::is_regular_file(file)) return file;
  throw Error(ErrorKind::NotFound, "there is no scene " + inQuotes(side.source, 200) + " below " +
                                       fileInQuotes(root.string()) +
                                       "; --root names the folder that the URL's server serves");
}

std::shared_ptr<const Scene> LocalHost::scene(const SideChoice& side) {
  const std::filesystem::path file = sceneFile(side).lexically_normal();
  if (side.upAxis && file.extension() == ".json")
    throw Error(ErrorKind::Usage, "up_axis is for a bare mesh; a scene file says it of each of its meshes");
  auto& scene = scenes_[{file, side.upAxis.value_or(UpAxis::Z)}];
  if (!scene) scene = loadScene(file, root_, file.stem().string(), side.upAxis.value_or(UpAxis::Z));
  return scene;
}

std::shared_ptr<const PreparedScene> LocalHost::prepared(const std::shared_ptr<const Scene>& scene,
                                                         const RoundingChoice& choice) {
  const auto found = std::find_if(recent_.begin(), recent_.end(),
                                  [&](const Prepared& p) { return p.scene == scene && p.choice == choice; });
  if (found != recent_.end())
    recent_.splice(recent_.begin(), recent_, found);
  else {
    if (recent_.size() >= kKept) recent_.pop_back();
    recent_.push_front({scene, choice, prepare(scene, choice, threads_)});
  }
  return recent_.front().prepared;
}

RenderResult LocalHost::render(const std::shared_ptr<const Scene>& scene, const TileRequest& request) {
  RenderControl control;
  control.threads = threads_;
  return renderTile(*prepared(scene, request.rounding), request.settings, request.tile, control);
}

} // namespace chamfer
