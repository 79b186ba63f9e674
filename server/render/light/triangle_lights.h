// Next-event estimation of everything that emits and has a surface: one of the emitters' triangles is chosen,
// then a direction to it. Densities are per solid angle at the receiving point.
#pragma once

#include "server/render/light/distribution.h"
#include "server/render/light/emitters.h"
#include "server/render/light/light_sample.h"
#include "server/render/light/spherical_triangle.h"

#include <optional>
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
  /// What the choice among few triangles looks at; lengths in units of the reach.
  struct Target {
    Point3 centre;   ///< world
    Vector3f normal; ///< unit
    float power;     ///< area times luminance, of the most powerful 1
    float size2;     ///< squared length of the longer edge
    bool oneSided;
    /// A rounded solid's triangle: weighed by area and the solid's distance alone, so that the chance over
    /// the area is the same all over the solid; size and centre are then the solid's.
    bool wholeSolid;
  };
  /// A triangle as it is aimed at, in units of the reach: near 1, so that float32 holds their products.
  struct Aim {
    Vector3f edge1, edge2, normal; ///< the normal as long as twice the area
    float size2;                   ///< squared length of the longer edge
    float area;
  };
  float importance(const Target& target, const Point3& p) const;
  std::uint32_t choose(const Point3& p, float choice, float& chance) const;
  float chanceOf(std::uint32_t index, const Point3& p) const;
  /// From `p` to the triangle's corner.
  Vector3f corner(std::uint32_t index, const Point3& p) const;
  std::optional<SphericalTriangleT<float>> near(std::uint32_t index, const Vector3f& corner) const;

  Emitters emitters_;
  double reach_, perReach_;
  std::vector<Aim> aims_;   ///< by triangle
  std::vector<Target> few_; ///< by triangle, when there are few enough to weigh each of them at every point
  AliasTable table_;        ///< by power, when there are more
  double power_ = 0;
};

} // namespace chamfer
