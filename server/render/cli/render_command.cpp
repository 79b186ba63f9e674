#include "server/render/cli/render_command.h"

#include "common/error.h"
#include "common/progress_line.h"
#include "common/text.h"
#include "server/render/cli/render_report.h"
#include "server/render/image/image_io.h"
#include "server/render/request/render_words.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <utility>

namespace chamfer {
namespace {

using Clock = std::chrono::steady_clock;

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
  const std::string e = lowerCase(path.extension().string());
  if (e != ".png" && e != ".exr") // before any work is done
    throw Error(ErrorKind::Usage, "\"" + path.string() + "\": images are written as .png or .exr");
}

} // namespace

int runRenderCommand(const RenderCommandOptions& o) {
  checkOutput(o.output);
  RoundingChoice choice = parseRounding(o.rounding);
  choice.radius = o.radius;
  choice.radiusClamp = o.radiusClamp;
  if (o.upAxis && o.scene.extension() == ".json")
    throw Error(ErrorKind::Usage, "--up-axis is for a bare mesh; a scene file says it of each of its meshes: "
                                  "\"up_axis\": \"y\"");
  RenderSettings settings;
  settings.width = o.width;
  settings.height = o.height;
  settings.endSample = o.samples;
  settings.seed = o.seed;
  settings.maxBounces = o.bounces;
  settings.indirectClamp = float(o.indirectClamp);
  settings.aov = parseAov(o.aov);

  RenderTimes times;
  auto begin = Clock::now();
  const auto lap = [&] {
    const auto now = Clock::now();
    return std::chrono::duration<double>(now - std::exchange(begin, now)).count();
  };
  const auto scene = loadScene(o.scene, o.root, o.scene.stem().string(), o.upAxis.value_or(UpAxis::Z));
  settings.camera = cameraOf(o, scene->camera);
  times.load = lap();
  const auto prepared = prepare(scene, choice, o.threads);
  times.prepare = lap();

  RenderResult result;
  {
    ProgressLine line(!o.quiet);
    RenderControl control;
    control.threads = o.threads;
    control.progress = [&](double share) { line("rendering", share); };
    result = renderTile(*prepared, settings, {0, 0, o.width, o.height}, control);
  }
  times.render = lap();
  writeImage(o.output, result.image);
  times.write = lap();
  if (!o.quiet) {
    const RenderReport report{o.output.string(), *prepared, choice, settings, times, result.statistics};
    std::fputs((o.json ? reportJson(report) : reportText(report)).c_str(), stdout);
  }
  return 0;
}

} // namespace chamfer
