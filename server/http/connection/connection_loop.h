// Every connection of the server, watched by one thread: reads whole requests, hands them to worker threads,
// writes the answers, and notices when a client goes away meanwhile. A slow, idle or silent client costs a
// file descriptor and some bytes, never a thread. What a request means is not known here.
//
//   ReadingHead -> (ReadingBody) -> Handling -> Writing -> ReadingHead | Lingering -> closed
//
// Every phase but Handling has a deadline. A body is read only from whom the screen lets in, costs what has
// arrived of it, not what its head promises, and where room is short, whoever holds the most gives way.
// Everything but listen(), stopListening(), stop() and the workers' completions happens on the loop's thread.
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
  std::size_t bodyBytes = 256u << 20; ///< of all bodies that are here, read in part or handled
  std::size_t answerBytes = std::size_t{1}
                            << 30; ///< of all answers that wait to be read; beyond, the oldest is dropped
  unsigned workers = 8;            ///< threads that handle requests
  std::size_t pending = 256;       ///< requests that wait for such a thread
  std::chrono::milliseconds idle{15'000};     ///< between requests
  std::chrono::milliseconds head{5'000};      ///< from a head's first byte to its last
  std::chrono::milliseconds transfer{10'000}; ///< by so much a body or an answer may fall behind
  std::size_t bytesPerSecond = 64u << 10;     ///< the slowest transfer that is waited for without end
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
  /// Looks at a head before its body is read, on the loop's thread: quickly. Returns why the body is not
  /// wanted; puts the name of the client, which is its peer's address, right.
  using Screen = std::function<std::optional<Problem>(const RequestHead&, std::string& client)>;

  ConnectionLoop(const ConnectionLimits& limits, Dispatch dispatch, Screen screen);
  /// As stop().
  ~ConnectionLoop();
  ConnectionLoop(const ConnectionLoop&) = delete;
  ConnectionLoop& operator=(const ConnectionLoop&) = delete;

  /// Takes over a listening socket and accepts from it. Once, from any thread.
  void listen(int socket);
  /// Takes who is waiting to be accepted, then closes the listening socket, before it returns. Any thread.
  void stopListening();
  /// Closes every connection, and waits for the requests being handled.
  void stop();
  /// Any thread.
  ConnectionCounts counts() const;

private:
  class Loop;
  std::unique_ptr<Loop> loop_;
};

} // namespace chamfer::http
