#include "server/http/catalogue/prepared_cache.h"

#include "common/error.h"
#include "server/http/schema/schema.h"
#include "server/render/cli/render_words.h"

#include <chrono>

namespace chamfer::http {
namespace {

constexpr std::chrono::milliseconds kPoll{50};

std::string keyOf(const Scene& scene, const RoundingChoice& choice) {
  return scene.id.hex() + '|' + roundingWord(choice) + '|' +
         (choice.radius ? numberText(*choice.radius) : "") + '|' +
         (choice.radiusClamp ? numberText(*choice.radiusClamp) : "");
}

} // namespace

std::shared_ptr<const PreparedScene> PreparedCache::get(const std::shared_ptr<const Scene>& scene,
                                                        const RoundingChoice& choice,
                                                        const std::function<bool()>& cancelled) {
  const std::string key = keyOf(*scene, choice);
  std::promise<Result> promise;
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
    entries_.push_front({key, promise.get_future().share(), 0});
    places_[key] = entries_.begin();
  }

  try {
    Result result = prepare(scene, choice, threads_, cancelled);
    const std::size_t bytes = memoryBytes(*result);
    promise.set_value(result);
    const std::lock_guard lock(mutex_);
    places_.at(key)->bytes = bytes;
    bytes_ += bytes;
    evict();
    return result;
  } catch (...) {
    // Those who wait get the same error; the next to come tries again.
    {
      const std::lock_guard lock(mutex_);
      const auto found = places_.find(key);
      entries_.erase(found->second);
      places_.erase(found);
    }
    promise.set_exception(std::current_exception());
    throw;
  }
}

void PreparedCache::evict() {
  for (Place place = entries_.end(); bytes_ > limit_ && place != entries_.begin();) {
    --place;
    if (place == entries_.begin() || place->bytes == 0) continue; // the newest, or still being built
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
