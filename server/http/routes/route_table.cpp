#include "server/http/routes/route_table.h"

#include "common/error.h"
#include "server/render/request/query.h"

#include <algorithm>

namespace chamfer::http {
namespace {

constexpr const char* kRead = "GET, HEAD, OPTIONS";
constexpr const char* kPost = "POST, OPTIONS";

constexpr RouteRow kRows[] = {
    {RouteId::Live, "/livez", kRead, true, false, "", "text/plain", "", "200", "", "alive, whatever else"},
    {RouteId::Ready, "/readyz", kRead, true, false, "", "text/plain", "", "200", "",
     "ready for work: the scenes are loaded and the server is not shutting down; else 503"},
    {RouteId::Metrics, "/metrics", kRead, false, true, "", "text/plain", "", "200", "",
     "figures of this process for Prometheus, text format 0.0.4"},
    {RouteId::OpenApi, "/v1/openapi.json", kRead, false, true, "", "application/json", "", "200 304", "ETag",
     "this document"},
    {RouteId::Info, "/v1/info", kRead, false, true, "", "application/json", "Info", "200 304", "ETag",
     "version, limits, parameters, queue and cache"},
    {RouteId::Scenes, "/v1/scenes", kRead, false, true, "", "application/json", "SceneList", "200 304",
     "ETag", "every scene, by name"},
    {RouteId::Scene, "/v1/scenes/{scene}", kRead, false, true, "", "application/json", "Scene",
     "200 304 404 409", "ETag", "one scene with its meshes, materials, camera and load report"},
    {RouteId::Preview, "/v1/scenes/{scene}/preview.glb", kRead, false, true, "", "model/gltf-binary", "",
     "200 304 307 404 409 422 429 504", "ETag Server-Timing",
     "the unrounded meshes as binary glTF 2.0, for a raster preview"},
    {RouteId::Tile, "/v1/scenes/{scene}/tiles/{width}x{height}/{x},{y},{w},{h}/{s0}-{s1}.{format}", kRead,
     false, true, "query", "application/vnd.chamfer.f16 image/x-exr image/png", "",
     "200 304 307 404 409 422 429 504", "ETag Server-Timing X-Chamfer-Rays X-Chamfer-Hits X-Chamfer-Rounded",
     "the mean of samples s0 to s1-1 of a rectangle of the frame; under a scene's id the same bytes for "
     "ever, everywhere"},
    {RouteId::Frame, "/v1/scenes/{scene}/frames/{width}x{height}/{s0}-{s1}.{format}", kRead, false, true,
     "query", "image/x-exr image/png", "", "200 304 307 404 409 422 429 504",
     "ETag Server-Timing X-Chamfer-Rays X-Chamfer-Hits X-Chamfer-Rounded Content-Disposition",
     "a whole frame, to be saved"},
    {RouteId::Rays, "/v1/scenes/{scene}/rays", kPost, false, true, "body", "application/json", "Hits",
     "200 404 409 411 413 415 422 429 504", "X-Chamfer-Rays X-Chamfer-Rounded",
     "the first hit of each ray with the scene's own instances, in the rays' order"},
    {RouteId::Comparisons, "/v1/comparisons", kRead, false, true, "", "application/json", "ComparisonList",
     "200 304 404", "ETag", "every comparison that was submitted, the newest first; 404: --jobs is not on"},
    {RouteId::Submit, "/v1/comparisons", "POST", false, true, "suite", "application/json", "Comparison",
     "200 202 404 409 411 413 415 422", "Location",
     "takes a suite of cases as a job: 202, and 200 where the same was asked for before and has its result"},
    {RouteId::Comparison, "/v1/comparisons/{job}", kRead, false, true, "", "application/json", "Comparison",
     "200 304 404", "ETag", "a job's state, progress and verdicts"},
    {RouteId::EndComparison, "/v1/comparisons/{job}", "DELETE", false, true, "", "", "", "204 404", "",
     "cancels a job that waits or runs, removes one that has ended"},
    {RouteId::ComparisonEvents, "/v1/comparisons/{job}/events", kRead, false, true, "", "text/event-stream",
     "", "200 204 404", "",
     "one server-sent event with the job's state, once it is another than Last-Event-ID says, or after 20 "
     "seconds; then ask again, as EventSource does. 204: nothing will come any more"},
    {RouteId::ComparisonSuite, "/v1/comparisons/{job}/suite.json", kRead, false, true, "", "application/json",
     "", "200 304 404", "ETag", "the suite as it was submitted"},
    {RouteId::ComparisonResult, "/v1/comparisons/{job}/result.json", kRead, false, true, "",
     "application/json", "", "200 304 404", "ETag", "what was found, chamfer.comparison/1"},
    {RouteId::ComparisonReport, "/v1/comparisons/{job}/report.html", kRead, false, true, "", "text/html", "",
     "200 304 404", "ETag Content-Security-Policy", "the same to look at, in one file"},
    {RouteId::ComparisonJUnit, "/v1/comparisons/{job}/junit.xml", kRead, false, true, "", "application/xml",
     "", "200 304 404", "ETag", "the same for build farms"},
    {RouteId::File, "/{file}", kRead, false, false, "", "text/html text/css text/javascript image/svg+xml",
     "", "200 304 404", "ETag", "the page"},
};

/// Is `path` one of the template's? What stands in braces is any one segment.
bool matches(std::string_view form, std::string_view path) {
  for (;;) {
    const std::size_t a = form.find('/', 1), b = path.find('/', 1);
    const std::string_view wanted = form.substr(0, a), given = path.substr(0, b);
    if (wanted.starts_with("/{") ? given.size() < 2 : wanted != given) return false;
    if (a == std::string_view::npos || b == std::string_view::npos) return a == b;
    form.remove_prefix(a);
    path.remove_prefix(b);
  }
}

constexpr std::string_view kScenePrefix = "/v1/scenes/{scene}";

/// The literal segment below a scene; empty: the scene itself.
std::string_view resourceWord(const RouteRow& row) {
  std::string_view word = row.path.substr(std::min(kScenePrefix.size() + 1, row.path.size()));
  return word.substr(0, word.find('/'));
}

/// Does anything follow the resource's word?
bool hasTail(const RouteRow& row) {
  return row.path.find('/', kScenePrefix.size() + 1) != std::string_view::npos;
}

} // namespace

bool RouteRow::answers(std::string_view method) const {
  for (std::string_view rest = methods;;) {
    const std::size_t comma = rest.find(", ");
    if (rest.substr(0, comma) == method) return true;
    if (comma == std::string_view::npos) return false;
    rest.remove_prefix(comma + 2);
  }
}

std::string allowedMethods(const RouteRow& row) {
  std::string all;
  for (const RouteRow& other : kRows)
    if (other.path == row.path) all += (all.empty() ? "" : ", ") + std::string(other.methods);
  return all;
}

const RouteRow* rowFor(const RouteRow& row, std::string_view method) {
  for (const RouteRow& other : kRows)
    if (other.path == row.path && other.answers(method)) return &other;
  return nullptr;
}

std::span<const RouteRow> routeRows() { return kRows; }

const RouteRow& routeRow(RouteId id) {
  for (const RouteRow& row : kRows)
    if (row.id == id) return row;
  throw Error(ErrorKind::Internal, "a route without a row");
}

const RouteRow* fixedRoute(std::string_view path) {
  for (const RouteRow& row : kRows)
    if (!row.hasScene() && row.id != RouteId::File && matches(row.path, path)) return &row;
  return path == "/v1" || path.starts_with("/v1/") ? nullptr : &routeRow(RouteId::File);
}

SceneMatch sceneRouteOf(std::span<const std::string_view> segments,
                        const std::function<bool(const std::string&)>& isScene) {
  if (segments.size() < 3 || segments[0] != "v1" || segments[1] != "scenes") return {};
  segments = segments.subspan(2);
  const std::string all = decodePath(segments);
  if (!isScene(all))
    for (std::size_t i = segments.size(); i-- > 1;)
      for (const RouteRow& row : kRows)
        if (row.hasScene() && row.id != RouteId::Scene && segments[i] == resourceWord(row) &&
            (hasTail(row) || i + 1 == segments.size()))
          return {&row, decodePath(segments.first(i)), segments.subspan(i + 1)};
  return {&routeRow(RouteId::Scene), all, {}};
}

} // namespace chamfer::http
