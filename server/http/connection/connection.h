// One connection of connection_loop.h: its socket, its phase, and the bytes on their way.
#pragma once

#include "server/http/connection/request_head.h"

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

namespace chamfer::http {

using Clock = std::chrono::steady_clock;

enum class State : std::uint8_t { ReadingHead, ReadingBody, Handling, Writing, Lingering };

struct Connection {
  int socket = -1;
  std::uint64_t serial = 0; ///< names it in events, so that a reused descriptor is never taken for it
  std::string peer;
  State state = State::ReadingHead;
  Clock::time_point deadline = Clock::time_point::max();
  std::string in;          ///< read and not yet used
  std::size_t scanned = 0; ///< bytes of `in` without the end of a head
  RequestHead head;
  std::size_t reserved = 0; ///< bytes of the body, counted in Loop::bodyBytes_
  std::string out;
  std::size_t sent = 0;
  bool closeAfter = false;
  std::shared_ptr<std::atomic<bool>> clientGone;

  Connection() = default;
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection();
};

/// Makes an accepted socket non-blocking, without delay, and able to notice that its peer has vanished.
void configureSocket(int socket);
/// The peer's numeric address, "unknown" when it is gone already.
std::string addressOf(int socket);

} // namespace chamfer::http
