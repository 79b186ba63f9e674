// A small HTTP client on raw sockets: sends exactly the bytes it is told to, right or wrong.
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace chamfer::test {

struct Reply {
  int status = 0;
  std::map<std::string, std::string> headers; ///< names in lower case
  std::string body;
  std::string header(const std::string& name) const {
    const auto found = headers.find(name);
    return found == headers.end() ? "" : found->second;
  }
};

/// One connection to 127.0.0.1, from `local`, another loopback address, where one is given. Throws
/// std::runtime_error when it cannot be made.
class Connection {
public:
  explicit Connection(int port, const char* local = nullptr);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// False when the server has closed.
  bool send(std::string_view bytes);
  /// The next answer; nothing when the server closes or is silent for `patience`. `head`: it has no body.
  std::optional<Reply> receive(bool head = false,
                               std::chrono::milliseconds patience = std::chrono::seconds(30));
  /// The same, taking at most `bytesPerSecond` off the line.
  std::optional<Reply> receiveSlowly(std::size_t bytesPerSecond);
  /// Is there something to receive within `patience`? Takes none of it.
  bool readable(std::chrono::milliseconds patience) const;
  /// Has the server closed, or does it within `patience`?
  bool closedWithin(std::chrono::milliseconds patience);
  /// Sends a reset instead of a farewell.
  void abort();
  void finishSending();

private:
  bool fill(std::chrono::milliseconds patience);
  int socket_ = -1;
  std::size_t bytesPerSecond_ = 0; ///< 0: as they come
  std::string buffer_;
};

std::string requestText(const std::string& method, const std::string& target, const std::string& headers = "",
                        const std::string& body = "");
/// One request on a connection of its own. A missing answer has status 0.
Reply get(int port, const std::string& target, const std::string& headers = "");
Reply head(int port, const std::string& target, const std::string& headers = "");
Reply post(int port, const std::string& target, const std::string& body,
           const std::string& contentType = "application/json");
/// Sends `bytes` as they are.
Reply raw(int port, const std::string& bytes);

} // namespace chamfer::test
