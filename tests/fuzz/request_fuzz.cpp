// What a stranger sends first: a request's head, its target, the tile or frame that the target names. Any
// bytes are refused with a Problem or give a request within its limits; nothing else may happen.
#include "server/http/connection/request_head.h"
#include "server/http/routes/problem.h"
#include "server/http/routes/route_table.h"
#include "server/http/schema/limits.h"
#include "server/render/request/parameters.h"
#include "server/render/request/query.h"
#include "server/render/request/tile_request.h"
#include "tests/fuzz/require.h"

#include <cmath>

namespace {

using namespace chamfer;
using namespace chamfer::http;

void checkImage(const TileRequest& request, std::uint64_t mostPixels) {
  const auto& [settings, tile, rounding, format] = request;
  const std::uint64_t pixels = std::uint64_t{tile.width} * tile.height;
  REQUIRE(tile.width >= 1 && tile.height >= 1 && pixels <= mostPixels);
  REQUIRE(tile.x + tile.width <= settings.width && tile.y + tile.height <= settings.height);
  REQUIRE(settings.firstSample < settings.endSample && pixels * request.samples() <= kMaxRequestSamples);
  REQUIRE(settings.maxBounces <= 64);
  REQUIRE(!rounding.radius || (std::isfinite(*rounding.radius) && *rounding.radius > 0));
  if (const auto& camera = settings.camera) {
    for (const double number :
         {camera->eye.x, camera->eye.y, camera->eye.z, camera->target.x, camera->target.y, camera->target.z,
          camera->up.x, camera->up.y, camera->up.z, camera->apertureDiameter, camera->focusDistance})
      REQUIRE(std::isfinite(number));
    REQUIRE(camera->vfovDegrees > 0 && camera->vfovDegrees < 180);
  }
  const Digest scene{1, 2};
  // Another scene and other noise are other answers.
  TileRequest other = request;
  other.settings.seed ^= 1;
  REQUIRE(!(answerDigest("1.0", scene, request) == answerDigest("1.0", {1, 3}, request)));
  REQUIRE(!(answerDigest("1.0", scene, request) == answerDigest("1.0", scene, other)));
}

void parseTarget(std::string_view target) {
  const std::size_t mark = target.find('?');
  const std::string_view path = target.substr(0, mark);
  const std::string_view query =
      mark == std::string_view::npos ? std::string_view() : target.substr(mark + 1);
  if (const auto decoded = percentDecode(path)) REQUIRE(percentDecode(percentEncode(*decoded)) == decoded);
  const auto segments = splitPath(path);
  try {
    const SceneMatch match = sceneRouteOf(segments, [](const std::string& name) { return name.size() == 3; });
    if (match.row && match.row->id == RouteId::Tile) checkImage(parseTile(match.rest, query), kMaxTilePixels);
    if (match.row && match.row->id == RouteId::Frame)
      checkImage(parseFrame(match.rest, query), kMaxFramePixels);
    (void)parseQuery(query);
  } catch (const Error& error) {
    const Problem problem = problemOf(error, "");
    REQUIRE(problem.status >= 400 && problem.status < 500);
    (void)toResponse(problem, "fuzz");
  }
  (void)fixedRoute(path);
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  parseTarget(text);
  if (const auto end = findHeadEnd(text)) {
    const auto head = parseRequestHead(text.substr(0, *end));
    if (const RequestHead* request = std::get_if<RequestHead>(&head)) {
      REQUIRE(request->target.starts_with('/') && request->target.size() <= kMaxTargetBytes);
      REQUIRE(request->method == "POST" || request->contentLength == 0);
      parseTarget(request->target);
    } else {
      REQUIRE(std::get<Problem>(head).close);
    }
  }
  return 0;
}
