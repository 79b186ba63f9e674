#include "server/render/render_command.h"

#include "common/error.h"
#include "server/render/image_io.h"
#include "server/render/render_words.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <unistd.h>

namespace chamfer {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::optional<Camera> cameraOf(const RenderCommandOptions& o, const Camera& own) {
  if (!o.eye && !o.target && !o.up && !o.vfovDegrees) return {};
  Camera c = own;
  if (o.eye) c.eye = *o.eye;
  if (o.target) c.target = *o.target;
  if (o.up) c.up = *o.up;
  if (o.vfovDegrees) c.vfovDegrees = *o.vfovDegrees;
  return c;
}

void checkOutput(const std::filesystem::path& path) {
  const std::string e = path.extension().string();
  if (e != ".png" && e != ".exr") // before any work is done
    throw Error(ErrorKind::Usage, "\"" + path.string() + "\": images are written as .png or .exr");
}

/// A line on standard error, rewritten at each full percent; only where somebody looks.
class ProgressLine {
public:
  explicit ProgressLine(bool quiet) : shown_(!quiet && isatty(STDERR_FILENO)) {}
  ~ProgressLine() {
    if (percent_ >= 0) std::fputs("\r                \r", stderr);
  }
  void operator()(double share) {
    if (!shown_) return;
    const int percent = int(share * 100);
    int before = percent_;
    while (before < percent && !percent_.compare_exchange_weak(before, percent)) {
    }
    if (before < percent) std::fprintf(stderr, "\rrendering %3d %%", percent);
  }

private:
  bool shown_;
  std::atomic<int> percent_{-1};
};

void printSummary(const RenderCommandOptions& o, const Scene& scene, const RayStatistics& s, double load,
                  double seconds) {
  for (const std::string& warning : scene.warnings)
    std::printf("warning: %s\n", warning.c_str());
  const double samples = double(o.width) * o.height * o.samples;
  const double rounded = s.hits ? 100.0 * double(s.roundedHits) / double(s.hits) : 0;
  std::printf("%s: %ux%u, %u samples a pixel, rounding %s\n", o.output.string().c_str(), o.width, o.height,
              o.samples, o.rounding.c_str());
  std::printf("loaded in %.2f s, rendered in %.2f s: %.2f million samples/s, %.2f million rays/s\n", load,
              seconds, samples / seconds * 1e-6, double(s.rays()) / seconds * 1e-6);
  std::printf("rays: %llu camera, %llu bounce, %llu shadow; %.1f %% of the hits on a rounding\n",
              static_cast<unsigned long long>(s.cameraRays), static_cast<unsigned long long>(s.bounceRays),
              static_cast<unsigned long long>(s.shadowRays), rounded);
  if (s.nonFiniteSamples)
    std::printf("warning: %llu samples were not finite and count as black\n",
                static_cast<unsigned long long>(s.nonFiniteSamples));
}

} // namespace

int runRenderCommand(const RenderCommandOptions& o) {
  checkOutput(o.output);
  RoundingChoice choice = parseRounding(o.rounding);
  choice.radius = o.radius;
  RenderSettings settings;
  settings.width = o.width;
  settings.height = o.height;
  settings.endSample = o.samples;
  settings.seed = o.seed;
  settings.maxBounces = o.bounces;
  settings.aov = parseAov(o.aov);

  const auto start = Clock::now();
  const auto scene = loadScene(o.scene, o.root, o.scene.stem().string());
  settings.camera = cameraOf(o, scene->camera);
  const auto prepared = prepare(scene, choice, o.threads);
  const double load = secondsSince(start);

  const auto begin = Clock::now();
  RenderResult result;
  {
    ProgressLine line(o.quiet);
    RenderControl control;
    control.threads = o.threads;
    control.progress = [&](double share) { line(share); };
    result = renderTile(*prepared, settings, {0, 0, o.width, o.height}, control);
  }
  const double seconds = secondsSince(begin);
  writeImage(o.output, result.image);
  if (!o.quiet) printSummary(o, *scene, result.statistics, load, seconds);
  return 0;
}

} // namespace chamfer
