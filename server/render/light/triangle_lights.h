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

/// Up to so many triangles each is weighed anew at every point.
inline constexpr std::size_t kFewLights = 32;
/// Triangles of solid angles between these are aimed at by solid angle; beyond, that loses its digits.
inline constexpr float kSmallestNear = 1e-2f, kLargestNear = 6.2f;
/// Squared distance of the centre beyond which a triangle looks like a distant point, over its squared size.
inline constexpr float kFarLight = 6;

/// Where a shadow ray to a point of a triangle must end so that it does not meet the triangle itself. The
/// tracer meets triangles in float32 and starts rays off the plane that they leave: both move the meeting by
/// some units in the last place of the scene's extent, over the cosine. Within that distance of a light
/// nothing casts a shadow. `distance` in units of the extent.
inline double shadowEnd(float distance, float cosine) {
  constexpr double kErrors = 32 * 0x1p-24;
  return std::max(0.0, 1 - kErrors * (1 + 1 / (double(distance) * double(cosine))));
}

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
  bool anyRounded() const { return anyRounded_; } ///< is one of them a triangle of a rounded solid?
  // What sampling in lanes reads (wavefront/light_lanes.h).
  const std::vector<Target>& few() const { return few_; }
  const Aim& aim(std::uint32_t index) const { return aims_[index]; }
  const EmissiveTriangle& triangle(std::uint32_t index) const { return emitters_.triangles()[index]; }
  double perReach() const { return perReach_; }

private:
  float importance(const Target& target, const Point3& p) const;
  std::uint32_t choose(const Point3& p, float choice, float& chance) const;
  float chanceOf(std::uint32_t index, const Point3& p) const;
  /// From `p` to the triangle's corner.
  Vector3f corner(std::uint32_t index, const Point3& p) const;
  std::optional<SphericalTriangleT<float>> near(std::uint32_t index, const Vector3f& corner) const;

  Emitters emitters_;
  double perReach_;         ///< 1 over the reach
  std::vector<Aim> aims_;   ///< by triangle
  std::vector<Target> few_; ///< by triangle, when there are few enough to weigh each of them at every point
  AliasTable table_;        ///< by power, when there are more
  double power_ = 0;
  bool anyRounded_ = false;
};

} // namespace chamfer
