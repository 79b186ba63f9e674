#include "common/text.h"
#include "server/http/routes/problem.h"
#include "server/http/routes/routes.h"
#include "server/http/routes/scene_json.h"
#include "server/render/request/render_words.h"

namespace chamfer::http {

Response scenesRoute(const Parts& parts, const Request& request) {
  const std::string root = parts.catalogue.root().string();
  std::string body = "[";
  for (const auto& entry : parts.catalogue.list()) {
    if (body.size() > 1) body += ",\n";
    body += sceneSummaryJson(*entry, root);
  }
  return cacheable(request, body + "]\n", "application/json", "no-cache");
}

Response sceneRoute(const Request& request, const CatalogueEntry& entry, const std::string& root) {
  readyScene(entry);
  return cacheable(request, sceneDetailJson(entry, root) + "\n", "application/json", "no-cache");
}

Response redirectToId(const Request& request, const Scene& scene, const std::string& rest) {
  std::string location = "/v1/scenes/" + scene.id.hex() + '/' + rest;
  if (!request.query.empty()) location += '?' + request.query;
  Response response;
  response.status = 307;
  response.headers.emplace_back("Location", std::move(location));
  response.headers.emplace_back("Cache-Control", "no-store"); // the name may stand for another scene soon
  return response;
}

std::shared_ptr<const Scene> readyScene(const CatalogueEntry& entry) {
  if (entry.state == SceneState::Ready) return entry.scene;
  if (entry.state == SceneState::Loading) throw ProblemError(busy("the scene is being loaded", 1));
  // Whatever the fault is, it is the files' on the server, not the request's.
  Problem problem;
  problem.status = httpStatus(ErrorKind::StaleSidecar);
  problem.kind = errorWord(entry.fault);
  problem.detail = "scene \"" + entry.name + "\" is " + sceneStateWord(entry.state) + ": " + entry.error;
  throw ProblemError(problem);
}

std::shared_ptr<const PreparedScene> preparedFor(const Parts& parts,
                                                 const std::shared_ptr<const Scene>& scene,
                                                 const RoundingChoice& choice,
                                                 const Cancellation& cancelled) {
  try {
    return parts.cache.get(scene, choice, cancelled);
  } catch (const Error& error) {
    Problem problem = problemOf(error, parts.catalogue.root().string());
    if (error.kind() == ErrorKind::OutOfRange) { // an explicit mesh of too many triangles
      problem.parameter = "rounding";
      problem.value = roundingWord(choice);
      for (const auto& [key, value] : error.details())
        if (key == "largest_segments")
          problem.limits = "{\"maximum\":" + exactNumberText(value) + ",\"unit\":\"segments\"}";
      throw ProblemError(problem);
    }
    if (error.kind() != ErrorKind::RadiusTooLarge || !choice.radius) throw;
    problem.parameter = "radius";
    problem.value = exactNumberText(*choice.radius);
    if (const double max = radiusRange(*scene).max; max > 0)
      problem.limits = "{\"above\":0,\"below\":" + exactNumberText(max) + ",\"unit\":\"mesh units\"}";
    throw ProblemError(problem);
  }
}

} // namespace chamfer::http
