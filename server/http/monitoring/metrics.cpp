#include "server/http/monitoring/metrics.h"

#include "server/http/monitoring/process_figures.h"
#include "server/http/version.h"

#include <prometheus/counter.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>

#include <algorithm>
#include <vector>

namespace chamfer::http {
namespace {

using Labels = prometheus::Labels;
using Counter = prometheus::Counter;
using Histogram = prometheus::Histogram;

/// Seconds, from a cached answer's microseconds to the usual deadline.
const Histogram::BucketBoundaries kBuckets = {0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25,
                                              0.5,    1,     2.5,    5,     10,   25,    60,   120};

constexpr const char* kStatusClasses[] = {"2xx", "3xx", "4xx", "5xx"};
constexpr const char* kScarcityWords[kScarcities] = {
    "", "render-queue", "fair-share", "workers", "connections", "bodies", "memory"};

/// Routes by their templates; what has no route is counted under its own word.
std::string_view routeWord(std::size_t i) {
  return i < routeRows().size() ? routeRows()[i].path : std::string_view("none");
}
std::size_t routeIndex(const RouteRow* row) {
  return row ? static_cast<std::size_t>(row - routeRows().data()) : routeRows().size();
}

prometheus::MetricFamily family(const char* name, const char* help, prometheus::MetricType type) {
  prometheus::MetricFamily result;
  result.name = name;
  result.help = help;
  result.type = type;
  return result;
}

/// Values that are not counted by us but read off.
class Readings {
public:
  /// Begins a family; `kind`: Gauge or Counter.
  void begin(const char* name, const char* help,
             prometheus::MetricType kind = prometheus::MetricType::Gauge) {
    families_.push_back(family(name, help, kind));
  }
  void put(double value, const Labels& labels = {}) {
    prometheus::ClientMetric metric;
    for (const auto& [name, word] : labels)
      metric.label.push_back({name, word});
    if (families_.back().type == prometheus::MetricType::Counter)
      metric.counter.value = value;
    else
      metric.gauge.value = value;
    families_.back().metric.push_back(std::move(metric));
  }
  template <class Number>
  void gauge(const char* name, const char* help, Number value) {
    begin(name, help);
    put(static_cast<double>(value));
  }
  template <class Number>
  void counter(const char* name, const char* help, Number value) {
    begin(name, help, prometheus::MetricType::Counter);
    put(static_cast<double>(value));
  }
  std::vector<prometheus::MetricFamily> take() { return std::move(families_); }

private:
  std::vector<prometheus::MetricFamily> families_;
};

void readServer(const MetricsNow& now, Readings& out) {
  out.gauge("chamfer_render_slots", "Requests that may be rendered at one time", now.queue.slots);
  out.gauge("chamfer_render_slots_busy", "Requests being rendered", now.queue.running);
  out.gauge("chamfer_render_queue_places", "Requests that may wait for a render slot", now.queue.places);
  out.gauge("chamfer_render_queue_depth", "Requests that wait for a render slot", now.queue.waiting);
  out.gauge("chamfer_prepared_scenes", "Scenes prepared with a rounding, in the cache", now.cache.entries);
  out.gauge("chamfer_prepared_bytes", "Memory of the cache of prepared scenes", now.cache.bytes);
  out.gauge("chamfer_prepared_limit_bytes", "Limit of that memory", now.cache.limit);
  out.counter("chamfer_prepared_hits_total", "Requests that found their scene prepared", now.cache.hits);
  out.counter("chamfer_prepared_misses_total", "Requests that had their scene prepared", now.cache.builds);
  out.counter("chamfer_prepared_evictions_total", "Prepared scenes dropped to make room",
              now.cache.evictions);
  out.begin("chamfer_scenes", "Scenes of the catalogue by state");
  for (std::size_t i = 0; i < now.scenes.size(); ++i)
    out.put(static_cast<double>(now.scenes[i]), {{"state", sceneStateWord(static_cast<SceneState>(i))}});
  out.gauge("chamfer_scenes_outdated", "Ready scenes whose files have changed and cannot be loaded now",
            now.outdatedScenes);
  out.gauge("chamfer_scene_bytes", "Memory of all scenes as loaded", now.sceneBytes);
  out.gauge("chamfer_scene_limit_bytes", "Limit of that memory", now.sceneLimit);
  out.begin("chamfer_comparisons", "Comparisons that have not ended, by state");
  out.put(now.queuedComparisons, {{"state", "queued"}});
  out.put(now.runningComparisons, {{"state", "running"}});
  out.gauge("chamfer_connections_open", "Open connections", now.connections.open);
  out.gauge("chamfer_connections_busy", "Of these, with a request being handled or an answer being written",
            now.connections.busy);
  out.counter("chamfer_connections_accepted_total", "Connections since the start", now.connections.accepted);
  out.counter("chamfer_connections_dropped_total",
              "Connections closed for want of room or because their client read too slowly",
              now.connections.dropped);
  out.gauge("chamfer_draining", "1 once the server is shutting down", now.draining ? 1 : 0);
  out.begin("chamfer_build_info", "The program; always 1");
  out.put(1, {{"version", kVersion}, {"compiler", __VERSION__}});
}

/// Under the names that the client libraries of other languages use.
void readProcess(Readings& out) {
  const ProcessFigures process = processFigures();
  out.gauge("process_resident_memory_bytes", "Resident memory size in bytes", process.residentBytes);
  out.gauge("process_virtual_memory_bytes", "Virtual memory size in bytes", process.virtualBytes);
  out.gauge("process_open_fds", "Number of open file descriptors", process.openDescriptors);
  out.gauge("process_max_fds", "Maximum number of open file descriptors", process.maxDescriptors);
  out.counter("process_cpu_seconds_total", "Total user and system CPU time in seconds", process.cpuSeconds);
  out.gauge("process_start_time_seconds", "Start time of the process since the Unix epoch in seconds",
            process.startTimeSeconds);
}

} // namespace

const char* stageWord(Stage stage) {
  switch (stage) {
  case Stage::Queue:
    return "queue";
  case Stage::Prepare:
    return "prepare";
  case Stage::Render:
    return "render";
  case Stage::Encode:
    return "encode";
  }
  return "";
}

struct Metrics::Series {
  prometheus::Registry registry;
  /// By route (last: none) and by status class.
  std::vector<std::array<Counter*, std::size(kStatusClasses)>> requests;
  std::vector<Histogram*> seconds; ///< by route
  std::array<Histogram*, kStages> stages{};
  std::array<Counter*, kScarcities> sheds{}; ///< none for Scarcity::None
  Counter *bytes, *cancelled, *deadlines;
  struct Rays {
    Counter *traced, *hits, *rounded;
    void add(const RayCount& count) const {
      traced->Increment(static_cast<double>(count.traced));
      hits->Increment(static_cast<double>(count.hits));
      rounded->Increment(static_cast<double>(count.rounded));
    }
  };
  Rays camera, bounce, shadow, batch;
  Counter* nonFinite;

