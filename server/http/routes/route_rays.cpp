// A batch of rays, against the scene's own instances.
#include "server/http/routes/problem.h"
#include "server/http/routes/ray_list.h"
#include "server/http/routes/routes.h"

#include <algorithm>
#include <atomic>
#include <thread>

namespace chamfer::http {
namespace {

/// Rays traced between two looks at the cancellation; also the least work worth another thread.
constexpr std::size_t kChunk = 1024;

/// `hits[i]` answers `list.rays[i]`. Throws Error(Cancelled).
void trace(const Tracer& tracer, const RayList& list, std::vector<std::optional<TraceHit>>& hits,
           unsigned threads, const Cancellation& cancelled) {
  std::atomic<std::size_t> next = 0;
  std::atomic<bool> stopped = false;
  const auto work = [&] {
    for (;;) {
      const std::size_t begin = next.fetch_add(kChunk);
      if (begin >= list.rays.size()) return;
      if (stopped || cancelled()) {
        stopped = true;
        return;
      }
      const std::size_t end = std::min(begin + kChunk, list.rays.size());
      for (std::size_t i = begin; i < end; ++i)
        hits[i] = tracer.intersect(list.rays[i], tracer.stateAt(list.rays[i].at(list.tnear)), list.tnear);
    }
  };
  const std::size_t useful = (list.rays.size() + kChunk - 1) / kChunk;
  const std::size_t cores = threads > 0 ? threads : std::max(1u, std::thread::hardware_concurrency());
  std::vector<std::jthread> others;
  for (std::size_t i = 1; i < std::min(useful, cores); ++i)
    others.emplace_back(work);
  work();
  others.clear(); // joins
  if (stopped) throw Error(ErrorKind::Cancelled, "cancelled while its rays were traced");
}

} // namespace

Response raysRoute(const Parts& parts, const Request& request, const CatalogueEntry& entry) {
  requireJson(request);
  if (!request.query.empty())
    throw ProblemError(badRequest(
        "this resource takes no query; rounding, radius, radius_clamp and tnear are keys of the body"));
  const auto scene = readyScene(entry);
  const RayList list = parseRayList(request.body);

  const RenderQueue::Slot slot = parts.queue.acquire(request.client, request.cancelled);
  const auto ready = preparedFor(parts, scene, list.rounding, request.cancelled);
  std::vector<std::optional<TraceHit>> hits(list.rays.size());
  trace(ownTracer(*ready), list, hits, parts.options.threads, request.cancelled);

  RayCount count{.traced = hits.size()};
  for (const std::optional<TraceHit>& hit : hits) {
    count.hits += hit.has_value();
    count.rounded += hit && hit->rounded();
  }
  parts.metrics.tracedBatch(count);

  Response response;
  response.contentType = "application/json";
  response.headers.emplace_back("Cache-Control", "no-store");
  response.headers.emplace_back("X-Chamfer-Rays", std::to_string(hits.size()));
  response.headers.emplace_back("X-Chamfer-Rounded", std::to_string(count.rounded));
  response.body = printHits(hits);
  return response;
}

} // namespace chamfer::http
