// Many paths at once, bounce by bounce: the light along each is what PathTracer::radiance() gives, bit for
// bit, whatever paths it travels with. Rays are traced in packets that way, and common surfaces shaded in
// lanes.
//
// The paths of a wave stay in the second-level cache of their thread's core: some hundred of them. Larger
// waves, over a whole picture, would go through memory at every bounce.
#pragma once

#include "server/render/wavefront/shade.h"

#include <vector>

namespace chamfer {

/// Lives in one thread.
class Wavefront {
public:
  static constexpr std::size_t kPaths = 512; ///< in a wave, about

  /// `paths` must outlive it.
  explicit Wavefront(const PathTracer& paths)
      : tracer_(paths), lights_(paths.lights()), inLanes_(!paths.lights().triangles().anyRounded()) {}

  void clear();
  /// Adds a camera ray's path; `from` must live until the wave has been followed. Returns its number.
  std::size_t add(const Ray& ray, const PathState& from, const Sampler& sampler);
  /// Follows all paths to their ends.
  void follow(RayStatistics& statistics);
  const Color& light(std::size_t path) const { return paths_[path].sum; } ///< after follow()

private:
  // The stages of a bounce.
  void trace(RayStatistics& statistics);
  void meet(RayStatistics& statistics);
  void shade();
  void addUnshadowed(RayStatistics& statistics);
  bool isCommon(const Crossing& crossing, const PathState& state) const;

  const PathTracer& tracer_;
  LightSampler lights_;
  bool inLanes_; ///< common vertices are shaded in lanes: rounded lights are none to them
  std::vector<Path> paths_;
  std::vector<const PathState*> from_;
  std::vector<TraceHit> hits_;
  std::vector<Arrival> arrivals_;
  std::vector<std::uint32_t> active_; ///< numbers of the paths that go on, ascending
  std::vector<std::uint32_t> next_;   ///< of those that have gone on already
  std::vector<RayTask> tasks_;        ///< of the active ones
  VertexGroup common_;
  std::vector<ShadowTask> shadows_;
  std::vector<ShadowLight> shadowLights_; ///< by shadow
  bool cameraRays_ = true;
};

} // namespace chamfer
