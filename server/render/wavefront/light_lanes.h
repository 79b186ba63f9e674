// Lights::sample() for eight points at once. Sharp triangles, where there are few enough to weigh each of
// them at every point, are chosen and sampled in lanes, formula by formula as TriangleLights::sample(); what
// else shines is asked lane by lane. A lane's bits are the scalar's.
#pragma once

#include "server/render/light/lights.h"
#include "server/render/wavefront/lanes.h"

namespace chamfer {

/// As LightSample; where pdf is 0 nothing else need be set.
struct LightLanes {
  Vector3 toLight[kLanes];
  double tfar[kLanes];
  VectorLaneFloats direction;
  ColorLaneFloats radiance;
  LaneFloats pdf;
  bool delta[kLanes];
  std::uint32_t instance[kLanes], solid[kLanes];
};

class LightSampler {
public:
  explicit LightSampler(const Lights& lights);
  /// `count`: lanes that are asked for, the first ones. `choice`, `ux`, `uy` uniform.
  void sample(const Point3* points, const LaneFloats& choice, const LaneFloats& ux, const LaneFloats& uy,
              std::size_t count, LightLanes& result) const;

private:
  void sampleTriangles(const Point3* points, const LaneFloats& choice, const LaneFloats& ux,
                       const LaneFloats& uy, LightLanes& result) const;

  const Lights& lights_;
  bool inLanes_; ///< triangles are: few, and all sharp
};

} // namespace chamfer
