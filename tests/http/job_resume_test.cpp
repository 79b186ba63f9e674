// Jobs whose server ends, nicely or not, and jobs that several servers share.
#include "tests/http/comparisons_fixture.h"

#include "tests/http/http_client.h"
#include "tests/http/program.h"

#include <fstream>
#include <gmock/gmock.h>

namespace chamfer::http {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

class JobResume : public test::ComparisonsTest {
protected:
  /// What an undisturbed run finds, in a folder of its own.
  nlohmann::json undisturbed(const std::string& body) {
    const test::TemporaryFolder other;
    serveJobs({.jobs = {.folder = other.path()}});
    const std::string path = submitted(body);
    waitFor(path, "done");
    nlohmann::json result = found(path);
    service_.reset();
    return result;
  }
};

TEST_F(JobResume, AStoppedJobGoesOnAtTheFirstMissingSeed) {
  const std::string body = suite(longCase("one", 64) + ',' + longCase("two", 128) +
                                 R"(,{"name":"sharp","a":"cube?rounding=none","b":"cube"})");
  const auto expected = undisturbed(body);
  serveJobs();
  const std::string path = submitted(body);
  waitForSeeds(path, 20);
  const auto begin = std::chrono::steady_clock::now();
  service_.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1));
  const auto before = seeds(path);
  ASSERT_GE(before.size(), 20u);
  serveJobs();
  const auto after = [&] {
    waitForSeeds(path, before.size() + 20);
    return seeds(path);
  }();
  for (const auto& [name, time] : before)
    EXPECT_TRUE(after.contains(name) && after.at(name) == time) << name << " was rendered again";
  waitFor(path, "done");
  EXPECT_EQ(found(path), expected);
}

TEST_F(JobResume, AKilledServerLosesNoFinishedSeed) {
  const std::string body = suite(longCase("one", 64) + ',' + longCase("two", 128) +
                                 R"(,{"name":"sharp","a":"cube?rounding=none","b":"cube"})");
  const auto expected = undisturbed(body);
  const std::vector<std::string> arguments{"serve",  folder_.path().string(), "--port",      "0",
                                           "--jobs", jobs_.path().string(),   "--log-level", "error"};
  std::string path;
  std::map<std::string, fs::file_time_type> before;
  for (int round = 0; round < 3; ++round) {
    test::Program program(arguments);
    const int port = program.port();
    if (round == 0) path = test::post(port, "/v1/comparisons", body).header("location");
    ASSERT_FALSE(path.empty());
    waitForSeeds(path, before.size() + 25);
    program.signal(SIGKILL);
    EXPECT_EQ(program.finish(), -1);
    const auto after = seeds(path);
    EXPECT_GT(after.size(), before.size());
    for (const auto& [name, time] : before)
      EXPECT_TRUE(after.contains(name) && after.at(name) == time) << name << " was rendered again";
    before = after;
  }
  serveJobs();
  const auto job = waitFor(path, "done");
  EXPECT_EQ(found(path), expected);
  EXPECT_TRUE(withoutSeeds(path));
}

TEST_F(JobResume, SigtermStopsAJobAtOnce) {
  test::Program program({"serve", folder_.path().string(), "--port", "0", "--jobs", jobs_.path().string()});
  const int port = program.port();
  const std::string path = test::post(port, "/v1/comparisons", suite(endlessCase("n"))).header("location");
  for (int i = 0; i < 500 && test::get(port, path).body.find("\"running\"") == std::string::npos; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  const auto begin = std::chrono::steady_clock::now();
  program.signal(SIGTERM);
  EXPECT_EQ(program.finish(), 0);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(2));
  serveJobs();
  waitFor(path, "running");
}

TEST_F(JobResume, ASceneThatIsAnotherByThenIsAnError) {
  serveJobs();
  const std::string path = submitted(suite(longCase("long") + ',' + endlessCase("rest")));
  waitForSeeds(path, 4);
  service_.reset();
  folder_.addCube("cube.obj", 0.2);
  serveJobs();
  const auto job = waitFor(path, "done");
  EXPECT_EQ(job["outcome"], "error");
  for (const auto& one : job["cases"]) {
    EXPECT_EQ(one["outcome"], "error");
    EXPECT_THAT(std::string(one["reason"]), HasSubstr("not what it was when the comparison was submitted"));
  }
}

