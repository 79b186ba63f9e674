// Conditions and ranges of requests (RFC 9110, 13 and 14.2).
#include "tests/http/server_fixture.h"

#include <filesystem>
#include <gmock/gmock.h>

namespace chamfer::http {
namespace {

class Conditional : public test::ServerTest {
protected:
  /// Minutes of work: whoever waits for it renders.
  std::string endless() { return "/v1/scenes/" + idOf("cube") + "/tiles/4096x4096/0,0,1024,1024/0-2048.f16"; }
  std::string etagOf(const std::string& target) { return *ask("HEAD", target).header("ETag"); }
};

TEST_F(Conditional, AnotherTagInIfMatchIs412BeforeAnythingIsRendered) {
  serve();
  const std::string tag = etagOf(endless());
  for (const std::string& other : {std::string("\"other\""), std::string("W/") + tag, std::string("other"),
                                   std::string(""), std::string("\"a\", \"b\"")})
    for (const char* method : {"GET", "HEAD"}) {
      const Response response = ask(method, endless(), {{"if-match", other}});
      EXPECT_EQ(response.status, 412) << other;
      EXPECT_EQ(json(response)["parameter"], "If-Match");
      EXPECT_EQ(response.header("ETag"), nullptr);
    }
  for (const std::string& right : {tag, "\"other\", " + tag, std::string("*")})
    EXPECT_EQ(ask("HEAD", endless(), {{"if-match", right}}).status, 200) << right;
  // Before If-None-Match, and both fields may be sent in parts.
  EXPECT_EQ(get(endless(), {{"if-match", "\"other\""}, {"if-none-match", tag}}).status, 412);
  EXPECT_EQ(get(endless(), {{"if-match", tag}, {"if-none-match", tag}}).status, 304);
  EXPECT_EQ(get(endless(), {{"if-match", "\"other\""}, {"if-match", tag}, {"if-none-match", "*"}}).status,
            304);
  EXPECT_EQ(get(endless(), {{"if-none-match", "\"other\""}, {"if-none-match", "W/" + tag}}).status, 304);
}

TEST_F(Conditional, HoldForEveryResource) {
  serve();
  const std::string scene = "/v1/scenes/" + idOf("cube");
  for (const std::string& target :
       {std::string("/"), std::string("/app.js"), std::string("/v1/openapi.json"), std::string("/v1/scenes"),
        scene, scene + "/preview.glb", scene + "/frames/8x8/0-1.png"}) {
    const std::string tag = etagOf(target);
    EXPECT_EQ(get(target, {{"if-none-match", tag}}).status, 304) << target;
    EXPECT_EQ(get(target, {{"if-match", tag}}).status, 200) << target;
    EXPECT_EQ(get(target, {{"if-match", "\"other\""}}).status, 412) << target;
  }
  for (const char* target : {"/livez", "/readyz", "/metrics"}) { // no tags
    EXPECT_EQ(get(target, {{"if-match", "\"other\""}}).status, 412) << target;
    EXPECT_EQ(get(target, {{"if-match", "*"}}).status, 200) << target;
    EXPECT_EQ(get(target, {{"if-none-match", "\"other\""}}).status, 200) << target;
  }
  const Headers batch{{"content-type", "application/json"}, {"if-match", "\"other\""}};
  EXPECT_EQ(ask("POST", "/v1/scenes/cube/rays", batch, R"({"rays":[]})").status, 412);
  // A redirect or an error is what it is without the condition (13.2.1).
  EXPECT_EQ(get("/v1/scenes/cube/preview.glb", {{"if-match", "\"other\""}}).status, 307);
  EXPECT_EQ(get("/v1/scenes/none", {{"if-match", "\"other\""}}).status, 404);
}

TEST_F(Conditional, DatesAndRangesDoNotApply) {
  start();
  const test::Reply whole = test::get(port_, quickTile());
  for (const char* fields : {"Range: bytes=0-15\r\n", "Range: bytes=-4\r\n", "Range: bytes=99999999-\r\n",
                             "Range: lines=1-2\r\n", "Range: bytes=0-15\r\nIf-Range: \"other\"\r\n",
                             "If-Modified-Since: Sat, 01 Jan 2050 00:00:00 GMT\r\n",
                             "If-Unmodified-Since: Sat, 01 Jan 2000 00:00:00 GMT\r\n"}) {
    const test::Reply reply = test::get(port_, quickTile(), fields);
    EXPECT_EQ(reply.status, 200) << fields;
    EXPECT_TRUE(reply.body == whole.body) << fields;
    EXPECT_EQ(reply.header("accept-ranges"), "") << "ranges are not offered";
    EXPECT_EQ(reply.header("content-range"), "");
  }
  const std::string etag = whole.header("etag");
  EXPECT_EQ(test::get(port_, quickTile(), "Range: bytes=0-15\r\nIf-Range: " + etag + "\r\n").body,
            whole.body);
  EXPECT_EQ(test::get(port_, quickTile(), "If-Match: \"other\"\r\n").status, 412);
  const test::Reply same = test::get(port_, quickTile(), "If-None-Match: " + etag + "\r\n");
  EXPECT_EQ(same.status, 304);
  EXPECT_EQ(same.body, "");
}

/// The cube of the shared reports, as a user would meet it.
TEST_F(Conditional, ReportedCube) {
  const std::filesystem::path cube =
      CHAMFER_SOURCE_DIR "/../shared/data/reports/conditional-and-range/cube.obj";
  if (!std::filesystem::exists(cube)) GTEST_SKIP() << "the shared reports are not here";
  std::filesystem::copy_file(cube, folder_.path() / "reported.obj");
  folder_.round("reported.obj", 0.1);
  start();
  const std::string tile = "/v1/scenes/" + idOf("reported") + "/tiles/64x64/0,0,32,32/0-1.f16";
  const test::Reply whole = test::get(port_, tile, "Range: bytes=0-99\r\n");
  EXPECT_EQ(whole.status, 200);
  EXPECT_EQ(whole.body.size(), 16u + 32 * 32 * 8);
  EXPECT_EQ(test::get(port_, tile, "If-None-Match: " + whole.header("etag") + "\r\n").status, 304);
  EXPECT_EQ(test::get(port_, tile, "If-Match: " + whole.header("etag") + "\r\n").status, 200);
  EXPECT_EQ(test::get(port_, tile, "If-Match: \"other\"\r\n").status, 412);
}

} // namespace
} // namespace chamfer::http
