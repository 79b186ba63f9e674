// Comparisons as jobs: what is taken, what is refused, what comes of it.
#include "tests/http/comparisons_fixture.h"

#include "server/http/schema/limits.h"
#include "server/jobs/cli/local_host.h"
#include "server/jobs/compare/compare_suite.h"
#include "server/jobs/report/reports.h"

#include <fstream>
#include <gmock/gmock.h>

namespace chamfer::http {
namespace {

using testing::HasSubstr;
using testing::Not;

class Comparisons : public test::ComparisonsTest {};

const char* const kSharpCase = R"({"name":"sharp","a":"cube?rounding=none","b":"cube","seeds":32})";

TEST_F(Comparisons, AJobIsTakenAndItsResultsAreThere) {
  serveJobs();
  const Response taken = submit(suite(kSharpCase));
  ASSERT_EQ(taken.status, 202) << taken.body;
  const std::string path = *taken.header("Location");
  EXPECT_EQ(json(taken)["links"]["self"], path);
  EXPECT_EQ(json(taken)["links"]["result"], nullptr);
  const auto job = waitFor(path, "done");
  EXPECT_EQ(job["outcome"], "differs");
  EXPECT_EQ(job["cases"][0]["name"], "sharp");
  EXPECT_EQ(job["cases"][0]["outcome"], "differs");
  EXPECT_EQ(job["progress"], nullptr);

  const Response result = get(job["links"]["result"]);
  EXPECT_EQ(json(result)["outcome"], "differs");
  EXPECT_EQ(json(result)["cases"][0]["command"], "chamferd compare --suite suite.json --case sharp");
  const Response report = get(job["links"]["report"]);
  EXPECT_EQ(report.contentType, "text/html; charset=utf-8");
  ASSERT_NE(report.header("Content-Security-Policy"), nullptr);
  const std::string policy = *report.header("Content-Security-Policy");
  for (const char* part : {"default-src 'none'", "img-src data:", "style-src 'unsafe-inline'",
                           "script-src 'unsafe-inline'", "sandbox allow-scripts"})
    EXPECT_THAT(policy, HasSubstr(part));
  EXPECT_THAT(policy, Not(HasSubstr("allow-same-origin")));
  EXPECT_THAT(get(job["links"]["junit"]).body, HasSubstr("<failure"));
  EXPECT_EQ(json(get(job["links"]["suite"]))["cases"][0]["a"], "cube?rounding=none");
  EXPECT_TRUE(withoutSeeds(path)) << "they have done their work";
  for (const char* file : {"", "/result.json", "/report.html", "/junit.xml", "/suite.json"}) {
    const Response first = get(path + file);
    EXPECT_EQ(get(path + file, {{"if-none-match", *first.header("ETag")}}).status, 304) << file;
  }
  const auto list = json(get("/v1/comparisons"));
  ASSERT_EQ(list.size(), 1u);
  EXPECT_EQ(list[0]["outcome"], "differs");
}

TEST_F(Comparisons, TheSameAskedForAgainIsTheSameJob) {
  folder_.addCube("sub/other.obj", 0.2);
  serveJobs();
  const std::string path = submitted(suite(kSharpCase));
  waitFor(path, "done");
  const std::string bodies[] = {
      suite(kSharpCase),
      suite(R"({"seeds":32,"b":"cube.obj","a":"cube.obj?rounding=none&seed=0","name":"sharp"})"),
      suite(R"({"name":"sharp","a":"./cube?rounding=none","b":")" + idOf("cube") + R"(","seeds":32})"),
      R"({"cases":[{"name":"sharp","a":"cube?rounding=none&width=32&height=24&samples=1","b":"cube?samples=1","seeds":32}],
          "schema":"chamfer.cases/1"})",
  };
  for (const std::string& body : bodies) {
    const Response again = submit(body);
    EXPECT_EQ(again.status, 200) << body << again.body;
    EXPECT_EQ(*again.header("Location"), path) << body;
  }
  for (const char* other : {R"({"name":"sharp","a":"cube?rounding=none","b":"sub/other","seeds":32})",
                            R"({"name":"blunt","a":"cube?rounding=none","b":"cube","seeds":32})"})
    EXPECT_NE(submitted(suite(other)), path);
}