TEST_F(JobResume, AnImageThatIsAnotherByThenIsAnError) {
  serveJobs();
  folder_.write("ref.png", get("/v1/scenes/" + idOf("cube") + "/frames/32x24/0-1.png").body);
  const std::string path =
      submitted(suite(endlessCase("first") + R"(,{"name":"image","a":"cube","b":"ref.png","seeds":1})"));
  service_.reset();
  folder_.write("ref.png", "something else");
  // The first case is in the way: its budget is made small, as if it had ended.
  const auto file = jobs_.path() / idOfJob(path) / "request.json";
  auto request = nlohmann::json::parse(std::ifstream(file));
  request["suite"]["cases"].erase(0);
  std::ofstream(file) << request.dump();
  serveJobs();
  const auto job = waitFor(path, "done");
  EXPECT_EQ(job["outcome"], "error");
  EXPECT_THAT(std::string(job["cases"][0]["reason"]), HasSubstr("not what it was"));
}

TEST_F(JobResume, AJobOfAnotherVersionOrADamagedOneFailsAndSaysSo) {
  serveJobs();
  const std::string path = submitted(suite(endlessCase("n")));
  service_.reset();
  const auto file = jobs_.path() / idOfJob(path) / "request.json";
  auto request = nlohmann::json::parse(std::ifstream(file));
  request["version"] = "0.0.1";
  std::ofstream(file) << request.dump();
  serveJobs();
  auto job = waitFor(path, "failed");
  EXPECT_THAT(std::string(job["detail"]), HasSubstr("0.0.1"));
  EXPECT_EQ(submit(suite(endlessCase("n"))).status, 202) << "submitted again it begins again";
  waitFor(path, "running");
  service_.reset();
  std::ofstream(file) << "{";
  serveJobs();
  job = waitFor(path, "failed");
  EXPECT_EQ(get(path + "/suite.json").status, 404);
}

TEST_F(JobResume, AJobThatEndsItsServerAgainAndAgainIsGivenUp) {
  const std::vector<std::string> arguments{"serve",  folder_.path().string(), "--port",      "0",
                                           "--jobs", jobs_.path().string(),   "--log-level", "error"};
  std::string path;
  for (int round = 0; round < 5; ++round) {
    test::Program program(arguments);
    const int port = program.port();
    if (round == 0) path = test::post(port, "/v1/comparisons", suite(endlessCase("n"))).header("location");
    ASSERT_FALSE(path.empty());
    for (int i = 0; i < 500 && test::get(port, path).body.find("\"most_seeds\"") == std::string::npos; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    program.signal(SIGKILL);
    program.finish();
  }
  serveJobs();
  EXPECT_THAT(std::string(waitFor(path, "failed")["detail"]), HasSubstr("5 times"));
  // Stopped in good order it is none of these.
  for (int round = 0; round < 7; ++round) {
    submit(suite(endlessCase("n")));
    waitFor(path, "running");
    serveJobs();
  }
  waitFor(path, "running");
}

TEST_F(JobResume, AnyNodeAnswersForAJobOnSharedStorage) {
  serveJobs();
  const std::string path = submitted(suite(endlessCase("long"))),
                    next = submitted(suite(longCase("short", 64)));
  waitFor(path, "running");
  auto one = std::move(service_);
  service_ =
      std::make_unique<Service>(ServiceOptions{.jobs = {.folder = jobs_.path()}}, *catalogue_, StaticFiles());
  waitFor(next, "done"); // the second node has it, since the first one is busy
  for (int i = 0; i < 300 && status(path)["progress"].is_null(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  const auto job = status(path);
  EXPECT_EQ(job["state"], "running");
  EXPECT_THAT(std::string(job["node"]), HasSubstr(":"));
  EXPECT_EQ(job["progress"]["name"], "long");
  // It goes on here when the other node ends.
  one.reset();
  waitFor(path, "running");
  // A third one cancels what the second works on.
  auto two = std::move(service_);
  service_ =
      std::make_unique<Service>(ServiceOptions{.jobs = {.folder = jobs_.path()}}, *catalogue_, StaticFiles());
  EXPECT_EQ(ask("DELETE", path).status, 204);
  const JobStore store({.folder = jobs_.path()}, folder_.path());
  const auto begin = std::chrono::steady_clock::now();
  while (store.running(idOfJob(path)) && std::chrono::steady_clock::now() - begin < std::chrono::seconds(5))
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1));
  EXPECT_EQ(status(path)["state"], "cancelled");
}

} // namespace
} // namespace chamfer::http
