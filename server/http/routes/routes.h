// What each resource answers. Routes are free functions of the server's parts and a request; they throw
// ProblemError and chamfer::Error, which service.cpp turns into answers.
#pragma once

#include "server/http/catalogue/catalogue.h"
#include "server/http/catalogue/prepared_cache.h"
#include "server/http/comparisons/job_options.h"
#include "server/http/connection/message.h"
#include "server/http/monitoring/metrics.h"
#include "server/http/queue/render_queue.h"
#include "server/http/routes/route_table.h"
#include "server/http/routes/static_files.h"

#include <chrono>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace chamfer::http {

struct ServiceOptions {
  unsigned threads = 0;                          ///< of each render; 0: all cores
  unsigned slots = 2;                            ///< requests rendered at one time
  unsigned waiting = 64;                         ///< requests that may wait for a slot
  std::size_t cacheBytes = std::size_t{1} << 30; ///< of prepared scenes
  std::chrono::milliseconds deadline{120'000};   ///< of one request; then 504
  std::vector<std::string> keys{};               ///< that /v1 asks for; empty: none is asked for
  std::vector<std::string> hosts{};              ///< names in Host that are answered; empty: all
  unsigned connections = 512;
  bool behindProxy = false; ///< X-Forwarded-For is a proxy's word for who the client is
  JobOptions jobs{};
};

class Comparisons;

/// The parts that routes work with; owned by the Service.
struct Parts {
  const ServiceOptions& options;
  const Catalogue& catalogue;
  const StaticFiles& files;
  PreparedCache& cache;
  RenderQueue& queue;
  Metrics& metrics;
};

/// Cache-Control of what a scene's id in the URL makes a function of the URL; where keys are asked for, the
/// service makes it private.
inline constexpr const char* kForever = "public, max-age=31536000, immutable";

/// GET /v1/openapi.json
Response openApiRoute(const Parts& parts, const Request& request);
/// GET /v1/info
Response infoRoute(const Parts& parts, const Comparisons* comparisons, const Request& request);
/// GET /v1/scenes
Response scenesRoute(const Parts& parts, const Request& request);
/// GET /v1/scenes/{scene}
Response sceneRoute(const Request& request, const CatalogueEntry& entry, const std::string& root);
/// GET /v1/scenes/{scene}/tiles/... and /frames/...; `segments`: what follows that word, still encoded.
/// `scene`: what the client called the scene; a name is redirected to the id it stands for now.
Response tileRoute(const Parts& parts, const Request& request, const CatalogueEntry& entry,
                   const std::string& scene, std::span<const std::string_view> segments);
Response frameRoute(const Parts& parts, const Request& request, const CatalogueEntry& entry,
                    const std::string& scene, std::span<const std::string_view> segments);
/// GET /v1/scenes/{scene}/preview.glb; `scene` as for tiles.
Response previewRoute(const Parts& parts, const Request& request, const CatalogueEntry& entry,
                      const std::string& scene);
/// POST /v1/scenes/{scene}/rays
Response raysRoute(const Parts& parts, const Request& request, const CatalogueEntry& entry);
/// Everything under /v1/comparisons; `comparisons`: nullptr: the server takes none.
Response comparisonRoute(Comparisons* comparisons, const RouteRow& row, const Request& request);
/// GET of the page's files. Throws ProblemError (404).
Response fileRoute(const StaticFiles& files, const Request& request, const std::string& path);

/// The scene of a ready entry. Throws ProblemError: 503 while it loads, 409 with its fault when it cannot be
/// used.
std::shared_ptr<const Scene> readyScene(const CatalogueEntry& entry);

/// The scene with that rounding, from the cache or built now. As PreparedCache::get(); a radius too large is
/// a ProblemError (422) with the limits.
std::shared_ptr<const PreparedScene> preparedFor(const Parts& parts,
                                                 const std::shared_ptr<const Scene>& scene,
                                                 const RoundingChoice& choice, const Cancellation& cancelled);

/// 307 to the same resource of the scene's id. `rest`: the path below the scene, still encoded.
Response redirectToId(const Request& request, const Scene& scene, const std::string& rest);
/// An answer without its body yet: ETag `etag` (with its quotes) and Cache-Control; 304 when the client has
/// it already. Throws ProblemError (412) when If-Match asks for another one.
Response taggedAnswer(const Request& request, const std::string& etag, const char* contentType,
                      const char* cacheControl);
/// Throws ProblemError (415) unless the body says that it is JSON.
void requireJson(const Request& request);
/// 200 with `body`, or 304 when the client has it already. The ETag is the body's digest.
Response cacheable(const Request& request, std::string body, const char* contentType,
                   const char* cacheControl);
/// Does If-None-Match name `etag` (with its quotes)?
bool clientHas(const Request& request, std::string_view etag);
/// Of a resource without ETags. Throws ProblemError (412) when If-Match asks for one.
void checkUntagged(const Request& request);

} // namespace chamfer::http