TEST_F(Comparisons, VerdictsAreThoseOfTheCommandLine) {
  folder_.addCube("sub/other.obj", 0.2);
  serveJobs();
  const std::string body = suite(R"({"name":"sharp","a":"cube.obj?rounding=none","b":"cube.obj","seeds":32},
               {"name":"same","a":"cube.obj?seed=70","b":"cube.obj","seeds":16,"crop":[4,4,16,16]},
               {"name":"limit","a":"cube.obj","b":"sub/other.obj","seeds":16,"limits":{"mae":1e-7,"psnr":3}},
               {"name":"one","a":"cube.obj?aov=normal","b":"cube.obj?aov=normal&radius=0.2","seeds":1},
               {"name":"large","a":"cube.obj","b":"cube.obj?rounding=mesh:2","seeds":1,"width":300,"height":200},
               {"name":"too large","a":"cube.obj?radius=7","b":"cube.obj"})");
  const std::string path = submitted(body);
  waitFor(path, "done");

  LocalHost host(folder_.path(), folder_.path(), 1);
  SuiteControl control;
  control.each.version = CHAMFER_VERSION;
  auto expected =
      nlohmann::json::parse(comparisonJson(compareSuite(parseSuite(body, "suite"), host, control)));
  forgetMoment(expected);
  EXPECT_EQ(found(path), expected);
  EXPECT_EQ(expected["counts"]["error"], 1) << "the radius";
}

TEST_F(Comparisons, ImagesBelowTheFolderAreCompared) {
  folder_.write("ref/.keep", "");
  serveJobs();
  const Response exr = get("/v1/scenes/" + idOf("cube") + "/frames/32x24/0-4.exr");
  folder_.write("ref/cube.exr", exr.body);
  folder_.write("ref/mask.png", get("/v1/scenes/" + idOf("cube") + "/frames/32x24/0-1.png").body);
  const std::string same =
      R"({"name":"image","a":"cube?samples=4","b":"ref/cube.exr","seeds":1,"limits":{"max_error":0}})";
  const std::string path = submitted(suite(same));
  EXPECT_EQ(waitFor(path, "done")["outcome"], "same") << get(path).body;
  const std::string masked =
      R"({"name":"image","a":"cube?samples=4","b":"ref/cube.exr","seeds":1,"mask":"ref/mask.png"})";
  EXPECT_EQ(waitFor(submitted(suite(masked)), "done")["outcome"], "same");
  // Other bytes under the name: another job.
  folder_.write("ref/cube.exr", get("/v1/scenes/" + idOf("cube") + "/frames/32x24/0-5.exr").body);
  const std::string other = submitted(suite(same));
  EXPECT_NE(other, path);
  EXPECT_EQ(waitFor(other, "done")["outcome"], "differs");
}

TEST_F(Comparisons, FilesOutsideOrHiddenAreNotThere) {
  const test::TemporaryFolder outside;
  const auto secret = outside.write("secret.exr", "secret");
  folder_.write(".hidden/a.exr", "x");
  folder_.write(".b.exr", "x");
  folder_.write("text.exr", "no image");
  std::filesystem::create_directories(folder_.path() / "folder.exr");
  std::filesystem::create_symlink(secret, folder_.path() / "link.exr");
  std::filesystem::create_directory_symlink(outside.path(), folder_.path() / "away");
  std::filesystem::create_symlink(folder_.path() / ".b.exr", folder_.path() / "tohidden.exr");
  serveJobs();
  for (const std::string& name :
       {secret.string(), std::string("../secret.exr"), std::string("sub/../../secret.exr"),
        std::string("link.exr"), std::string("away/secret.exr"), std::string(".hidden/a.exr"),
        std::string(".b.exr"), std::string("./.b.exr"), std::string("tohidden.exr"), std::string("none.exr"),
        std::string("folder.exr"), std::string("text.exr")}) {
    const Response side = submit(suite(R"({"name":"n","a":"cube","b":")" + name + R"("})"));
    EXPECT_TRUE(side.status == 400 || side.status == 404) << name << side.body;
    EXPECT_EQ(json(side)["parameter"], "cases[0].b") << name;
    EXPECT_THAT(side.body, Not(HasSubstr("secret,"))) << name;
    const Response mask = submit(suite(R"({"name":"n","a":"cube","b":"cube","mask":")" + name + R"("})"));
    EXPECT_EQ(mask.status, side.status) << name;
    EXPECT_EQ(json(mask)["parameter"], "cases[0].mask") << name;
  }
  EXPECT_TRUE(json(get("/v1/comparisons")).empty());
}

