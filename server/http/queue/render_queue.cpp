#include "server/http/queue/render_queue.h"

#include "server/http/routes/problem.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

namespace chamfer::http {
namespace {

/// A waiting request looks this often whether it is still wanted.
constexpr std::chrono::milliseconds kPoll{50};
constexpr int kLongestRetrySeconds = 60;

} // namespace

RenderQueue::RenderQueue(unsigned slots, unsigned waiting) : slots_(std::max(1u, slots)), places_(waiting) {}

RenderQueue::Slot::~Slot() {
  if (queue_)
    queue_->release(ticket_,
                    std::chrono::duration<double>(std::chrono::steady_clock::now() - since_).count());
}

RenderQueue::Slot RenderQueue::acquire(const std::string& client, const std::function<bool()>& cancelled) {
  using Phase = Ticket::Phase;
  Tickets own{{client}};
  const auto ticket = own.begin();
  std::unique_lock lock(mutex_);
  if (running_.size() < slots_ && waiting_.empty()) {
    running_.splice(running_.end(), own);
    return Slot(this, ticket);
  }
  if (waiting_.size() >= places_ && !makeRoomFor(client))
    throw ProblemError(busy(std::to_string(running_.size()) + " requests are rendered and " +
                                std::to_string(waiting_.size()) + " wait, which is all that may",
                            retryAfterSeconds(), Scarcity::RenderQueue));
  waiting_.splice(waiting_.end(), own);
  while (!wake_.wait_for(lock, kPoll, [&] { return ticket->phase != Phase::Waiting; })) {
    if (!cancelled()) continue;
    waiting_.erase(ticket);
    throw Error(ErrorKind::Cancelled, "cancelled while it waited to be rendered");
  }
  if (ticket->phase == Phase::Granted) return Slot(this, ticket);
  displaced_.erase(ticket);
  Problem problem = busy("more requests of this client wait than of any other, and another one needed the "
                         "place of this one",
                         retryAfterSeconds(), Scarcity::FairShare);
  problem.status = 429;
  throw ProblemError(problem);
}

RenderQueue::BackgroundPlace::~BackgroundPlace() {
  if (queue_) queue_->releaseBackground();
}

RenderQueue::BackgroundPlace RenderQueue::acquireBackground(std::chrono::milliseconds patience,
                                                            const std::function<bool()>& cancelled) {
  const auto end = std::chrono::steady_clock::now() + patience;
  std::unique_lock lock(mutex_);
  const auto mayGo = [&] {
    if (background_) return false;
    return (running_.empty() && waiting_.empty()) || std::chrono::steady_clock::now() >= end;
  };
  while (!mayGo()) {
    if (cancelled()) throw Error(ErrorKind::Cancelled, "cancelled while it waited for requests to end");
    wake_.wait_for(lock, kPoll);
  }
  background_ = true;
  return BackgroundPlace(this);
}

void RenderQueue::releaseBackground() noexcept {
  const std::lock_guard lock(mutex_);
  background_ = false;
  wake_.notify_all();
}

bool RenderQueue::makeRoomFor(const std::string& client) {
  std::map<std::string_view, std::size_t> waits;
  for (const Ticket& ticket : waiting_)
    ++waits[ticket.client];
  if (waits.empty()) return false;
  const auto most = std::max_element(waits.begin(), waits.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  // With one more of its own the newcomer must still have fewer, or both would displace each other.
  if (waits[client] + 1 >= most->second) return false;
  const auto last = std::find_if(waiting_.rbegin(), waiting_.rend(),
                                 [&](const Ticket& ticket) { return ticket.client == most->first; });
  last->phase = Ticket::Phase::Displaced;
  displaced_.splice(displaced_.end(), waiting_, std::next(last).base());
  wake_.notify_all();
  return true;
}

void RenderQueue::grantNext() noexcept {
  if (running_.size() >= slots_ || waiting_.empty()) return;
  const auto held = [this](const Ticket& waiter) {
    return std::count_if(running_.begin(), running_.end(),
                         [&](const Ticket& holder) { return holder.client == waiter.client; });
  };
  // Of equals the first to come: min_element keeps the earliest.
  const auto next = std::min_element(waiting_.begin(), waiting_.end(),
                                     [&](const Ticket& a, const Ticket& b) { return held(a) < held(b); });
  next->phase = Ticket::Phase::Granted;
  running_.splice(running_.end(), waiting_, next);
  wake_.notify_all();
}

void RenderQueue::release(Tickets::iterator ticket, double seconds) noexcept {
  const std::lock_guard lock(mutex_);
  running_.erase(ticket);
  meanSeconds_ += 0.1 * (seconds - meanSeconds_);
  grantNext();
  if (running_.empty()) wake_.notify_all(); // who waits in the background
}

int RenderQueue::retryAfterSeconds() const {
  const double seconds = meanSeconds_ * static_cast<double>(waiting_.size() + 1) / slots_;
  return std::clamp(static_cast<int>(std::ceil(seconds)), 1, kLongestRetrySeconds);
}

RenderQueue::State RenderQueue::state() const {
  const std::lock_guard lock(mutex_);
  return {slots_,      static_cast<unsigned>(running_.size()),
          places_,     static_cast<unsigned>(waiting_.size()),
          background_, retryAfterSeconds()};
}

} // namespace chamfer::http
