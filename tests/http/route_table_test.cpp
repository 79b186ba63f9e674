#include "server/http/routes/route_table.h"

#include "server/render/request/query.h"

#include <gtest/gtest.h>

namespace chamfer::http {
namespace {

/// The template of the path's route, "none" where there is none; the scene's name and the number of further
/// segments behind it.
std::string routeOf(const std::string& path, const std::string& scene = "") {
  if (const RouteRow* row = fixedRoute(path)) return std::string(row->path);
  const auto segments = splitPath(path);
  const SceneMatch match = sceneRouteOf(segments, [&](const std::string& name) { return name == scene; });
  if (!match.row) return "none";
  std::string word(match.row->path.substr(std::string_view("/v1/scenes/{scene}").size()));
  word = word.substr(0, word.find('/', 1));
  return word + '|' + match.scene + '|' + std::to_string(match.rest.size());
}

TEST(RouteTable, FindsEveryKindOfPath) {
  EXPECT_EQ(routeOf("/livez"), "/livez");
  EXPECT_EQ(routeOf("/v1/openapi.json"), "/v1/openapi.json");
  EXPECT_EQ(routeOf("/"), "/{file}");
  EXPECT_EQ(routeOf("/a/b.js"), "/{file}");
  EXPECT_EQ(routeOf("/v1"), "none");
  EXPECT_EQ(routeOf("/v1/"), "none");
  EXPECT_EQ(routeOf("/v1/inf%6f"), "none");
  EXPECT_EQ(routeOf("/v1/comparisons"), "/v1/comparisons");
  EXPECT_EQ(routeOf("/v1/comparisons/a"), "/v1/comparisons/{job}");
  EXPECT_EQ(routeOf("/v1/comparisons/a/junit.xml"), "/v1/comparisons/{job}/junit.xml");
  for (const char* other : {"/v1/comparisons/", "/v1/comparisons//junit.xml", "/v1/comparisons/a/",
                            "/v1/comparisons/a/junit.xml/", "/v1/comparisons/a/b", "/v1/comparisonsa"})
    EXPECT_EQ(routeOf(other), "none") << other;
  EXPECT_EQ(routeOf("/v1/scenes/a"), "|a|0");
  EXPECT_EQ(routeOf("/v1/scenes/a/"), "|a/|0") << "no scene has such a name";
  EXPECT_EQ(routeOf("/v1/scenes/a%2Fb/c"), "|a/b/c|0");
  EXPECT_EQ(routeOf("/v1/scenes/a/b/tiles/1/2/3"), "/tiles|a/b|3");
  EXPECT_EQ(routeOf("/v1/scenes/a/frames/1"), "/frames|a|1");
  EXPECT_EQ(routeOf("/v1/scenes/a/rays"), "/rays|a|0");
  EXPECT_EQ(routeOf("/v1/scenes/a/rays/x"), "|a/rays/x|0");
  EXPECT_EQ(routeOf("/v1/scenes/a/preview.glb"), "/preview.glb|a|0");
}

TEST(RouteTable, SceneOfThatNameComesFirst) {
  EXPECT_EQ(routeOf("/v1/scenes/a/rays", "a/rays"), "|a/rays|0");
  EXPECT_EQ(routeOf("/v1/scenes/tiles/tiles/8", "tiles"), "/tiles|tiles|1");
}

TEST(RouteTable, RowsAreComplete) {
  for (const RouteRow& row : routeRows()) {
    EXPECT_EQ(&routeRow(row.id), &row) << row.path << ": one row each";
    EXPECT_FALSE(row.about.empty() || row.methods.empty()) << row.path;
    EXPECT_EQ(row.produces.empty(), row.methods == "DELETE") << row.path;
    EXPECT_EQ(row.path.starts_with("/v1/"), row.needsKey && row.id != RouteId::Metrics) << row.path;
  }
}

} // namespace
} // namespace chamfer::http