TEST_F(Comparisons, LargeFilesAndPicturesAreRefused) {
  std::filesystem::resize_file(folder_.write("large.exr", ""), kMaxComparisonFileBytes + 1);
  // The head of a PNG of 16384 x 16384 pixels is enough to refuse it.
  const unsigned char head[] = {0x89, 0x50, 0x4e, 0x47, 0xd,  0xa,  0x1a, 0xa,  0x0,  0x0, 0x0,  0xd,
                                0x49, 0x48, 0x44, 0x52, 0x0,  0x0,  0x40, 0x0,  0x0,  0x0, 0x40, 0x0,
                                0x8,  0x2,  0x0,  0x0,  0x0,  0x26, 0xaa, 0x87, 0xd3, 0x0, 0x0,  0x0,
                                0x0,  0x49, 0x44, 0x41, 0x54, 0x35, 0xaf, 0x6,  0x1e};
  folder_.write("wide.png", std::string(head, head + sizeof head));
  serveJobs();
  const auto of = [](const char* file) {
    return suite(R"({"name":"n","a":")" + std::string(file) + R"(","b":"cube","seeds":1})");
  };
  EXPECT_EQ(submit(of("large.exr")).status, 413);
  const Response wide = submit(of("wide.png"));
  EXPECT_EQ(wide.status, 422) << wide.body;
  EXPECT_THAT(wide.body, HasSubstr("268435456"));
}

