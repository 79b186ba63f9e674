// A request and its answer, as routes see them. No HTTP library is known here, so that routes can be tested
// without sockets; connection_loop.h and http_server.h move these across a real connection.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace chamfer::http {

/// Field names are lower case in requests.
using Headers = std::vector<std::pair<std::string, std::string>>;

/// Says whether the work behind a request has lost its purpose. Copies share the client's flag.
struct Cancellation {
  std::shared_ptr<std::atomic<bool>> clientGone = std::make_shared<std::atomic<bool>>(false);
  std::shared_ptr<std::atomic<bool>> shuttingDown = std::make_shared<std::atomic<bool>>(false);
  std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();

  bool pastDeadline() const { return std::chrono::steady_clock::now() >= deadline; }
  bool operator()() const {
    return clientGone->load(std::memory_order_relaxed) || shuttingDown->load(std::memory_order_relaxed) ||
           pastDeadline();
  }
};

struct Request {
  std::string method; ///< upper case
  std::string path;   ///< as sent: percent-encoded, without the query
  std::string query;  ///< as sent, without '?'
  Headers headers;    ///< names in lower case, values without surrounding blanks
  std::string body;
  std::string client; ///< the peer's address, for fair sharing and the log
  std::string id;     ///< of the request; filled by the service
  Cancellation cancelled;

  /// First value of a header (name in lower case); nullptr when there is none.
  const std::string* header(std::string_view name) const {
    for (const auto& [key, value] : headers)
      if (key == name) return &value;
    return nullptr;
  }
};

struct Response {
  int status = 200;
  Headers headers; ///< without Content-Type and Content-Length
  std::string contentType;
  std::string body;
  bool close = false; ///< close the connection after it

  const std::string* header(std::string_view name) const {
    for (const auto& [key, value] : headers)
      if (key == name) return &value;
    return nullptr;
  }
};

} // namespace chamfer::http
