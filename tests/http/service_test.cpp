// Routes without sockets: who is let in, what is found, what errors look like.
#include "server/http/schema/limits.h"
#include "server/http/version.h"
#include "server/render/request/parameters.h"
#include "tests/http/service_fixture.h"

#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>

namespace chamfer::http {
namespace {

using testing::HasSubstr;

class Routes : public test::ServiceTest {};

TEST_F(Routes, HealthFollowsTheServersState) {
  folder_.addCube("cube.obj");
  serve();
  EXPECT_EQ(get("/livez").status, 200);
  EXPECT_EQ(get("/readyz").status, 200);
  service_->drain();
  EXPECT_EQ(get("/livez").status, 200);
  const Response draining = get("/readyz");
  EXPECT_EQ(draining.status, 503);
  EXPECT_NE(draining.header("Retry-After"), nullptr);
  EXPECT_EQ(get("/v1/scenes/" + idOf("cube") + "/tiles/8x8/0,0,8,8/0-1.f16").status, 503);
}

TEST_F(Routes, NotReadyBeforeTheScenesAreLoaded) {
  const Catalogue catalogue(folder_.path(), std::chrono::milliseconds(0)); // never started
  Service service({}, catalogue, StaticFiles());
  Request ready = request("GET", "/readyz"), scene = request("GET", "/v1/scenes/cube");
  EXPECT_EQ(service.answer(ready).status, 503);
  EXPECT_EQ(service.answer(scene).status, 503);
}

TEST_F(Routes, InfoPrintsTheSchemasRows) {
  serve({.slots = 3});
  const auto info = json(get("/v1/info"));
  EXPECT_EQ(info["version"], kVersion);
  EXPECT_EQ(info["limits"]["rays"], kMaxRays);
  EXPECT_EQ(info["queue"]["slots"], 3);
  EXPECT_EQ(info["limits"].size(), limitRows().size() + 3)
      << "and the deadline, connections, and what memory there is for explicit meshes";
  EXPECT_EQ(info["limits"]["explicit_triangles"], (std::size_t{1} << 30) / 160);
  for (const LimitRow& row : limitRows())
    EXPECT_EQ(info["limits"][std::string(row.name)], row.value);
  ASSERT_EQ(info["parameters"].size(), parameterRows().size());
  for (std::size_t i = 0; i < parameterRows().size(); ++i) {
    EXPECT_EQ(info["parameters"][i]["name"], parameterRows()[i].name);
    EXPECT_EQ(info["parameters"][i]["limits"].dump(),
              nlohmann::json::parse(limitsJson(parameterRows()[i])).dump());
  }
}

TEST_F(Routes, ListDescribesEveryScene) {
  folder_.addCube("cube.obj", 0.1);
  folder_.addCube("sub/old.obj");
  folder_.write("sub/old.obj", test::cubeObj(2));
  serve();
  const auto list = json(get("/v1/scenes"));
  ASSERT_TRUE(list.is_array());
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list[0]["name"], "cube");
  EXPECT_EQ(list[0]["id"], idOf("cube"));
  EXPECT_EQ(list[0]["state"], "ready");
  EXPECT_EQ(list[0]["triangles"], 12);
  EXPECT_EQ(list[0]["rounded_edges"], 12);
  EXPECT_EQ(list[0]["bounds"]["min"][0], -0.5);
  EXPECT_EQ(list[0]["bounds"]["max"][2], 0.5);
  EXPECT_EQ(list[0]["radius"]["current"], 0.1);
  EXPECT_NEAR(list[0]["radius"]["max"].get<double>(), 0.5, 1e-9);
  EXPECT_TRUE(list[0]["warnings"].is_array());
  EXPECT_EQ(list[1]["name"], "sub/old");
  EXPECT_EQ(list[1]["state"], "stale");
  EXPECT_TRUE(list[1]["id"].is_null());
  EXPECT_EQ(list[1]["error"]["kind"], "stale-sidecar");
}

TEST_F(Routes, SceneGoesByNameAndId) {
  folder_.addCube("a/b c.obj");
  serve();
  const Response plain = get("/v1/scenes/a/b%20c");
  ASSERT_EQ(plain.status, 200);
  EXPECT_EQ(get("/v1/scenes/a%2Fb%20c").body, plain.body);
  EXPECT_EQ(get("/v1/scenes/" + idOf("a/b c")).body, plain.body);
  const auto scene = json(plain);
  EXPECT_EQ(scene["meshes"][0]["solids"], 1);
  EXPECT_EQ(scene["meshes"][0]["rounded_edges"], 12);
  for (const char* key : {"eye", "target", "up"})
    EXPECT_EQ(scene["camera"][key].size(), 3u);
  EXPECT_GT(scene["camera"]["vfov_degrees"].get<double>(), 0);
}

TEST_F(Routes, ABareMeshIsThereWithEitherAxisUp) {
  folder_.addCube("a.obj");
  folder_.write("s.scene.json", R"({"meshes":[{"name":"m","file":"cube.obj"}],"instances":[{"mesh":"m"}]})");
  folder_.addCube("cube.obj");
  serve();
  EXPECT_TRUE(json(get("/v1/scenes/s"))["up_axis"].is_null());
  const auto own = json(get("/v1/scenes/a"));
  EXPECT_EQ(own["up_axis"]["current"], "z");
  EXPECT_EQ(own["up_axis"]["ids"]["z"], own["id"]);
  const std::string id = own["up_axis"]["ids"]["y"];
  const auto turned = json(get("/v1/scenes/" + id));
  EXPECT_EQ(turned["id"], id);
  EXPECT_EQ(turned["up_axis"]["current"], "y");
  EXPECT_EQ(turned["up_axis"]["ids"], own["up_axis"]["ids"]);
  EXPECT_EQ(get("/v1/scenes/" + id + "/tiles/8x8/0,0,8,8/0-1.f16").status, 200);
}

TEST_F(Routes, ScenesMayBeNamedLikeResources) {
  folder_.addCube("a.obj");
  folder_.addCube("a/rays.obj");
  folder_.addCube("a/tiles/x.obj");
  serve();
  EXPECT_EQ(json(get("/v1/scenes/a/rays"))["name"], "a/rays");
  EXPECT_EQ(json(get("/v1/scenes/a/tiles/x"))["name"], "a/tiles/x");
  EXPECT_EQ(get("/v1/scenes/a/tiles/8x8/0,0,8,8/0-1.f16").status, 307);
}

TEST_F(Routes, UnknownPathsAndScenesAre404) {
  folder_.addCube("cube.obj");
  serve();
  for (const char* target :
       {"/nothing", "/v1", "/v1/", "/v1/scene", "/v1/scenes/", "/v1/scenes/none", "/v1/scenes/cub",
        "/v1/scenes/cube/", "/v1/scenes/cube/tile/8x8/0,0,8,8/0-1.png", "/v1/scenes/cube/tiles/8x8/0-1.png",
        "/v1/scenes/cube/tiles", "/v1/scenes/00000000000000000000000000000000", "/../etc/passwd",
        "/%2e%2e/etc/passwd", "/v1/scenes/..%2f..%2fetc%2fpasswd", "/v1/scenes/cube.obj", "//livez"})
    EXPECT_EQ(get(target).status, 404) << target;
  const Response unknown = get("/v1/scenes/none");
  EXPECT_EQ(json(unknown)["parameter"], "scene");
  EXPECT_EQ(json(unknown)["value"], "none");
  EXPECT_EQ(json(unknown)["request_id"], *unknown.header("X-Request-Id"));
}

TEST_F(Routes, BrokenEscapesAre400) {
  serve();
  for (const char* target : {"/%", "/v1/scenes/%zz", "/v1/scenes/a%00b", "/v1/scenes/a%0d%0ab"})
    EXPECT_EQ(get(target).status, 400) << target;
}

TEST_F(Routes, WrongMethodsNameTheRightOnes) {
  folder_.addCube("cube.obj");
  serve();
  const struct {
    const char* target;
    const char* allow;
  } resources[] = {{"/", "GET, HEAD, OPTIONS"},
                   {"/livez", "GET, HEAD, OPTIONS"},
                   {"/metrics", "GET, HEAD, OPTIONS"},
                   {"/v1/info", "GET, HEAD, OPTIONS"},
                   {"/v1/openapi.json", "GET, HEAD, OPTIONS"},
                   {"/v1/scenes", "GET, HEAD, OPTIONS"},
                   {"/v1/scenes/cube", "GET, HEAD, OPTIONS"},
                   {"/v1/scenes/cube/preview.glb", "GET, HEAD, OPTIONS"},
                   {"/v1/scenes/cube/tiles/8x8/0,0,8,8/0-1.png", "GET, HEAD, OPTIONS"},
                   {"/v1/scenes/cube/frames/8x8/0-1.png", "GET, HEAD, OPTIONS"},
                   {"/v1/scenes/cube/rays", "POST, OPTIONS"}};
  for (const auto& [target, allow] : resources)
    for (const std::string method : {"PUT", "DELETE", "PATCH", "TRACE", "POST", "GET", "HEA", "GET, HEAD"}) {
      if (std::string(allow).starts_with(method + ",") && method != "GET, HEAD") continue;
      const Response response = ask(method, target);
      EXPECT_EQ(response.status, 405) << method << ' ' << target;
      ASSERT_NE(response.header("Allow"), nullptr);
      EXPECT_EQ(*response.header("Allow"), allow);
    }
}

TEST_F(Routes, OptionsNameTheMethodsAndNoOtherSite) {
  folder_.addCube("cube.obj");
  serve();
  for (const std::string target : {"/", "/readyz", "/v1/scenes", "/v1/scenes/cube/rays"}) {
    const Response response = ask(
        "OPTIONS", target, {{"origin", "http://evil.example"}, {"access-control-request-method", "POST"}});
    EXPECT_EQ(response.status, 204) << target;
    EXPECT_TRUE(response.body.empty());
    EXPECT_THAT(*response.header("Allow"), HasSubstr(target.ends_with("rays") ? "POST" : "GET"));
    for (const auto& [name, value] : response.headers)
      EXPECT_FALSE(name.starts_with("Access-Control")) << name;
  }
  const Response image = get("/v1/scenes/" + idOf("cube"), {{"origin", "http://evil.example"}});
  EXPECT_EQ(image.header("Access-Control-Allow-Origin"), nullptr);
}

TEST_F(Routes, QueriesAreRefusedWhereNoneIsTaken) {
  folder_.addCube("cube.obj");
  serve();
  for (const char* target : {"/v1/info?a=1", "/v1/scenes?x", "/v1/scenes/cube?seed=1"})
    EXPECT_EQ(get(target).status, 400) << target;
}

TEST_F(Routes, PageIsInTheProgram) {
  serve();
  const Response page = get("/");
  ASSERT_EQ(page.status, 200);
  EXPECT_EQ(page.contentType, "text/html; charset=utf-8");
  EXPECT_EQ(get("/index.html").body, page.body);
  std::ifstream file(CHAMFER_SOURCE_DIR "/web/index.html", std::ios::binary);
  EXPECT_EQ(page.body, std::string(std::istreambuf_iterator<char>(file), {}));
  ASSERT_NE(page.header("ETag"), nullptr);
  EXPECT_EQ(get("/", {{"if-none-match", *page.header("ETag")}}).status, 304);
}

TEST_F(Routes, PageOfAnotherFolderIsAFixedList) {
  folder_.write("web/index.html", "<p>page</p>");
  folder_.write("web/sub/a.js", "1");
  folder_.write("web/secret.txt", "2");
  folder_.write("outside.js", "3");
  const StaticFiles files(folder_.path() / "web");
  EXPECT_EQ(files.find("")->bytes, "<p>page</p>");
  EXPECT_EQ(files.find("sub/a.js")->contentType, "text/javascript; charset=utf-8");
  for (const char* path : {"secret.txt", "../outside.js", "sub", "sub/../sub/a.js", "/index.html"})
    EXPECT_FALSE(files.find(path)) << path;
  EXPECT_THROW(StaticFiles(folder_.path()), Error);
}

TEST_F(Routes, BrokenScenesAnswer409WithTheirFault) {
  folder_.addCube("stale.obj");
  folder_.write("stale.obj", test::cubeObj(0.75));
  folder_.addCube("cut.obj");
  std::filesystem::resize_file(folder_.path() / "cut.obj.chamfer", 64);
  serve();
  for (const std::string name : {"stale", "cut"}) {
    const std::string scene = "/v1/scenes/" + name;
    for (const Response& response :
         {get(scene), get(scene + "/tiles/8x8/0,0,8,8/0-1.png"), get(scene + "/frames/8x8/0-1.png"),
          rays(name, R"({"rays":[[0,0,5,0,0,-1]]})")}) {
      EXPECT_EQ(response.status, 409) << name;
      EXPECT_THAT(response.body, HasSubstr(name == "stale" ? "stale-sidecar" : "damaged-sidecar"));
    }
    EXPECT_EQ(get("/livez").status, 200);
  }
}

TEST_F(Routes, KeysAreAskedForUnderV1Only) {
  serve({.keys = {"0123456789abcdef", "fedcba9876543210"}});
  EXPECT_EQ(get("/livez").status, 200);
  EXPECT_EQ(get("/").status, 200);
  const Response missing = get("/v1/info");
  EXPECT_EQ(missing.status, 401);
  EXPECT_NE(missing.header("WWW-Authenticate"), nullptr);
  for (const char* wrong : {"0123456789abcdeg", "0123456789abcde", "0123456789abcdef0", ""})
    EXPECT_GE(get("/v1/info", {{"authorization", std::string("Bearer ") + wrong}}).status, 401) << wrong;
  EXPECT_EQ(get("/v1/info", {{"authorization", "Bearer fedcba9876543210"}}).status, 200);
  EXPECT_EQ(get("/v1/info", {{"x-api-key", "0123456789abcdef"}}).status, 200);
}

TEST_F(Routes, WhatAKeyIsAskedForIsNotForSharedCaches) {
  folder_.addCube("cube.obj");
  const test::SceneFolder jobs;
  const Headers key{{"authorization", "Bearer 0123456789abcdef"}};
  for (const bool keyed : {true, false}) {
    ServiceOptions options{.jobs = {.folder = jobs.path()}};
    if (keyed) options.keys = {"0123456789abcdef"};
    serve(options);
    const std::string scene = "/v1/scenes/" + idOf("cube");
    const std::string images[] = {scene + "/tiles/8x8/0,0,8,8/0-1.png", scene + "/frames/8x8/0-1.exr",
                                  scene + "/preview.glb"};
    for (const std::string& image : images)
      EXPECT_EQ(*get(image, key).header("Cache-Control"),
                keyed ? "private, max-age=31536000, immutable" : "public, max-age=31536000, immutable");
    // Every route, whatever it answers: 200, 304, a redirect.
    std::vector<std::string> targets(std::begin(images), std::end(images));
    for (const RouteRow& row : routeRows())
      if (row.needsKey && !row.hasScene() && row.path.find("{job}") == std::string_view::npos)
        targets.emplace_back(row.path);
    targets.insert(targets.end(), {scene, "/v1/scenes/cube/tiles/8x8/0,0,8,8/0-1.png"});
    for (const std::string& target : targets) {
      const Response first = get(target, key);
      Headers again = key;
      if (first.header("ETag")) again.emplace_back("if-none-match", *first.header("ETag"));
      for (const Response& response : {first, get(target, again)}) {
        const std::string cache = *response.header("Cache-Control");
        EXPECT_EQ(cache == "no-store" || cache.starts_with("private, "), keyed || cache == "no-store")
            << target << ": " << cache;
        EXPECT_EQ(response.header("Vary") != nullptr, keyed) << target;
        if (keyed) {
          EXPECT_EQ(cache.find("public"), std::string::npos) << target;
          EXPECT_EQ(*response.header("Vary"), "Authorization, X-Api-Key");
        }
      }
    }
    EXPECT_EQ(*get("/").header("Cache-Control"), "no-cache") << "the page is for everybody";
    service_.reset();
  }
}

TEST_F(Routes, OtherHostsAreNotAnswered) {
  serve({.hosts = {"localhost", "127.0.0.1", "[::1]", "render.example"}});
  for (const char* host :
       {"localhost", "LOCALHOST:8080", "127.0.0.1:1", "[::1]:80", "[::1]", "render.example"})
    EXPECT_EQ(get("/v1/info", {{"host", host}}).status, 200) << host;
  for (const char* host : {"evil.example", "evil.example:80", "localhost.evil.example", ""})
    EXPECT_EQ(get("/v1/info", {{"host", host}}).status, 421) << host;
  EXPECT_EQ(get("/livez", {{"host", "10.0.0.7:80"}}).status, 200) << "health checks come by address";
}

TEST_F(Routes, PagesOfOtherSitesCannotMakeItWork) {
  folder_.addCube("cube.obj");
  serve();
  const std::string tile = "/v1/scenes/" + idOf("cube") + "/tiles/8x8/0,0,8,8/0-1.png";
  for (const char* mode : {"no-cors", "cors", "websocket"})
    for (const std::string& target : {tile, std::string("/v1/info"), std::string("/app.js")}) {
      const Response response = get(
          target, {{"sec-fetch-site", "cross-site"}, {"sec-fetch-mode", mode}, {"sec-fetch-dest", "image"}});
      EXPECT_EQ(response.status, 403) << target;
      EXPECT_THAT(response.body, HasSubstr("urn:chamfer:problem:cross-site"));
    }
  // Links are followed, but not into the other site's frames, and not before somebody does.
  const auto navigation = [](const char* destination, Headers more = {}) {
    Headers headers{{"sec-fetch-site", "cross-site"}, {"sec-fetch-mode", "navigate"}};
    if (*destination) headers.emplace_back("sec-fetch-dest", destination);
    headers.insert(headers.end(), more.begin(), more.end());
    return headers;
  };
  for (const std::string& target : {tile, std::string("/")}) {
    EXPECT_EQ(get(target, navigation("document")).status, 200) << target;
    EXPECT_EQ(get(target, navigation("document", {{"sec-fetch-user", "?1"}})).status, 200) << target;
    for (const char* destination : {"iframe", "frame", "fencedframe", "embed", "object", "empty", ""})
      EXPECT_EQ(get(target, navigation(destination)).status, 403) << target << ' ' << destination;
    EXPECT_EQ(get(target, navigation("document", {{"sec-purpose", "prefetch;prerender"}})).status, 403);
    EXPECT_EQ(get(target, navigation("document", {{"purpose", "prefetch"}})).status, 403);
  }
  EXPECT_EQ(ask("POST", "/v1/scenes/cube/rays",
                navigation("document", {{"content-type", "application/json"}}), R"({"rays":[]})")
                .status,
            403)
      << "a form";
  for (const char* site : {"same-origin", "same-site", "none"})
    EXPECT_EQ(get(tile, {{"sec-fetch-site", site}, {"sec-fetch-mode", "cors"}}).status, 200) << site;
  EXPECT_EQ(get("/livez", {{"sec-fetch-site", "cross-site"}, {"sec-fetch-mode", "no-cors"}}).status, 200);
}

TEST_F(Routes, RequestIdsAreKeptWhenTheyAreHarmless) {
  serve();
  EXPECT_EQ(*get("/livez", {{"x-request-id", "a-B_1.2"}}).header("X-Request-Id"), "a-B_1.2");
  for (const char* bad : {"", "a b", "a\"b", "a%0d"})
    EXPECT_NE(*get("/livez", {{"x-request-id", bad}}).header("X-Request-Id"), bad);
}

TEST_F(Routes, NoPathOfTheServerIsInAMessage) {
  EXPECT_EQ(withoutRoot("cannot read /srv/x/a/b.obj, nor /srv/x", "/srv/x"), "cannot read a/b.obj, nor .");
}

} // namespace
} // namespace chamfer::http
