// Every resource of the interface, one row each. The service finds a request's route here, metrics are
// labelled with its template, and /v1/openapi.json is printed from it together with the parameters' rows
// (render/request/parameters.h).
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace chamfer::http {

enum class RouteId : std::uint8_t {
  Live,
  Ready,
  Metrics,
  OpenApi,
  Info,
  Scenes,
  Scene,
  Preview,
  Tile,
  Frame,
  Rays,
  Comparisons,
  Submit,
  Comparison,
  EndComparison,
  ComparisonEvents,
  ComparisonSuite,
  ComparisonResult,
  ComparisonReport,
  ComparisonJUnit,
  File
};

/// Lists are words with blanks between them.
struct RouteRow {
  RouteId id;
  std::string_view path;    ///< template; what stands in braces is a row of parameters.h, {job} or {file}
  std::string_view methods; ///< with ", " between them; several rows may share a path
  bool anyHost;             ///< answered whatever Host says
  bool needsKey;            ///< where the server has keys
  std::string_view
      takes; ///< "query" or "body": all rows of parameters.h that stand there; "suite"; empty: none
  std::string_view produces; ///< media types of the answer
  std::string_view schema;   ///< of a JSON answer, a component of openapi_schemas.h
  std::string_view statuses; ///< that its own work can have; every route can answer 400, 405, 414, 431, 503
  std::string_view headers;  ///< that a 200 always carries, beside those of all answers
  std::string_view about;

  bool answers(std::string_view method) const;
  bool hasScene() const { return path.find("{scene}") != std::string_view::npos; }
};

std::span<const RouteRow> routeRows();
const RouteRow& routeRow(RouteId id);

/// All methods of the row's path, as in Allow.
std::string allowedMethods(const RouteRow& row);
/// The row of the same path that answers the method; nullptr: none does.
const RouteRow* rowFor(const RouteRow& row, std::string_view method);

/// The first route of a path without a scene in it; every path but those of /v1 falls to RouteId::File.
/// nullptr: none, it may have a scene in it. `path`: as sent.
const RouteRow* fixedRoute(std::string_view path);

struct SceneMatch {
  const RouteRow* row = nullptr;          ///< nullptr: the path is none of a scene
  std::string scene;                      ///< decoded
  std::span<const std::string_view> rest; ///< what follows the resource's word, still encoded
};
/// The route of a path with a scene in it; `segments`: of the path, as sent. A scene's name may hold slashes,
/// sent plain or as %2F: what looks like a resource below a scene is one, unless a scene has all of it as its
/// name. Throws Error(Usage) for a broken escape.
SceneMatch sceneRouteOf(std::span<const std::string_view> segments,
                        const std::function<bool(const std::string& name)>& isScene);

} // namespace chamfer::http
