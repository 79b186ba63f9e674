// All lights of a scene, sampled as one: next-event estimation picks a light by its power, then a direction
// to it. Densities are per solid angle at the receiving point and include the choice of the light, so that
// they can be weighed against a BSDF's (multiple importance sampling, Veach 1997).
#pragma once

#include "common/vec.h"
#include "server/render/light/distribution.h"
#include "server/render/light/environment.h"
#include "server/render/light/light_sources.h"
#include "server/render/light/triangle_lights.h"

#include <memory>
#include <optional>
#include <vector>

namespace chamfer {

class Lights {
public:
  /// `bounds`: of what is to be lit; it sets the power of distant lights against that of near ones. `reach`:
  /// extent of all that is traced, which bounds the tracer's errors.
  Lights(std::shared_ptr<const Environment> environment, std::vector<DistantLight> distant,
         std::vector<PointLight> points, Emitters emitters, const Bounds3& bounds, double reach);

  /// Is there nothing to sample? Light may still be found by chance (an even sky).
  bool empty() const { return choices_.size() == 0 && triangleShare_ == 0; }
  /// A direction to a light as seen from `p`; not to be asked of an empty set. `choice` and `u` are uniform.
  LightSample sample(const Point3& p, float choice, const Float2& u) const;

  /// What a ray that leaves the scene along unit `d` sees, each part weighed against `bsdfPdf` (the density
  /// with which the direction was drawn; 0: by a delta or from the camera, so that light sampling has no
  /// share).
  Color escaped(const Vector3f& d, float bsdfPdf) const;
  /// Density with which sample() would have sent this ray from its origin to the emitter that it hits; 0:
  /// never. The ray's direction is unit.
  float foundPdf(const TraceHit& hit, const Ray& ray) const {
    return triangleShare_ > 0 ? triangleShare_ * triangles_.foundPdf(hit, ray) : 0;
  }
  /// What sampling in lanes reads (wavefront/light_lanes.h): a triangle is chosen where `choice` is below the
  /// share, by choice / share.
  float triangleShare() const { return triangleShare_; }
  const TriangleLights& triangles() const { return triangles_; }
  std::size_t memoryBytes() const;

private:
  LightSample sampleEnvironment(const Float2& u) const;
  LightSample sampleDistant(std::size_t index, const Float2& u) const;
  LightSample samplePoint(std::size_t index, const Point3& p) const;
  float distantPdf(std::size_t index) const;
  Color coneRadiance(std::size_t index) const;

  std::shared_ptr<const Environment> environment_;
  std::vector<DistantLight> distant_;
  std::vector<float> oneMinusCos_; ///< of each distant light's cone
  std::vector<PointLight> points_;
  TriangleLights triangles_;
  AliasTable choices_;      ///< environment (if any), distant lights, point lights
  float triangleShare_ = 0; ///< chance that a triangle is chosen and none of choices_
};

/// Power heuristic: weight of the technique with density `a` against one with `b`.
inline float powerHeuristic(float a, float b) {
  // Scaled by the larger, so that squares of large densities do not overflow.
  const float m = std::max(a, b);
  if (!(m > 0)) return 0;
  if (std::isinf(m)) return std::isinf(a) ? 1.f : 0.f;
  const float x = a / m, y = b / m;
  return x * x / (x * x + y * y);
}

} // namespace chamfer
