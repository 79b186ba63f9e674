// Admission to rendering: a number of slots, and a bounded number of requests that wait for one. A freed slot
// goes to the client that holds the fewest, and where all places are taken the client with the most of them
// gives one up, so that one client with many requests does not shut out the others.
//
// Work in the background (jobs) has a place of its own beside the slots, and takes none from requests: it is
// let in while nothing is rendered and nothing waits, or after some patience, so that it does not starve.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <list>
#include <mutex>
#include <string>
#include <utility>

namespace chamfer::http {

class RenderQueue {
  /// One request that waits for a slot or has it.
  struct Ticket {
    std::string client;
    enum class Phase : std::uint8_t { Waiting, Granted, Displaced } phase = Phase::Waiting;
  };
  using Tickets = std::list<Ticket>;

public:
  RenderQueue(unsigned slots, unsigned waiting);

  /// Holds a slot until it is destroyed.
  class Slot {
  public:
    Slot(Slot&& other) noexcept : queue_(other.queue_), ticket_(other.ticket_), since_(other.since_) {
      other.queue_ = nullptr;
    }
    Slot(const Slot&) = delete;
    Slot& operator=(const Slot&) = delete;
    ~Slot();

  private:
    friend class RenderQueue;
    Slot(RenderQueue* queue, Tickets::iterator ticket) noexcept : queue_(queue), ticket_(ticket) {}
    RenderQueue* queue_;
    Tickets::iterator ticket_;
    std::chrono::steady_clock::time_point since_ = std::chrono::steady_clock::now();
  };

  /// Blocks until a slot is free. Throws ProblemError, both with Retry-After: 503 when too many wait already,
  /// 429 when this client has more waiting than others and one of those needs the place; and Error(Cancelled)
  /// within a tenth of a second after `cancelled` has turned true.
  Slot acquire(const std::string& client, const std::function<bool()>& cancelled);

  /// The one place for work in the background, until it is destroyed.
  class BackgroundPlace {
  public:
    BackgroundPlace(BackgroundPlace&& other) noexcept : queue_(std::exchange(other.queue_, nullptr)) {}
    BackgroundPlace(const BackgroundPlace&) = delete;
    BackgroundPlace& operator=(const BackgroundPlace&) = delete;
    ~BackgroundPlace();

  private:
    friend class RenderQueue;
    explicit BackgroundPlace(RenderQueue* queue) noexcept : queue_(queue) {}
    RenderQueue* queue_;
  };
  /// Blocks until nothing is rendered and nothing waits, `patience` at most, and until the place is free.
  /// What is done with it should be short and of low priority: requests do not wait for it, they take the
  /// cores from it. Throws Error(Cancelled) as acquire().
  BackgroundPlace acquireBackground(std::chrono::milliseconds patience,
                                    const std::function<bool()>& cancelled);

  struct State {
    unsigned slots, running, places, waiting;
    bool background;       ///< work in the background goes on
    int retryAfterSeconds; ///< estimate of when a slot will be free for one more
  };
  State state() const;

private:
  bool makeRoomFor(const std::string& client);
  void grantNext() noexcept;
  void release(Tickets::iterator ticket, double seconds) noexcept;
  void releaseBackground() noexcept;
  int retryAfterSeconds() const;

  const unsigned slots_, places_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  // A ticket is made by who comes, and moves from list to list without taking memory: to grant a slot and to
  // give it back cannot fail.
  Tickets waiting_; ///< in order of arrival
  Tickets running_;
  Tickets displaced_; ///< whoever waits behind one has not been told yet
  bool background_ = false;
  double meanSeconds_ = 0.1; ///< moving mean of how long a slot is held
};

} // namespace chamfer::http
