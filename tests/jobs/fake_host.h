// A host whose renders are made-up noise of a known mean: the k-th pixel of a seed is the same whatever tile
// it is rendered in, and the same for all scenes but for what they are told to differ by.
#pragma once

#include "common/error.h"
#include "server/jobs/compare/compare_host.h"

#include <atomic>
#include <functional>
#include <map>

namespace chamfer::test {

class FakeHost final : public CompareHost {
public:
  /// What a scene's pixels are multiplied by, at a place of the frame.
  using Change = std::function<float(unsigned x, unsigned y)>;

  explicit FakeHost(std::filesystem::path folder) : folder_(std::move(folder)) {}
  void add(const std::string& scene, Change change) { changes_[scene] = std::move(change); }

  std::shared_ptr<const Scene> scene(const SideChoice& side) override {
    if (!changes_.contains(side.source)) throw Error(ErrorKind::NotFound, "there is no such scene");
    auto scene = std::make_shared<Scene>();
    scene->name = side.source;
    scene->id = digestOf(side.source);
    return scene;
  }
  std::filesystem::path file(const std::string& name) override { return folder_ / name; }
  RenderResult render(const std::shared_ptr<const Scene>& scene, const TileRequest& request) override {
    ++renders;
    const TileRect& t = request.tile;
    RenderResult result;
    result.image = {t.width, t.height, {}};
    result.statistics.nonFiniteSamples = nonFinite;
    for (unsigned y = t.y; y < t.y + t.height; ++y)
      for (unsigned x = t.x; x < t.x + t.width; ++x) {
        for (unsigned c = 0; c < 3; ++c)
          result.image.rgba.push_back(changes_.at(scene->name)(x, y) * noise(x, y, c, request.settings.seed));
        result.image.rgba.push_back(1);
      }
    if (interrupt) interrupt();
    return result;
  }

  std::atomic<unsigned> renders = 0;
  std::uint64_t nonFinite = 0;       ///< samples that every render reports
  std::function<void()> interrupt{}; ///< called at the end of each render; may throw

private:
  /// 0.5 to 1.5.
  static float noise(unsigned x, unsigned y, unsigned c, unsigned seed) {
    std::uint64_t h = (std::uint64_t{x} << 40 | std::uint64_t{y} << 24 | std::uint64_t{c} << 20) ^
                      (std::uint64_t{seed} * 0x9e3779b97f4a7c15u);
    for (int i = 0; i < 3; ++i) {
      h ^= h >> 31;
      h *= 0xbf58476d1ce4e5b9u;
    }
    return 0.5f + float(h >> 40) / float(1u << 24);
  }

  std::filesystem::path folder_;
  std::map<std::string, Change> changes_;
};

} // namespace chamfer::test