TEST_F(Comparisons, BadBodiesAreRefusedWithTheirPlace) {
  folder_.addCube("stale.obj");
  folder_.write("stale.obj", test::cubeObj(0.75));
  serveJobs();
  std::string many;
  for (int i = 0; i < 65; ++i)
    many += (i ? "," : "") + std::string(R"({"name":")") + std::to_string(i) + R"(","a":"cube","b":"cube"})";
  const struct {
    std::string body;
    int status;
    const char* words;
  } cases[] = {
      {"", 400, "the body"},
      {"{", 400, "the body"},
      {"[]", 400, "object"},
      {R"({"schema":"chamfer.cases/2","cases":[]})", 400, "chamfer.cases/1"},
      {suite(""), 400, "no case"},
      {suite(R"({"name":"n","a":"cube"})"), 400, "b"},
      {suite(R"({"name":"n","a":"cube","b":"cube","frobnicate":1})"), 400, "frobnicate"},
      {suite(R"({"name":"n","a":"cube?frob=1","b":"cube"})"), 400, "frob"},
      {suite(R"({"name":"n","a":"cube","b":"cube","limits":{"frob":1}})"), 400, "frob"},
      {suite(R"({"name":"n","a":"cube","b":"cube","samples":0})"), 400, "samples"},
      {suite(R"({"name":"n","a":"none","b":"cube"})"), 404, "cases[0].a"},
      {suite(R"({"name":"n","a":"cube","b":"../cube.obj"})"), 404, "cases[0].b"},
      {suite(R"({"name":"n","a":"cube","b":"cube.stl"})"), 404, "cases[0].b"},
      {suite(R"({"name":"n","a":"/v1/scenes/none/tiles/8x8/0,0,8,8/0-1.exr","b":"cube"})"), 404,
       "cases[0].a"},
      {suite(R"({"name":"n","a":"stale","b":"cube"})"), 409, "stale-sidecar"},
      {suite(R"({"name":"n","a":"cube?up_axis=y","b":"cube"})"), 422, "up_axis"},
      {suite(R"({"name":"n","a":"cube","b":"cube","width":4096,"height":4096})"), 422, "4194304"},
      {suite(R"({"name":"n","a":"cube","b":"cube","samples":1048576,"seeds":4096})"), 422, "17179869184"},
      {suite(R"({"name":"n","a":"cube","b":"cube","width":1024,"height":1024,"samples":1,"seeds":256})"), 422,
       "2147483648"},
      {suite(many), 422, "64"},
      {suite(R"({"name":"n","a":"cube","b":"cube","mask":")" + std::string(kMaxSuiteBytes, 'a') + R"("})"),
       413, "bytes"},
  };
  for (const auto& [body, status, words] : cases) {
    const Response response = submit(body);
    EXPECT_EQ(response.status, status) << body.substr(0, 200) << response.body;
    EXPECT_THAT(response.body, HasSubstr(words)) << body.substr(0, 200);
    if (status == 422 && std::string(words) != "up_axis") {
      EXPECT_TRUE(json(response)["limits"]["maximum"].is_number()) << response.body;
    }
  }
  EXPECT_EQ(ask("POST", "/v1/comparisons", {{"content-type", "text/plain"}}, suite(kSharpCase)).status, 415);
  EXPECT_TRUE(json(get("/v1/comparisons")).empty());
}

TEST_F(Comparisons, UnknownJobsAndFilesAreNotThere) {
  serveJobs();
  for (const char* id : {"00000000000000000000000000000000", "..", "%2e%2e", "x", ".locks"})
    for (const char* file : {"", "/result.json", "/report.html", "/suite.json", "/events"}) {
      EXPECT_EQ(get(std::string("/v1/comparisons/") + id + file).status, 404) << id << file;
      EXPECT_EQ(ask("DELETE", std::string("/v1/comparisons/") + id).status, 404) << id;
    }
  const std::string path = submitted(suite(endlessCase("n")));
  EXPECT_EQ(get(path + "/result.json").status, 404) << "not yet";
  for (const char* file : {"/lock", "/request.json", "/seeds", "/state.json", "/"})
    EXPECT_EQ(get(path + file).status, 404) << file;
}

TEST_F(Comparisons, MethodsAreThoseOfAllRowsOfAPath) {
  serveJobs();
  EXPECT_EQ(*ask("PUT", "/v1/comparisons").header("Allow"), "GET, HEAD, OPTIONS, POST");
  EXPECT_EQ(*ask("POST", "/v1/comparisons/x").header("Allow"), "GET, HEAD, OPTIONS, DELETE");
  EXPECT_EQ(*ask("OPTIONS", "/v1/comparisons/x").header("Allow"), "GET, HEAD, OPTIONS, DELETE");
  EXPECT_EQ(*ask("DELETE", "/v1/comparisons/x/junit.xml").header("Allow"), "GET, HEAD, OPTIONS");
}

TEST_F(Comparisons, CancelledWithinASecondAndBegunAgain) {
  serveJobs();
  const std::string body = suite(endlessCase("long")), path = submitted(body);
  for (int i = 0; i < 1000 &&
                  service_->answer(*std::make_unique<Request>(request("GET", path))).body.find("\"seeds\"") ==
                      std::string::npos;
       ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(status(path)["state"], "running");
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(ask("DELETE", path).status, 204);
  EXPECT_EQ(status(path)["state"], "cancelled");
  // The work has ended, too: the next job is taken up.
  const std::string next = submitted(suite(R"({"name":"n","a":"cube","b":"cube","seeds":1})"));
  waitFor(next, "done");
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1));
  EXPECT_TRUE(seeds(path).empty());
  EXPECT_EQ(get(path + "/result.json").status, 404);

  EXPECT_EQ(submit(body).status, 202);
  EXPECT_NE(status(path)["state"], "cancelled");
  EXPECT_EQ(ask("DELETE", path).status, 204);
  EXPECT_EQ(ask("DELETE", path).status, 204) << "of an ended one: it is removed";
  EXPECT_EQ(get(path).status, 404);
  EXPECT_EQ(ask("DELETE", next).status, 204);
  EXPECT_TRUE(json(get("/v1/comparisons")).empty());
}

