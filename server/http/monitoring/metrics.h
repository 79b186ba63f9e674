// Figures for Prometheus (GET /metrics), kept through the Prometheus client library (prometheus-cpp, its core
// only), which is known in metrics.cpp and nowhere else. No label takes a value from a request: there is one
// series for each row of the route table, each stage and so on, however long the server runs.
#pragma once

#include "server/http/catalogue/catalogue.h"
#include "server/http/catalogue/prepared_cache.h"
#include "server/http/connection/connection_loop.h"
#include "server/http/queue/render_queue.h"
#include "server/http/routes/problem.h"
#include "server/http/routes/route_table.h"

#include <array>
#include <cstdint>
#include <memory>
#include <string>

namespace chamfer::http {

/// Text format 0.0.4.
inline constexpr const char* kMetricsMediaType = "text/plain; version=0.0.4; charset=utf-8";

/// Of an image's way, as Server-Timing names them.
enum class Stage : std::uint8_t { Queue, Prepare, Render, Encode };
inline constexpr std::size_t kStages = 4;
const char* stageWord(Stage stage);

/// What is read off at the moment of asking.
struct MetricsNow {
  RenderQueue::State queue{};
  PreparedCache::State cache{};
  std::array<std::size_t, kSceneStates> scenes{}; ///< by SceneState
  std::size_t outdatedScenes = 0, sceneBytes = 0, sceneLimit = 0;
  ConnectionCounts connections{};
  unsigned queuedComparisons = 0, runningComparisons = 0;
  bool draining = false;
};

/// Counting takes some atomic additions and may be done from any thread.
class Metrics {
public:
  Metrics();
  ~Metrics();
  Metrics(const Metrics&) = delete;
  Metrics& operator=(const Metrics&) = delete;

  /// A request was answered. `row` nullptr: refused before its route was known, or it has none.
  void answered(const RouteRow* row, int status, double seconds, std::size_t bytes);
  /// It was answered with this problem: counts cancellations, deadlines and what was sent away.
  void refused(const Problem& problem);
  void took(Stage stage, double seconds);
  /// Of an image that was finished.
  void traced(const RayStatistics& rays);
  /// Of a batch of rays.
  void tracedBatch(const RayCount& rays);

  std::string text(const MetricsNow& now) const;

private:
  struct Series;
  std::unique_ptr<Series> series_;
};

} // namespace chamfer::http
