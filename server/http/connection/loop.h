// The inside of connection_loop.h. loop.cpp: the thread, who comes and who has to go; exchange.cpp: what
// happens on one connection.
#pragma once

#include "server/http/connection/connection.h"
#include "server/http/connection/connection_loop.h"
#include "server/http/connection/worker_pool.h"

#include <condition_variable>
#include <list>
#include <mutex>
#include <thread>
#include <unordered_map>

namespace chamfer::http {

class ConnectionLoop::Loop {
public:
  Loop(const ConnectionLimits& limits, Dispatch dispatch, Screen screen);
  ~Loop();
  void listen(int socket);
  void stopListening();
  void stop();
  ConnectionCounts counts() const { return {open_, busy_, accepted_, dropped_}; }

private:
  /// One request on its way through a worker. Made as a list of one, so that handing it back takes no memory.
  struct Exchange {
    std::uint64_t serial = 0;
    RawRequest request{};
    RawAnswer answer{};
  };

  // loop.cpp
  void wake();
  void run();
  void onEvent(std::uint64_t serial, std::uint32_t events);
  void takeMessages();
  void takeListener();
  void acceptAll(int most);
  void armListener();
  void open(int socket);
  void close(Connection& c);
  void drop(Connection& c);
  void sweep();
  Connection* longestIdle();
  bool makeRoomFor(const std::string& peer);
  bool closeOldestWriting(const Connection& but);
  Connection* find(std::uint64_t serial);
  /// Runs `action`; where memory fails it, that connection is dropped and the rest goes on.
  template <class Action>
  void guarded(std::uint64_t serial, Action&& action);

  // exchange.cpp. Each of the void ones may close the connection and is the last thing done with it.
  void enter(Connection& c, State state);
  void arm(Connection& c, std::uint32_t events);
  void onEvent(Connection& c, std::uint32_t events);
  void readMore(Connection& c);
  void advance(Connection& c);
  bool beginBody(Connection& c);
  bool holdBody(Connection& c);
  Connection* largestHolder();
  void handle(Connection& c);
  void refuse(Connection& c, const Problem& problem);
  void beginWriting(Connection& c, RawAnswer answer);
  void writeMore(Connection& c);
  void discardMore(Connection& c);
  void onDeadline(Connection& c);

  const ConnectionLimits limits_;
  const Dispatch dispatch_;
  const Screen screen_;
  const int epoll_, wake_;
  std::atomic<bool> stopping_ = false;
  std::atomic<std::size_t> busy_ = 0, open_ = 0;
  std::atomic<std::uint64_t> accepted_ = 0, dropped_ = 0;

  std::mutex mutex_; ///< guards these four
  std::condition_variable listenerClosed_;
  int wantedListener_ = -1; ///< from listen(), to be watched
  bool wantListening_ = false;
  std::list<Exchange> completions_;

  // The loop's thread only.
  int listener_ = -1;
  bool acceptPaused_ = false; ///< for want of descriptors or memory, until the next sweep
  std::unordered_map<std::uint64_t, std::unique_ptr<Connection>> connections_;
  std::uint64_t lastSerial_ = 1;
  std::size_t bodyBytes_ = 0, answerBytes_ = 0;

  std::unique_ptr<WorkerPool> pool_;
  std::thread thread_;
};

} // namespace chamfer::http
