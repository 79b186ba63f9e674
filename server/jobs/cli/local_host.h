// Comparisons of files of this machine, rendered in this process.
#pragma once

#include "server/jobs/compare/compare_host.h"

#include <list>
#include <map>
#include <utility>

namespace chamfer {

class LocalHost final : public CompareHost {
public:
  /// `base`: files are named relative to it. `root`: scenes of tiles' URLs lie below it, and scene files may
  /// name files only below it; empty: `base`, and the scene file's folder. `threads`: 0: all cores.
  LocalHost(std::filesystem::path base, std::filesystem::path root, unsigned threads);

  std::shared_ptr<const Scene> scene(const SideChoice& side) override;
  std::filesystem::path file(const std::string& name) override { return base_ / name; }
  RenderResult render(const std::shared_ptr<const Scene>& scene, const TileRequest& request) override;

private:
  std::filesystem::path sceneFile(const SideChoice& side) const;
  std::shared_ptr<const PreparedScene> prepared(const std::shared_ptr<const Scene>& scene,
                                                const RoundingChoice& choice);

  std::filesystem::path base_, root_;
  unsigned threads_;
  std::map<std::pair<std::filesystem::path, UpAxis>, std::shared_ptr<const Scene>> scenes_;
  struct Prepared {
    std::shared_ptr<const Scene> scene;
    RoundingChoice choice;
    std::shared_ptr<const PreparedScene> prepared;
  };
  std::list<Prepared> recent_; ///< last used first
};

} // namespace chamfer
