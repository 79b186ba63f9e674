// GET /metrics: the format, what is counted, and that requests cannot make series.
#include "tests/http/metrics_text.h"
#include "tests/http/service_fixture.h"

#include <gmock/gmock.h>
#include <regex>
#include <set>

namespace chamfer::http {
namespace {

using test::Series;

class MetricsRoute : public test::ServiceTest {
protected:
  MetricsRoute() { folder_.addCube("cube.obj"); }
  Series series() { return test::seriesOf(get("/metrics").body); }
  std::string tile(const std::string& rest = "32x32/0,0,32,32/0-1.f16") {
    return "/v1/scenes/" + idOf("cube") + "/tiles/" + rest;
  }
};

constexpr const char* kTileRoute =
    "/v1/scenes/{scene}/tiles/{width}x{height}/{x},{y},{w},{h}/{s0}-{s1}.{format}";
std::string requests(const std::string& route, const std::string& status) {
  return "chamfer_requests_total{route=\"" + route + "\",status=\"" + status + "\"}";
}

TEST_F(MetricsRoute, IsWellFormedExposition) {
  serve();
  get(tile());
  const Response response = get("/metrics");
  EXPECT_EQ(response.contentType, "text/plain; version=0.0.4; charset=utf-8");
  EXPECT_EQ(*response.header("Cache-Control"), "no-store");
  const std::regex comment("# (HELP|TYPE) ([a-z_]+) .+"),
      sample(R"(([a-z_]+?)(_bucket|_sum|_count)?(\{([a-z]+="[^"]*",?)+\})? [-+.e0-9]+(Inf)?)");
  std::set<std::string> typed;
  std::istringstream lines(response.body);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (line.starts_with('#')) {
      ASSERT_TRUE(std::regex_match(line, match, comment)) << line;
      if (match[1] == "TYPE") {
        EXPECT_TRUE(typed.insert(match[2]).second) << "two families of one name: " << line;
      }
      continue;
    }
    ASSERT_TRUE(std::regex_match(line, match, sample)) << line;
    EXPECT_TRUE(typed.contains(match[1]) || typed.contains(match[1].str() + match[2].str())) << line;
  }
  EXPECT_GT(typed.size(), 30u);
}

TEST_F(MetricsRoute, HistogramsAreCumulativeAndEndAtTheirCount) {
  serve();
  for (int i = 0; i < 3; ++i)
    get(tile());
  const std::string text = get("/metrics").body;
  double last = 0;
  int buckets = 0;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("chamfer_stage_seconds_bucket{stage=\"render\"")) {
      const double value = std::stod(line.substr(line.rfind(' ')));
      EXPECT_GE(value, last) << line;
      last = value;
      ++buckets;
    }
  EXPECT_GT(buckets, 10);
  const Series all = test::seriesOf(text);
  EXPECT_EQ(last, 3);
  EXPECT_EQ(all.at("chamfer_stage_seconds_count{stage=\"render\"}"), 3);
  EXPECT_GT(all.at("chamfer_stage_seconds_sum{stage=\"render\"}"), 0);
  for (const char* stage : {"queue", "prepare", "encode"})
    EXPECT_EQ(all.at("chamfer_stage_seconds_count{stage=\"" + std::string(stage) + "\"}"), 3) << stage;
}

