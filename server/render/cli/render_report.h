// What a finished render took: for people, and as JSON for programs (benchmarks).
#pragma once

#include "server/render/path/render.h"

#include <string>

namespace chamfer {

/// Seconds of wall time.
struct RenderTimes {
  double load = 0;    ///< files, the roundings that they ask for, hierarchies of the sharp meshes
  double prepare = 0; ///< what the rounding asked for needs beyond that, the top-level hierarchy, lights
  double render = 0;
  double write = 0;
};

struct RenderReport {
  std::string output; ///< file written
  const PreparedScene& prepared;
  const RoundingChoice& rounding;
  const RenderSettings& settings;
  RenderTimes times;
  RayStatistics rays;
};

/// A few lines, each ended by a newline; the scene's warnings first.
std::string reportText(const RenderReport& report);

/// One object: output, scene, id, width, height, samples_per_pixel, samples (pixels times that), bounces,
/// clamp, seed, rounding, radius and radius_clamp (null: the scene's), aov; seconds {load, prepare, render,
/// write}; samples_per_second and rays_per_second (of the render alone); rays {camera, bounce, shadow, all:
/// {traced, hits, rounded, rounded_share}}, rounded_share being rounded / traced; triangles (traced, over all
/// instances), memory_bytes (geometry, hierarchies, roundings, textures, lights), peak_resident_bytes (of the
/// whole process), non_finite_samples, warnings [text]. Ends with a newline.
std::string reportJson(const RenderReport& report);

} // namespace chamfer