TEST_F(Comparisons, TooManyAreSentAway) {
  serveJobs({.jobs = {.folder = jobs_.path(), .waiting = 2}});
  const std::string first = submitted(suite(endlessCase("1")));
  submitted(suite(endlessCase("2")));
  const Response refused = submit(suite(endlessCase("3")));
  EXPECT_EQ(refused.status, 503);
  EXPECT_NE(refused.header("Retry-After"), nullptr);
  EXPECT_EQ(submit(suite(endlessCase("2"))).status, 202) << "it is there already";
  const auto info = json(get("/v1/info"))["comparisons"];
  EXPECT_EQ(int(info["queued"]) + int(info["running"]), 2);
  EXPECT_EQ(info["places"], 2);
  ask("DELETE", first);
  EXPECT_EQ(submit(suite(endlessCase("3"))).status, 202);
}

TEST_F(Comparisons, NewsComeAsEvents) {
  serveJobs();
  const std::string path = submitted(suite(longCase("long", 128)));
  std::string id;
  int events = 0;
  for (; events < 10'000; ++events) {
    const Response news = get(path + "/events", {{"last-event-id", id}});
    if (news.status == 204) break;
    ASSERT_EQ(news.contentType, "text/event-stream");
    ASSERT_THAT(news.body, HasSubstr("\nevent: state\ndata: {"));
    const std::size_t at = news.body.find("id: ") + 4;
    const std::string next = news.body.substr(at, 32);
    EXPECT_NE(next, id) << "news only";
    id = next;
  }
  EXPECT_GT(events, 3);
  EXPECT_EQ(status(path)["state"], "done");
}

TEST_F(Comparisons, WhoWaitsForNewsIsAnsweredAtTheEnd) {
  serveJobs();
  submitted(suite(endlessCase("first")));
  const std::string path = submitted(suite(endlessCase("queued")));
  const std::string body = get(path + "/events").body;
  const std::string id = body.substr(body.find("id: ") + 4, 32);
  std::string answer;
  std::jthread waiter([&] { answer = get(path + "/events", {{"last-event-id", id}}).body; });
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_TRUE(answer.empty()) << "no news";
  const auto begin = std::chrono::steady_clock::now();
  service_->announceEnd();
  waiter.join();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1));
  EXPECT_THAT(answer, HasSubstr(": no news"));
  service_->drain();
  EXPECT_EQ(submit(suite(kSharpCase)).status, 503);
}

TEST_F(Comparisons, KeysAreAskedFor) {
  serveJobs({.keys = {"0123456789abcdef"}, .jobs = {.folder = jobs_.path()}});
  EXPECT_EQ(submit(suite(kSharpCase)).status, 401);
  const Headers key{{"authorization", "Bearer 0123456789abcdef"}};
  const Response taken = submit(suite(kSharpCase), key);
  ASSERT_EQ(taken.status, 202);
  const std::string path = *taken.header("Location");
  for (const char* file : {"", "/events", "/suite.json", "/result.json", "/report.html", "/junit.xml"})
    EXPECT_EQ(get(path + file).status, 401) << file;
  EXPECT_EQ(ask("DELETE", path).status, 401);
  EXPECT_EQ(get("/v1/comparisons").status, 401);
  EXPECT_EQ(get(path, key).status, 200);
}

TEST_F(Comparisons, AreOffWithoutAFolderAndSayHowToTurnThemOn) {
  serve();
  for (const Response& response : {submit(suite(kSharpCase)), get("/v1/comparisons"),
                                   get("/v1/comparisons/00000000000000000000000000000000/events")}) {
    EXPECT_EQ(response.status, 404);
    EXPECT_THAT(response.body, HasSubstr("--jobs"));
  }
  EXPECT_EQ(json(get("/v1/info"))["comparisons"], nullptr);
}

} // namespace
} // namespace chamfer::http