TEST_F(MetricsRoute, CountsRequestsRaysAndCache) {
  folder_.write("broken.scene.json", "{");
  serve({.slots = 3, .waiting = 7});
  const Response image = get(tile());
  get(tile(), {{"if-none-match", *image.header("ETag")}});
  get(tile("bad"));
  get(tile());
  get("/v1/scenes/none");
  get("/v1/no/such/thing");
  rays("cube", R"({"rays":[[0,0,5,0,0,-1],[0.49,0,5,0,0,-1],[9,9,5,0,0,-1]]})");
  const Series s = series();
  EXPECT_EQ(s.at(requests(kTileRoute, "2xx")), 2);
  EXPECT_EQ(s.at(requests(kTileRoute, "3xx")), 1);
  EXPECT_EQ(s.at(requests(kTileRoute, "4xx")), 1);
  EXPECT_EQ(s.at(requests("/v1/scenes/{scene}", "4xx")), 1);
  EXPECT_EQ(s.at(requests("none", "4xx")), 1);
  EXPECT_EQ(s.at("chamfer_request_seconds_count{route=\"/v1/scenes/{scene}/rays\"}"), 1);
  EXPECT_EQ(s.at("chamfer_rays_total{kind=\"camera\"}"), 2 * 32 * 32);
  EXPECT_EQ(s.at("chamfer_rays_total{kind=\"batch\"}"), 3);
  const auto images = [&](const std::string& name) {
    return s.at(name + "{kind=\"camera\"}") + s.at(name + "{kind=\"bounce\"}");
  };
  EXPECT_EQ(images("chamfer_rays_total") + s.at("chamfer_rays_total{kind=\"shadow\"}"),
            2 * std::stod(*image.header("X-Chamfer-Rays")));
  EXPECT_EQ(images("chamfer_hits_total"), 2 * std::stod(*image.header("X-Chamfer-Hits")));
  EXPECT_EQ(images("chamfer_rounded_hits_total"), 2 * std::stod(*image.header("X-Chamfer-Rounded")));
  EXPECT_EQ(s.at("chamfer_hits_total{kind=\"batch\"}"), 2);
  EXPECT_EQ(s.at("chamfer_rounded_hits_total{kind=\"batch\"}"), 1);
  EXPECT_EQ(s.at("chamfer_prepared_misses_total"), 1);
  EXPECT_EQ(s.at("chamfer_prepared_hits_total"), 2);
  EXPECT_EQ(s.at("chamfer_prepared_scenes"), 1);
  EXPECT_GT(s.at("chamfer_prepared_bytes"), 0);
  EXPECT_EQ(s.at("chamfer_scenes{state=\"ready\"}"), 1);
  EXPECT_EQ(s.at("chamfer_scenes{state=\"failed\"}"), 1);
  EXPECT_EQ(s.at("chamfer_render_slots"), 3);
  EXPECT_EQ(s.at("chamfer_render_queue_places"), 7);
  EXPECT_EQ(s.at("chamfer_render_slots_busy"), 0);
  EXPECT_GT(s.at("process_resident_memory_bytes"), 1e6);
  EXPECT_GT(s.at("process_open_fds"), 2);
  EXPECT_GE(s.at("chamfer_answer_bytes_total"), 2 * image.body.size());
  const double began = s.at("process_start_time_seconds"), now = static_cast<double>(std::time(nullptr));
  EXPECT_GT(began, now - 3600);
  EXPECT_LT(began, now + 60);
}

TEST_F(MetricsRoute, CountsCancellationsDeadlinesAndSheds) {
  const std::string slow = "4096x4096/0,0,1024,1024/0-1024.f16";
  serve({.threads = 1, .slots = 1, .waiting = 0, .deadline = std::chrono::milliseconds(400)});
  Request request = this->request("GET", tile(slow));
  std::jthread renderer([&] { service_->answer(request); });
  for (int i = 0; i < 500 && series().at("chamfer_render_slots_busy") != 1; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_EQ(get(tile()).status, 503);
  *request.cancelled.clientGone = true;
  renderer.join();
  EXPECT_EQ(get(tile(slow)).status, 504);
  const Series s = series();
  EXPECT_EQ(s.at("chamfer_cancelled_total"), 1);
  EXPECT_EQ(s.at("chamfer_deadlines_total"), 1);
  EXPECT_EQ(s.at("chamfer_shed_total{short=\"render-queue\"}"), 1);
  EXPECT_EQ(s.at("chamfer_rays_total{kind=\"camera\"}"), 0) << "nothing was finished";
}

TEST_F(MetricsRoute, RequestsMakeNoSeries) {
  serve();
  const std::size_t before = series().size();
  for (int i = 0; i < 50; ++i) {
    const std::string name = std::to_string(i);
    get("/v1/scenes/" + name, {{"x-request-id", name}, {"user-agent", name}});
    get("/" + name + ".html");
    get(tile(name + "x1/0,0,1,1/0-1.f16"));
    ask("M" + name, "/v1/info");
  }
  EXPECT_EQ(series().size(), before);
}

TEST_F(MetricsRoute, AsksForTheKey) {
  serve({.keys = {"0123456789abcdef"}});
  EXPECT_EQ(get("/metrics").status, 401);
  EXPECT_EQ(get("/metrics", {{"authorization", "Bearer 0123456789abcdef"}}).status, 200);
}

} // namespace
} // namespace chamfer::http
