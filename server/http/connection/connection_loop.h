// Every connection of the server, watched by one thread: reads whole requests, hands them to worker threads,
// writes the answers, and notices when a client goes away meanwhile. A slow, idle or silent client costs a
// file descriptor and some bytes, never a thread. What a request means is not known here.
//
//   ReadingHead -> (ReadingBody) -> Handling -> Writing -> ReadingHead | Lingering -> closed
//
// Every phase has a deadline. Everything but adopt(), stop() and the workers' completions happens on the
// loop's thread.
#pragma once

#include "server/http/connection/request_head.h"

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace chamfer::http {

struct ConnectionLimits {
  std::size_t connections = 512;      ///< beyond: the longest idle one is closed, or the new one refused
  std::size_t bodyBytes = 256u << 20; ///< of all bodies that are read or handled at one time
  std::size_t answerBytes = std::size_t{1}
                            << 30; ///< of all answers that wait to be read; beyond, the oldest is dropped
  unsigned workers = 8;            ///< threads that handle requests
  std::size_t pending = 256;       ///< requests that wait for such a thread
  std::chrono::milliseconds idle{15'000};     ///< between requests
  std::chrono::milliseconds head{5'000};      ///< from a head's first byte to its last
  std::chrono::milliseconds transfer{10'000}; ///< for a body or an answer, and more by its size:
  std::size_t bytesPerSecond = 64u << 10;     ///< the slowest transfer that is still waited for
};

struct ConnectionCounts {
  std::size_t open = 0;
  std::size_t busy = 0;       ///< requests being handled and answers being written now
  std::uint64_t accepted = 0; ///< since the start
  std::uint64_t dropped = 0;  ///< of these, closed for want of room or because their client read too slowly
};

/// A complete request, or the reason why there is none.
struct RawRequest {
  RequestHead head;
  std::string body;
  std::string peer;
  std::shared_ptr<std::atomic<bool>> clientGone;
  std::optional<Problem> refusal; ///< answer with this; head may be empty
};

struct RawAnswer {
  std::string bytes;
  bool close = false;
};

class ConnectionLoop {
public:
  /// Turns a request into the bytes of its answer; called on worker threads, for refusals on the loop's. Must
  /// not throw.
  using Dispatch = std::function<RawAnswer(RawRequest&)>;

  ConnectionLoop(const ConnectionLimits& limits, Dispatch dispatch);
  /// As stop().
  ~ConnectionLoop();
  ConnectionLoop(const ConnectionLoop&) = delete;
  ConnectionLoop& operator=(const ConnectionLoop&) = delete;

  /// Closes every connection, and waits for the requests being handled. Nothing may be adopted from then on.
  void stop();
  /// Takes over an accepted socket. Any thread.
  void adopt(int socket);
  /// Any thread.
  ConnectionCounts counts() const;

private:
  class Loop;
  std::unique_ptr<Loop> loop_;
};

} // namespace chamfer::http
