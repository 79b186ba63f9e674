// Scenes prepared for tracing, by scene and rounding: built once however many ask at the same time, kept
// while there is room, the least recently used dropped first. What renders in flight use stays, and counts.
#pragma once

#include "common/digest.h"
#include "server/render/path/render.h"

#include <functional>
#include <future>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>

namespace chamfer::http {

class PreparedCache {
public:
  /// `bytes`: of everything kept. An explicit mesh is built only when it fits beside what is in use; another
  /// rounding, whose size is the scene's and not the client's choice, also when it is larger. `threads`: for
  /// building.
  PreparedCache(std::size_t bytes, unsigned threads) : limit_(bytes), threads_(threads) {}

  /// Builds or waits for what another request builds. Throws what prepare() throws (it is tried again the
  /// next time), ProblemError (503) while what is in use leaves no room for an explicit mesh, and
  /// Error(Cancelled) soon after `cancelled` has turned true, whoever builds.
  std::shared_ptr<const PreparedScene> get(const std::shared_ptr<const Scene>& scene,
                                           const RoundingChoice& choice,
                                           const std::function<bool()>& cancelled);

  struct State {
    std::size_t entries, bytes, limit, hits, builds, evictions;
  };
  State state() const;

private:
  using Result = std::shared_ptr<const PreparedScene>;
  struct Entry {
    std::string key;
    std::shared_future<Result> result;
    std::size_t bytes = 0; ///< while it is built: what it is expected to take, where that is known
    bool ready = false;
  };
  using Place = std::list<Entry>::iterator;
  Result build(Place place, const std::shared_ptr<const Scene>& scene, const RoundingChoice& choice,
               const std::function<bool()>& cancelled);
  void count(Place place, std::size_t bytes);
  void evict();

  const std::size_t limit_;
  const unsigned threads_;
  mutable std::mutex mutex_;
  std::list<Entry> entries_; ///< most recently used first
  std::unordered_map<std::string, Place> places_;
  std::size_t bytes_ = 0, hits_ = 0, builds_ = 0, evictions_ = 0;
};

} // namespace chamfer::http
