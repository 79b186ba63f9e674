// Admission to rendering: a number of slots, and a bounded number of requests that wait for one. A freed slot
// goes to the client that holds the fewest, and where all places are taken the client with the most of them
// gives one up, so that one client with many requests does not shut out the others.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <list>
#include <map>
#include <mutex>
#include <string>

namespace chamfer::http {

class RenderQueue {
public:
  RenderQueue(unsigned slots, unsigned waiting);

  /// Holds a slot until it is destroyed.
  class Slot {
  public:
    Slot(Slot&& other) noexcept
        : queue_(other.queue_), client_(std::move(other.client_)), since_(other.since_) {
      other.queue_ = nullptr;
    }
    Slot(const Slot&) = delete;
    Slot& operator=(const Slot&) = delete;
    ~Slot();

  private:
    friend class RenderQueue;
    Slot(RenderQueue* queue, std::string client);
    RenderQueue* queue_;
    std::string client_;
    std::chrono::steady_clock::time_point since_;
  };

  /// Blocks until a slot is free. Throws ProblemError, both with Retry-After: 503 when too many wait already,
  /// 429 when this client has more waiting than others and one of those needs the place; and Error(Cancelled)
  /// within a tenth of a second after `cancelled` has turned true.
  Slot acquire(const std::string& client, const std::function<bool()>& cancelled);

  struct State {
    unsigned slots, running, places, waiting;
    int retryAfterSeconds; ///< estimate of when a slot will be free for one more
  };
  State state() const;

private:
  struct Waiter {
    std::string client;
    bool granted = false, displaced = false;
  };
  bool makeRoomFor(const std::string& client);
  void grantNext();
  void release(const std::string& client, double seconds);
  int retryAfterSeconds() const;

  const unsigned slots_, places_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  unsigned running_ = 0;
  std::list<Waiter*> waiting_;            ///< in order of arrival
  std::map<std::string, unsigned> holds_; ///< slots by client; only clients that hold some
  double meanSeconds_ = 0.1;              ///< moving mean of how long a slot is held
};

} // namespace chamfer::http
