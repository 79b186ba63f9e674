// The service behind the connections: finds the route, lets in whom it should, turns every error into its
// answer, adds what all answers carry, and writes the request log.
#pragma once

#include "server/http/comparisons/comparisons.h"
#include "server/http/connection/connection_loop.h"
#include "server/http/routes/problem.h"
#include "server/http/routes/route_table.h"
#include "server/http/routes/routes.h"

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

namespace chamfer::http {

class Service {
public:
  Service(ServiceOptions options, const Catalogue& catalogue, StaticFiles files);

  /// As RequestHandler in http_server.h. Any thread; does not throw.
  Response answer(Request& request, const Problem* refusal = nullptr);
  /// As RequestScreen in http_server.h: what answer() would refuse whatever the body is, for its host, its
  /// site, its key, its path or its method.
  std::optional<Problem> screen(Request& request) const;

  /// How connections stand, for the metrics; without one, there are none. Before the first request.
  void observeConnections(std::function<ConnectionCounts()> counts) { connections_ = std::move(counts); }
  /// From now on not ready, and answers end their connections, so that balancers turn elsewhere; work is
  /// still taken. The job under way stops at once; it goes on with the next start.
  void announceEnd();
  /// The same, and no new work is taken; what is under way goes on.
  void drain() {
    announceEnd();
    draining_ = true;
  }
  /// Ends what is under way.
  void cancelAll() { *shuttingDown_ = true; }
  /// Threads that can be blocked by rendering, by waiting for it, and by waiting for news of jobs.
  unsigned blockingRequests() const {
    return options_.slots + options_.waiting + (comparisons_ ? kMostWatchers : 0);
  }

private:
  /// Where a request goes.
  struct Target {
    const RouteRow* row;
    std::vector<std::string_view> segments; ///< of the request's path
    SceneMatch match;                       ///< of a row with a scene; its rest lies in `segments`
  };
  /// Throws ProblemError for who may not ask and for what is not there to be asked for, Error(Usage) for a
  /// path with a broken escape. `row`: the request's, as soon as it is known.
  Target admit(const Request& request, const RouteRow*& row) const;
  Response route(const Request& request, const RouteRow*& row);
  Response answerRoute(const RouteRow& row, const Request& request);
  Response answerScene(const SceneMatch& match, const Request& request);
  Response ready() const;
  Response metricsText() const;
  void checkHost(const Request& request) const;
  void checkSite(const Request& request) const;
  void checkKey(const Request& request) const;
  std::string newRequestId();

  const ServiceOptions options_;
  const Catalogue& catalogue_;
  const StaticFiles files_;
  PreparedCache cache_;
  RenderQueue queue_;
  Metrics metrics_;
  const Parts parts_;
  std::function<ConnectionCounts()> connections_;
  std::atomic<bool> ending_ = false, draining_ = false;
  const std::shared_ptr<std::atomic<bool>> shuttingDown_ = std::make_shared<std::atomic<bool>>(false);
  std::atomic<std::uint64_t> requests_;
  std::unique_ptr<Comparisons> comparisons_; ///< none without a folder for them; ends before the parts
};

} // namespace chamfer::http
