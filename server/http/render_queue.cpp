#include "server/http/render_queue.h"

#include "server/http/problem.h"

#include <algorithm>
#include <cmath>

namespace chamfer::http {
namespace {

/// A waiting request looks this often whether it is still wanted.
constexpr std::chrono::milliseconds kPoll{50};
constexpr int kLongestRetrySeconds = 60;

} // namespace

RenderQueue::RenderQueue(unsigned slots, unsigned waiting) : slots_(std::max(1u, slots)), places_(waiting) {}

RenderQueue::Slot::Slot(RenderQueue* queue, std::string client)
    : queue_(queue), client_(std::move(client)), since_(std::chrono::steady_clock::now()) {}

RenderQueue::Slot::~Slot() {
  if (queue_)
    queue_->release(client_,
                    std::chrono::duration<double>(std::chrono::steady_clock::now() - since_).count());
}

RenderQueue::Slot RenderQueue::acquire(const std::string& client, const std::function<bool()>& cancelled) {
  std::unique_lock lock(mutex_);
  if (running_ < slots_ && waiting_.empty()) {
    ++running_;
    ++holds_[client];
    return Slot(this, client);
  }
  if (waiting_.size() >= places_)
    throw ProblemError(busy(std::to_string(running_) + " requests are rendered and " +
                                std::to_string(waiting_.size()) + " wait, which is all that may",
                            retryAfterSeconds(), Scarcity::RenderQueue));
  Waiter self{client};
  const auto place = waiting_.insert(waiting_.end(), &self);
  while (!wake_.wait_for(lock, kPoll, [&] { return self.granted; })) {
    if (!cancelled()) continue;
    waiting_.erase(place);
    throw Error(ErrorKind::Cancelled, "cancelled while it waited to be rendered");
  }
  return Slot(this, client);
}

void RenderQueue::grantNext() {
  if (running_ >= slots_ || waiting_.empty()) return;
  const auto held = [this](const Waiter* waiter) {
    const auto found = holds_.find(waiter->client);
    return found == holds_.end() ? 0u : found->second;
  };
  // Of equals the first to come: min_element keeps the earliest.
  const auto next = std::min_element(waiting_.begin(), waiting_.end(),
                                     [&](const Waiter* a, const Waiter* b) { return held(a) < held(b); });
  (*next)->granted = true;
  ++running_;
  ++holds_[(*next)->client];
  waiting_.erase(next);
  wake_.notify_all();
}

void RenderQueue::release(const std::string& client, double seconds) {
  const std::lock_guard lock(mutex_);
  --running_;
  if (const auto found = holds_.find(client); --found->second == 0) holds_.erase(found);
  meanSeconds_ += 0.1 * (seconds - meanSeconds_);
  grantNext();
}

int RenderQueue::retryAfterSeconds() const {
  const double seconds = meanSeconds_ * static_cast<double>(waiting_.size() + 1) / slots_;
  return std::clamp(static_cast<int>(std::ceil(seconds)), 1, kLongestRetrySeconds);
}

RenderQueue::State RenderQueue::state() const {
  const std::lock_guard lock(mutex_);
  return {slots_, running_, places_, static_cast<unsigned>(waiting_.size()), retryAfterSeconds()};
}

} // namespace chamfer::http