  Counter& counter(const char* name, const char* help, const Labels& labels = {}) {
    return prometheus::BuildCounter().Name(name).Help(help).Register(registry).Add(labels);
  }
};

Metrics::Metrics() : series_(std::make_unique<Series>()) {
  Series& s = *series_;
  for (std::size_t i = 0; i <= routeRows().size(); ++i) {
    const std::string route(routeWord(i));
    auto& classes = s.requests.emplace_back();
    for (std::size_t c = 0; c < classes.size(); ++c)
      classes[c] = &s.counter("chamfer_requests_total", "Requests answered, by route and class of status",
                              {{"route", route}, {"status", kStatusClasses[c]}});
    s.seconds.push_back(&prometheus::BuildHistogram()
                             .Name("chamfer_request_seconds")
                             .Help("From a request's last byte to its answer's first, by route")
                             .Register(s.registry)
                             .Add({{"route", route}}, kBuckets));
  }
  for (std::size_t i = 0; i < kStages; ++i)
    s.stages[i] = &prometheus::BuildHistogram()
                       .Name("chamfer_stage_seconds")
                       .Help("Stages of a rendered image: waiting for a slot, preparing the scene, "
                             "rendering, encoding")
                       .Register(s.registry)
                       .Add({{"stage", stageWord(static_cast<Stage>(i))}}, kBuckets);
  for (std::size_t i = 1; i < kScarcities; ++i)
    s.sheds[i] = &s.counter("chamfer_shed_total", "Requests sent away with 503 or 429, by what was short",
                            {{"short", kScarcityWords[i]}});
  s.bytes = &s.counter("chamfer_answer_bytes_total", "Bytes of answers' bodies");
  s.cancelled = &s.counter("chamfer_cancelled_total", "Requests given up because their client was gone");
  s.deadlines = &s.counter("chamfer_deadlines_total", "Requests given up at the server's own deadline");
  const auto rays = [&](const char* kind) {
    const Labels label{{"kind", kind}};
    return Series::Rays{
        &s.counter("chamfer_rays_total", "Rays of finished images and batches, by kind", label),
        &s.counter("chamfer_hits_total", "Of these, those that hit something", label),
        &s.counter("chamfer_rounded_hits_total", "Of these, those that hit a rounded edge or corner", label)};
  };
  s.camera = rays("camera");
  s.bounce = rays("bounce");
  s.shadow = rays("shadow");
  s.batch = rays("batch");
  s.nonFinite = &s.counter("chamfer_non_finite_samples_total", "Samples that were not finite, shown black");
}

Metrics::~Metrics() = default;

void Metrics::answered(const RouteRow* row, int status, double seconds, std::size_t bytes) {
  const std::size_t route = routeIndex(row);
  const int statusClass = std::clamp(status / 100 - 2, 0, 3);
  series_->requests[route][static_cast<std::size_t>(statusClass)]->Increment();
  series_->seconds[route]->Observe(seconds);
  series_->bytes->Increment(static_cast<double>(bytes));
}

void Metrics::refused(const Problem& problem) {
  if (problem.status == kStatusClientGone) series_->cancelled->Increment();
  if (problem.status == 504) series_->deadlines->Increment();
  if (problem.scarcity != Scarcity::None)
    series_->sheds[static_cast<std::size_t>(problem.scarcity)]->Increment();
}

void Metrics::took(Stage stage, double seconds) {
  series_->stages[static_cast<std::size_t>(stage)]->Observe(seconds);
}

void Metrics::traced(const RayStatistics& rays) {
  series_->camera.add(rays.camera);
  series_->bounce.add(rays.bounce);
  series_->shadow.add(rays.shadow);
  series_->nonFinite->Increment(static_cast<double>(rays.nonFiniteSamples));
}

void Metrics::tracedBatch(const RayCount& rays) { series_->batch.add(rays); }

std::string Metrics::text(const MetricsNow& now) const {
  std::vector<prometheus::MetricFamily> families = series_->registry.Collect();
  Readings readings;
  readServer(now, readings);
  readProcess(readings);
  for (prometheus::MetricFamily& reading : readings.take())
    families.push_back(std::move(reading));
  return prometheus::TextSerializer().Serialize(families);
}

} // namespace chamfer::http
