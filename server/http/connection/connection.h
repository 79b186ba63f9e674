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
  std::string peer;         ///< address of the other end
  std::string client;       ///< whose request is being read or handled: the peer's, or whom a proxy names
  State state = State::ReadingHead;
  Clock::time_point deadline = Clock::time_point::max();
  std::string in;          ///< read and not yet used
  std::size_t scanned = 0; ///< bytes of `in` without the end of a head
  RequestHead head;
  std::size_t held = 0; ///< bytes of the body that are here, counted in Loop::bodyBytes_
  std::string out;
  std::size_t sent = 0, delivered = 0; ///< of `out`: given to the kernel, and of these taken by the client
  bool closeAfter = false;
  std::shared_ptr<std::atomic<bool>> clientGone;

  Connection() = default;
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection();

  bool reading() const { return state == State::ReadingHead || state == State::ReadingBody; }
  bool idle() const { return state == State::ReadingHead && in.empty(); }
  /// `bytes` more went over the line: `patience` from now at the longest, less for a client that stays below
  /// `bytesPerSecond`.
  void progressed(std::size_t bytes, std::chrono::milliseconds patience, std::size_t bytesPerSecond);
};

/// Makes an accepted socket send without delay and notice that its peer has vanished.
void configureSocket(int socket);
/// The peer's numeric address, "unknown" when it is gone already.
std::string addressOf(int socket);
/// Bytes given to the kernel that the peer has not confirmed.
std::size_t unconfirmedBytes(int socket);

} // namespace chamfer::http
