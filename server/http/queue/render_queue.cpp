#include "server/http/queue/render_queue.h"

#include "server/http/routes/problem.h"

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
  if (waiting_.size() >= places_ && !makeRoomFor(client))
    throw ProblemError(busy(std::to_string(running_) + " requests are rendered and " +
                                std::to_string(waiting_.size()) + " wait, which is all that may",
                            retryAfterSeconds(), Scarcity::RenderQueue));
  Waiter self{client};
  const auto place = waiting_.insert(waiting_.end(), &self);
  while (!wake_.wait_for(lock, kPoll, [&] { return self.granted || self.displaced; })) {
    if (!cancelled()) continue;
    waiting_.erase(place);
    throw Error(ErrorKind::Cancelled, "cancelled while it waited to be rendered");
  }
  if (self.displaced) {
    Problem problem = busy("more requests of this client wait than of any other, and another one needed the "
                           "place of this one",
                           retryAfterSeconds(), Scarcity::FairShare);
    problem.status = 429;
    throw ProblemError(problem);
  }
  return Slot(this, client);
}

bool RenderQueue::makeRoomFor(const std::string& client) {
  std::map<std::string, unsigned> waits;
  for (const Waiter* waiter : waiting_)
    ++waits[waiter->client];
  if (waits.empty()) return false;
  const auto most = std::max_element(waits.begin(), waits.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  const auto own = waits.find(client);
  // With one more of its own the newcomer must still have fewer, or both would displace each other.
  if ((own == waits.end() ? 0 : own->second) + 1 >= most->second) return false;
  const auto last = std::find_if(waiting_.rbegin(), waiting_.rend(),
                                 [&](const Waiter* waiter) { return waiter->client == most->first; });
  (*last)->displaced = true;
  waiting_.erase(std::next(last).base());
  wake_.notify_all();
  return true;
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
