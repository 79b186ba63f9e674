// The socket side of chamferd: binds, accepts, and exchanges requests for answers. The HTTP library
// (cpp-httplib) is known in http_server.cpp only.
#pragma once

#include "server/http/connection/connection_loop.h"
#include "server/http/connection/message.h"

#include <functional>
#include <memory>
#include <string>

namespace chamfer::http {

/// Answers a request; called from many threads at once. Must not throw. `refusal`: what is wrong with the
/// request already, to be answered as it is.
using RequestHandler = std::function<Response(Request& request, const Problem* refusal)>;
/// Looks at a request whose body has not been read yet, on the thread of all connections: returns why the
/// body is not wanted, and puts `request.client` right. Must not throw, nor take long.
using RequestScreen = std::function<std::optional<Problem>(Request& request)>;

class HttpServer {
public:
  HttpServer(const ConnectionLimits& limits, RequestHandler handler, RequestScreen screen = {});
  /// Stops as stop() does, without waiting.
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// Binds to `host` (an address or a name) and `port` (0: any free one) and starts to answer. Returns the
  /// port. Throws Error(Usage) when the address cannot be bound.
  int start(const std::string& host, int port);
  /// Accepts no more connections, waits up to `grace` for the answers that are under way, closes the rest.
  void stop(std::chrono::milliseconds grace);
  /// None once it has stopped.
  ConnectionCounts counts() const;

private:
  class Library;
  std::unique_ptr<Library> library_;
};

} // namespace chamfer::http
