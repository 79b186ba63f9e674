// Next-event estimation of everything that emits and has a surface: one of the emitters' triangles is chosen,
// then a direction to it. Densities are per solid angle at the receiving point.
#pragma once

#include "server/render/light/distribution.h"
#include "server/render/light/emitters.h"
#include "server/render/light/light_sample.h"

#include <vector>

namespace chamfer {

class TriangleLights {
public:
  /// `reach`: extent of all that is traced, which bounds the tracer's errors.
  TriangleLights(Emitters emitters, double reach);

  double power() const { return power_; } ///< luminance of all that is emitted; 0: there is nothing
  /// `choice` and `u` are uniform. Not to be asked when power() is 0.
  LightSample sample(const Point3& p, float choice, const Float2& u) const;
  /// Density with which sample() would have sent this ray from its origin to the emitter that it hits; 0:
  /// never. The ray's direction is unit.
  float foundPdf(const TraceHit& hit, const Ray& ray) const;
  std::size_t memoryBytes() const;

private:
  /// What the choice among few triangles looks at.
  struct Target {
    Point3 centre;
    Vector3 normal; ///< unit
    double power;   ///< area times luminance
    double size2;   ///< squared length of the longer edge
    bool oneSided;
    /// A rounded solid's triangle: weighed by area and the solid's distance alone, so that the chance over
    /// the area is the same all over the solid; size and centre are then the solid's.
    bool wholeSolid;
  };
  double importance(const Target& target, const Point3& p) const;
  std::uint32_t choose(const Point3& p, float choice, double& chance) const;
  double chanceOf(std::uint32_t index, const Point3& p) const;

  Emitters emitters_;
  double reach_;
  std::vector<Target> few_; ///< by triangle, when there are few enough to weigh each of them at every point
  AliasTable table_;        ///< by power, when there are more
  double power_ = 0;
};

} // namespace chamfer
