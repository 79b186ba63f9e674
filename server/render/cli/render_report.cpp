#include "server/render/cli/render_report.h"

#include "server/render/request/render_words.h"

#include <cstdio>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

namespace chamfer {
namespace {

using Json = nlohmann::ordered_json;

double sampleCount(const RenderSettings& s) {
  return double(s.width) * double(s.height) * double(s.endSample - s.firstSample);
}

std::uint64_t peakResidentBytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::uint64_t(usage.ru_maxrss) * 1024; // Linux counts in KiB
}

Json countJson(const RayCount& c) {
  return {
      {"traced", c.traced}, {"hits", c.hits}, {"rounded", c.rounded}, {"rounded_share", c.roundedShare()}};
}

RayCount allRays(const RayStatistics& s) {
  RayCount all = s.camera;
  all += s.bounce;
  return all += s.shadow;
}

std::string line(const char* format, auto... values) {
  char text[256];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

} // namespace

std::string reportText(const RenderReport& r) {
  const RenderSettings& s = r.settings;
  std::string text;
  for (const std::string& warning : sceneOf(r.prepared).warnings)
    text += "warning: " + warning + '\n';
  text += r.output +
          line(": %ux%u, %u samples a pixel, rounding ", s.width, s.height, s.endSample - s.firstSample) +
          roundingWord(r.rounding) + '\n';
  text += line("loaded in %.2f s, prepared in %.2f s, rendered in %.2f s: %.2f million samples/s, "
               "%.2f million rays/s\n",
               r.times.load, r.times.prepare, r.times.render, sampleCount(s) / r.times.render * 1e-6,
               double(r.rays.rays()) / r.times.render * 1e-6);
  const auto kind = [&](const char* word, const RayCount& c) {
    return line("%llu %s (%.1f %% on a rounding)", static_cast<unsigned long long>(c.traced), word,
                100 * c.roundedShare());
  };
  text += "rays: " + kind("camera", r.rays.camera) + ", " + kind("bounce", r.rays.bounce) + ", " +
          kind("shadow", r.rays.shadow) + '\n';
  if (r.rays.nonFiniteSamples)
    text += line("warning: %llu samples were not finite and count as black\n",
                 static_cast<unsigned long long>(r.rays.nonFiniteSamples));
  return text;
}

std::string reportJson(const RenderReport& r) {
  const Scene& scene = sceneOf(r.prepared);
  const RenderSettings& s = r.settings;
  Json j;
  j["output"] = r.output;
  j["scene"] = scene.name;
  j["id"] = scene.id.hex();
  j["width"] = s.width;
  j["height"] = s.height;
  j["samples_per_pixel"] = s.endSample - s.firstSample;
  j["samples"] = std::uint64_t(sampleCount(s));
  j["bounces"] = s.maxBounces;
  j["clamp"] = plainNumber(s.indirectClamp);
  j["seed"] = s.seed;
  j["rounding"] = roundingWord(r.rounding);
  j["radius"] = r.rounding.radius ? Json(*r.rounding.radius) : Json();
  j["radius_clamp"] = r.rounding.radiusClamp ? Json(*r.rounding.radiusClamp) : Json();
  j["aov"] = aovWord(s.aov);
  j["seconds"] = {{"load", r.times.load},
                  {"prepare", r.times.prepare},
                  {"render", r.times.render},
                  {"write", r.times.write}};
  j["samples_per_second"] = sampleCount(s) / r.times.render;
  j["rays_per_second"] = double(r.rays.rays()) / r.times.render;
  j["rays"] = {{"camera", countJson(r.rays.camera)},
               {"bounce", countJson(r.rays.bounce)},
               {"shadow", countJson(r.rays.shadow)},
               {"all", countJson(allRays(r.rays))}};
  j["triangles"] = tracedTriangles(r.prepared);
  j["memory_bytes"] = memoryBytes(r.prepared);
  j["peak_resident_bytes"] = peakResidentBytes();
  j["non_finite_samples"] = r.rays.nonFiniteSamples;
  j["warnings"] = scene.warnings;
  return j.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

} // namespace chamfer
