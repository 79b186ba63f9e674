// A service that takes comparisons, with one scene "cube".
#pragma once

#include "server/http/comparisons/comparisons.h"
#include "tests/http/service_fixture.h"
#include "tests/support/temporary_folder.h"

namespace chamfer::test {

class ComparisonsTest : public ServiceTest {
protected:
  ComparisonsTest() { folder_.addCube("cube.obj"); }
  ~ComparisonsTest() override { service_.reset(); } // before the folder of its jobs

  void serveJobs(http::ServiceOptions options = {}) {
    if (options.jobs.folder.empty()) options.jobs.folder = jobs_.path();
    serve(std::move(options));
  }
  /// `cases`: JSON of one or more, without brackets.
  static std::string suite(const std::string& cases) {
    return R"({"schema":"chamfer.cases/1","defaults":{"width":32,"height":24,"samples":1},"cases":[)" +
           cases + "]}";
  }
  /// Sides that are the same, so small a resolution that all seeds are rendered.
  static std::string longCase(const std::string& name, int seeds = 256) {
    return R"({"name":")" + name + R"(","a":"cube","b":"cube?seed=100000","seeds":)" + std::to_string(seeds) +
           R"(,"statistics":{"resolution":{"pixel":1e-9,"block":1e-9,"image":1e-9}}})";
  }
  /// One whose first seed takes minutes.
  static std::string endlessCase(const std::string& name) {
    return R"({"name":")" + name +
           R"(","a":"cube","b":"cube?seed=9999","samples":30000,"width":256,"height":256,"seeds":2})";
  }
  http::Response submit(const std::string& body, http::Headers headers = {}) {
    headers.emplace_back("content-type", "application/json");
    return ask("POST", "/v1/comparisons", std::move(headers), body);
  }
  /// The path of the job.
  std::string submitted(const std::string& body) {
    const http::Response response = submit(body);
    EXPECT_TRUE(response.status == 202 || response.status == 200) << response.body;
    return response.header("Location") ? *response.header("Location") : "";
  }
  static std::string idOfJob(const std::string& path) { return path.substr(path.rfind('/') + 1); }
  nlohmann::json status(const std::string& path) { return json(get(path)); }
  nlohmann::json waitFor(const std::string& path, const std::string& state) {
    nlohmann::json job;
    for (int i = 0; i < 6000; ++i) {
      job = status(path);
      if (job["state"] == state) return job;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ADD_FAILURE() << "not " << state << ": " << job.dump(1);
    return job;
  }
  /// Waits until so many seeds lie in the job's folder.
  std::size_t waitForSeeds(const std::string& path, std::size_t count) {
    std::size_t now = 0;
    for (int i = 0; i < 3000 && (now = seeds(path).size()) < count; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    EXPECT_GE(now, count);
    return now;
  }
  /// Whole files with the times at which they were written.
  std::map<std::string, std::filesystem::file_time_type> seeds(const std::string& path) const {
    std::map<std::string, std::filesystem::file_time_type> found;
    std::error_code error;
    const auto folder = jobs_.path() / idOfJob(path) / "seeds";
    for (auto entry = std::filesystem::directory_iterator(folder, error);
         !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
      const std::string name = entry->path().filename().string();
      if (name.size() == 32 + 4) found[name] = entry->last_write_time(error);
    }
    return found;
  }
  /// Are they gone, or soon?
  bool withoutSeeds(const std::string& path) const {
    const auto folder = jobs_.path() / idOfJob(path) / "seeds";
    for (int i = 0; i < 200 && std::filesystem::exists(folder); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return !std::filesystem::exists(folder);
  }
  /// What was found, without what is of the moment.
  nlohmann::json found(const std::string& path) {
    nlohmann::json result = json(get(path + "/result.json"));
    forgetMoment(result);
    return result;
  }
  static void forgetMoment(nlohmann::json& result) {
    for (const char* key : {"started", "seconds", "command"})
      result.erase(key);
    for (nlohmann::json& one : result["cases"])
      for (const char* key : {"seconds", "command"})
        one.erase(key);
  }

  TemporaryFolder jobs_;
};

} // namespace chamfer::test
