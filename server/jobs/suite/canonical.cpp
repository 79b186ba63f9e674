#include "server/jobs/suite/canonical.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace chamfer {
namespace {

using Json = nlohmann::ordered_json;

Json rectJson(const TileRect& r) { return {r.x, r.y, r.width, r.height}; }

Json rectsJson(const std::vector<TileRect>& rects) {
  Json list = Json::array();
  for (const TileRect& r : rects)
    list.push_back(rectJson(r));
  return list;
}

Json perLevel(const PerLevel& p) { return {p.pixel, p.block, p.image}; }

Json sideJson(const SideChoice& side, const SideChoice& other, const CaseChoice& of,
              const std::string& origin) {
  if (side.kind == SideKind::Digest) return {"digest", side.digest.hex()};
  if (side.kind == SideKind::Image) return {"image", origin};
  // A URL's tile is rendered as it stands, of a scene what is compared: they are not the same even where one
  // frame has the other's size.
  return {side.kind == SideKind::Tile ? "tile" : "scene", origin,
          canonicalSettings(resolvedRequest(side, other, of))};
}

} // namespace

TileRequest resolvedRequest(const SideChoice& side, const SideChoice& other, const CaseChoice& of) {
  TileRequest request = side.request;
  if (side.kind == SideKind::Tile) return request;
  RenderSettings& s = request.settings;
  if (s.endSample == 0) s.endSample = of.samples;
  if (s.width == 0) s.width = of.width, s.height = of.height;
  if (s.width == 0 && other.isRender())
    s.width = other.request.settings.width, s.height = other.request.settings.height;
  if (s.width == 0 && other.kind != SideKind::Image) s.width = kUsualWidth, s.height = kUsualHeight;
  request.tile = {0, 0, s.width, s.height};
  return request;
}

std::string canonicalCase(const CaseChoice& c, const CaseOrigins& origins) {
  Json json{{"name", c.name},
            {"a", sideJson(c.a, c.b, c, origins.a)},
            {"b", sideJson(c.b, c.a, c, origins.b)},
            {"seeds", c.budget()},
            {"seconds", c.renders() ? c.seconds : 0},
            {"crop", c.region.crop ? rectJson(*c.region.crop) : Json()},
            {"mask", origins.mask},
            {"only", rectsJson(c.region.only)},
            {"except", rectsJson(c.region.except)},
            {"tolerance", {c.tolerance.absolute, c.tolerance.relative}}};
  auto limits = c.limits;
  std::sort(limits.begin(), limits.end());
  json["limits"] = Json::array();
  for (const auto& [metric, limit] : limits)
    json["limits"].push_back({metricRow(metric).name, limit});
  json["statistics"] = Json();
  if (c.judgesStatistics())
    json["statistics"] = {c.statistics.significance, perLevel(c.statistics.tolerance),
                          perLevel(c.statistics.resolution)};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

} // namespace chamfer
