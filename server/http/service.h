// The service behind the connections: finds the route, lets in whom it should, turns every error into its
// answer, adds what all answers carry, and writes the request log.
#pragma once

#include "server/http/problem.h"
#include "server/http/routes.h"

#include <atomic>
#include <memory>

namespace chamfer::http {

class Service {
public:
  Service(ServiceOptions options, const Catalogue& catalogue, StaticFiles files);

  /// As RequestHandler in http_server.h. Any thread; does not throw.
  Response answer(Request& request, const Problem* refusal = nullptr);

  /// From now on not ready, and no new work is taken; what is under way goes on.
  void drain() { draining_ = true; }
  /// Ends what is under way.
  void cancelAll() { *shuttingDown_ = true; }
  /// Threads that can be blocked by rendering and waiting for it.
  unsigned blockingRequests() const { return options_.slots + options_.waiting; }

private:
  Response route(const Request& request);
  Response sceneResource(const Request& request, std::span<const std::string_view> segments);
  Response ready() const;
  void checkHost(const Request& request) const;
  void checkKey(const Request& request) const;
  std::string newRequestId();

  const ServiceOptions options_;
  const Catalogue& catalogue_;
  const StaticFiles files_;
  PreparedCache cache_;
  RenderQueue queue_;
  const Parts parts_;
  std::atomic<bool> draining_ = false;
  const std::shared_ptr<std::atomic<bool>> shuttingDown_ = std::make_shared<std::atomic<bool>>(false);
  std::atomic<std::uint64_t> requests_;
};

} // namespace chamfer::http
