// Shading of common vertices in lanes: opaque surfaces whose shading normal is the surface's own, on paths
// that no medium concerns. As PathTracer::scatter() does it, bit for bit.
#pragma once

#include "server/render/path/path_tracer.h"
#include "server/render/wavefront/light_lanes.h"
#include "server/render/wavefront/opaque_lanes.h"

namespace chamfer {

/// Light on its way to a vertex; it counts if nothing is in the way.
struct ShadowLight {
  std::uint32_t path;
  Color light;
};

/// Eight vertices at most, gathered one by one.
class VertexGroup {
public:
  bool empty() const { return count_ == 0; }
  bool full() const { return count_ == kLanes; }
  /// `state` must live until shade().
  void add(std::uint32_t number, const Path& path, const TraceHit& hit, const SurfaceValues& surface,
           const PathState& state);
  /// Sends the paths on in new directions: `goesOn` is told the number of each that goes on. Light that comes
  /// to the vertices directly is added to `shadows` and `lights`, to be looked for.
  template <class GoesOn>
  void shade(const PathTracer& tracer, const LightSampler& lightSampler, std::vector<Path>& paths,
             std::vector<ShadowTask>& shadows, std::vector<ShadowLight>& lights, GoesOn&& goesOn) {
    scatter(tracer, lightSampler, paths, shadows, lights);
    for (std::size_t i = 0; i < count_; ++i)
      if (valid_[i] && tracer.goOn(paths[numbers_[i]], weight_[i], pdf_[i], delta_[i], 1))
        goesOn(numbers_[i]);
    count_ = 0;
  }

private:
  void scatter(const PathTracer& tracer, const LightSampler& lightSampler, std::vector<Path>& paths,
               std::vector<ShadowTask>& shadows, std::vector<ShadowLight>& lights);

  std::size_t count_ = 0;
  std::uint32_t numbers_[kLanes];
  const PathState* states_[kLanes];
  Point3 positions_[kLanes];
  Vector3 upwards_[kLanes]; ///< the normal, on the side that the path came from
  VectorLaneFloats normal_, outgoing_;
  OpaqueSurfaces surfaces_;
  PointWords choice_, light_, scatter_; ///< random numbers, by PathPair
  // What comes out.
  ColorLaneFloats weight_;
  LaneFloats pdf_;
  bool valid_[kLanes], delta_[kLanes];
};

} // namespace chamfer
