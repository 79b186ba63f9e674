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
    {RouteId::File, "/{file}", kRead, false, false, "", "text/html text/css text/javascript image/svg+xml",
     "", "200 304 404", "ETag", "the page"},
};

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

std::span<const RouteRow> routeRows() { return kRows; }

const RouteRow& routeRow(RouteId id) {
  for (const RouteRow& row : kRows)
    if (row.id == id) return row;
  throw Error(ErrorKind::Internal, "a route without a row");
}

const RouteRow* fixedRoute(std::string_view path) {
  for (const RouteRow& row : kRows)
    if (!row.hasScene() && path == row.path) return &row;
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
