#include "server/http/comparisons/comparisons.h"
#include "server/http/routes/routes.h"
#include "server/http/schema/limits.h"
#include "server/http/schema/openapi.h"
#include "server/http/version.h"
#include "server/render/request/parameters.h"
#include "server/render/surface/rounded_mesh.h"
#include "server/render/tracing/tracer.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace chamfer::http {
namespace {

using Json = nlohmann::ordered_json;

Json parameterJson(const ParameterRow& row) {
  Json json{{"name", row.name}, {"where", row.where}, {"kind", kindWord(row.kind)}};
  json["default"] = row.fallback.empty() ? Json() : Json(row.fallback);
  json["limits"] = Json::parse(limitsJson(row));
  if (!row.about.empty()) json["about"] = row.about;
  return json;
}

} // namespace

Response openApiRoute(const Parts& parts, const Request& request) {
  const Json document = openApiDocument(!parts.options.keys.empty());
  return cacheable(request, document.dump(1) + "\n", "application/json", "no-cache");
}

Response infoRoute(const Parts& parts, const Comparisons* comparisons, const Request& request) {
  const RenderQueue::State queue = parts.queue.state();
  const PreparedCache::State cache = parts.cache.state();
  Json info{{"name", "chamferd"}, {"version", kVersion}, {"ray_instruction_set", rayInstructionSet()}};
  info["formats"] = {{"tiles", {"f16", "exr", "png"}}, {"frames", {"exr", "png"}}};
  for (const LimitRow& row : limitRows())
    info["limits"][row.name] = row.value;
  info["limits"]["deadline_seconds"] = std::chrono::duration<double>(parts.options.deadline).count();
  info["limits"]["connections"] = parts.options.connections;
  info["limits"]["explicit_triangles"] =
      std::min<std::uint64_t>(kMostRoundedTriangles, cache.limit / kBytesPerRoundedTriangle);
  info["parameters"] = Json::array();
  for (const ParameterRow& row : parameterRows())
    info["parameters"].push_back(parameterJson(row));
  info["queue"] = {{"slots", queue.slots},
                   {"running", queue.running},
                   {"places", queue.places},
                   {"waiting", queue.waiting},
                   {"retry_after_seconds", queue.retryAfterSeconds}};
  info["prepared_scenes"] = {{"count", cache.entries},     {"bytes", cache.bytes},
                             {"limit_bytes", cache.limit}, {"hits", cache.hits},
                             {"builds", cache.builds},     {"evictions", cache.evictions}};
  info["comparisons"] = nullptr;
  if (comparisons) {
    const Comparisons::State jobs = comparisons->state();
    info["comparisons"] = {{"queued", jobs.queued},
                           {"running", jobs.running},
                           {"places", jobs.places},
                           {"limit_bytes", jobs.limitBytes}};
  }
  return cacheable(request, info.dump() + "\n", "application/json", "no-store");
}

} // namespace chamfer::http
