#include "server/http/catalogue/prepared_cache.h"

#include "common/error.h"
#include "common/text.h"
#include "server/http/routes/problem.h"
#include "server/render/request/render_words.h"

#include <algorithm>
#include <chrono>

namespace chamfer::http {
namespace {

constexpr std::chrono::milliseconds kPoll{50};

std::string keyOf(const Scene& scene, const RoundingChoice& choice) {
  return scene.id.hex() + '|' + roundingWord(choice) + '|' +
         (choice.radius ? exactNumberText(*choice.radius) : "") + '|' +
         (choice.radiusClamp ? exactNumberText(*choice.radiusClamp) : "");
}

} // namespace

std::shared_ptr<const PreparedScene> PreparedCache::get(const std::shared_ptr<const Scene>& scene,
                                                        const RoundingChoice& choice,
                                                        const std::function<bool()>& cancelled) {
  const std::string key = keyOf(*scene, choice);
  std::promise<Result> promise;
  Place place;
  {
    std::unique_lock lock(mutex_);
    for (auto found = places_.find(key); found != places_.end(); found = places_.find(key)) {
      ++hits_;
      entries_.splice(entries_.begin(), entries_, found->second);
      const std::shared_future<Result> result = found->second->result;
      lock.unlock();
      while (result.wait_for(kPoll) != std::future_status::ready)
        if (cancelled()) throw Error(ErrorKind::Cancelled, "cancelled while its rounding was built");
      try {
        return result.get();
      } catch (const Error& error) {
        // Who built it has gone, not who waits: it is built again.
        if (error.kind() != ErrorKind::Cancelled) throw;
      }
      lock.lock();
    }
    ++builds_;
    entries_.push_front({key, promise.get_future().share()});
    place = entries_.begin();
    try {
      places_.emplace(key, place);
    } catch (...) {
      entries_.pop_front();
      throw;
    }
  }

  try {
    Result result = build(place, scene, choice, cancelled);
    promise.set_value(result);
    return result;
  } catch (...) {
    // Those who wait get the same error; the next to come tries again.
    {
      const std::lock_guard lock(mutex_);
      count(place, 0);
      places_.erase(key);
      entries_.erase(place);
    }
    promise.set_exception(std::current_exception());
    throw;
  }
}

PreparedCache::Result PreparedCache::build(Place place, const std::shared_ptr<const Scene>& scene,
                                           const RoundingChoice& choice,
                                           const std::function<bool()>& cancelled) {
  const MeshBudget budget{limit_, [&](std::uint64_t bytes) {
                            const std::lock_guard lock(mutex_);
                            count(place, bytes);
                            if (bytes_ > limit_)
                              throw ProblemError(busy("the memory for explicit meshes is in use by other "
                                                      "requests",
                                                      1, Scarcity::Memory));
                          }};
  Result result = prepare(scene, choice, threads_, cancelled, budget);
  const std::size_t bytes = memoryBytes(*result);
  const std::lock_guard lock(mutex_);
  place->ready = true;
  // Not below what was foretold: where another scene is let go at the same time, the measure of a hierarchy
  // comes out too low.
  count(place, std::max(bytes, place->bytes));
  return result;
}

/// `place` takes so many bytes now; others make room for it.
void PreparedCache::count(Place place, std::size_t bytes) {
  bytes_ += bytes - place->bytes;
  place->bytes = bytes;
  evict();
}

/// What is in use would stay in memory all the same.
void PreparedCache::evict() {
  for (Place place = entries_.end(); bytes_ > limit_ && place != entries_.begin();) {
    --place;
    if (!place->ready || place->result.wait_for(std::chrono::seconds(0)) != std::future_status::ready ||
        place->result.get().use_count() > 1)
      continue;
    bytes_ -= place->bytes;
    ++evictions_;
    places_.erase(place->key);
    place = entries_.erase(place);
  }
}

PreparedCache::State PreparedCache::state() const {
  const std::lock_guard lock(mutex_);
  return {entries_.size(), bytes_, limit_, hits_, builds_, evictions_};
}

} // namespace chamfer::http
