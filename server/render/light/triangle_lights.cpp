#include "server/render/light/triangle_lights.h"

#include "server/render/light/spherical_triangle.h"
#include "server/render/path/warp.h"

#include <algorithm>

namespace chamfer {
namespace {

/// Up to so many triangles each is weighed anew at every point.
constexpr std::size_t kFew = 32;

/// Where a shadow ray to a point of a triangle must end so that it does not meet the triangle itself. The
/// tracer meets triangles in float32 and starts rays off the plane that they leave: both move the meeting by
/// some units in the last place of the scene's extent, over the cosine. Within that distance of a light
/// nothing casts a shadow.
double shadowEnd(double reach, double distance, double cosine) {
  constexpr double kErrors = 32 * 0x1p-24;
  return std::max(0.0, 1 - kErrors * (1 + reach / (distance * cosine)));
}

/// The light as a spherical triangle where it is near enough to look much unlike a distant point (its
/// directions are then drawn by solid angle: by area, the nearest part would be drawn too seldom), nothing
/// elsewhere. Depends on triangle and point alone, so that both techniques of multiple importance sampling
/// agree.
std::optional<SphericalTriangle> nearTriangle(const EmissiveTriangle& light, const Point3& p) {
  if (light.solid != kNone) return {};
  const Vector3 a = light.corner - p, b = a + light.edge1, c = a + light.edge2;
  const double size = std::max(lengthSquared(light.edge1), lengthSquared(light.edge2));
  if (lengthSquared(a + b + c) > 9 * 6 * size) return {};
  const SphericalTriangle s(a, b, c);
  constexpr double kSmallest = 1e-2, kLargest = 6.2; // beyond, the construction loses its digits
  if (!(s.solidAngle() > kSmallest && s.solidAngle() < kLargest)) return {};
  return s;
}

double areaOf(const EmissiveTriangle& t) { return length(cross(t.edge1, t.edge2)) / 2; }

/// Of a point drawn uniformly by area.
double areaPdf(const EmissiveTriangle& light, double distanceSquared, double cosine) {
  return distanceSquared / (cosine * areaOf(light));
}

} // namespace

TriangleLights::TriangleLights(Emitters emitters, double reach)
    : emitters_(std::move(emitters)), reach_(reach) {
  std::vector<double> powers;
  for (const EmissiveTriangle& t : emitters_.triangles()) {
    powers.push_back(areaOf(t) * luminance(t.emission));
    power_ += (t.oneSided ? 1 : 2) * std::numbers::pi * powers.back();
  }
  if (!(power_ > 0)) return;
  if (powers.size() > kFew) {
    table_ = AliasTable(powers);
    return;
  }
  for (std::size_t i = 0; i < powers.size(); ++i) {
    const EmissiveTriangle& t = emitters_.triangles()[i];
    Target target{t.corner + (t.edge1 + t.edge2) / 3,
                  normalize(cross(t.edge1, t.edge2)),
                  powers[i],
                  std::max(lengthSquared(t.edge1), lengthSquared(t.edge2)),
                  t.oneSided,
                  false};
    if (t.solid != kNone) {
      const Emitters::Ball ball = emitters_.ball(t.instance, t.solid);
      target.centre = ball.centre;
      target.size2 = ball.radius * ball.radius;
      target.wholeSolid = true;
    }
    few_.push_back(target);
  }
}

/// About what the triangle sends to the point if nothing is in the way. The floor under the cosine is for
/// large triangles whose centre alone is seen edge-on.
double TriangleLights::importance(const Target& t, const Point3& p) const {
  const Vector3 d = t.centre - p;
  const double distance2 = lengthSquared(d);
  if (t.wholeSolid) return t.power * 0.5 / (distance2 + t.size2);
  const double height = dot(t.normal, d);
  if (t.oneSided && !(height < 0)) return 0;
  const double cosine = std::abs(height) / std::sqrt(distance2 + 1e-30 * t.size2);
  return t.power * (cosine + 0.05) / (distance2 + t.size2);
}

std::uint32_t TriangleLights::choose(const Point3& p, float choice, double& chance) const {
  if (few_.empty()) {
    const AliasTable::Choice c = table_.sample(choice);
    chance = double(c.probability);
    return c.index;
  }
  double weights[kFew], sum = 0;
  for (std::size_t i = 0; i < few_.size(); ++i)
    sum += weights[i] = importance(few_[i], p);
  chance = 0;
  if (!(sum > 0)) return 0;
  double left = double(choice) * sum;
  std::uint32_t chosen = 0;
  for (std::uint32_t i = 0; i < few_.size(); ++i) {
    if (weights[i] > 0) chosen = i; // rounding may leave a rest beyond the last
    if ((left -= weights[i]) < 0) break;
  }
  chance = weights[chosen] / sum;
  return chosen;
}

double TriangleLights::chanceOf(std::uint32_t index, const Point3& p) const {
  if (few_.empty()) return double(table_.probability(index));
  double sum = 0;
  for (const Target& t : few_)
    sum += importance(t, p);
  return sum > 0 ? importance(few_[index], p) / sum : 0;
}

LightSample TriangleLights::sample(const Point3& p, float choice, const Float2& u) const {
  LightSample s;
  double chance;
  const EmissiveTriangle& light = emitters_.triangles()[choose(p, choice, chance)];
  const Vector3 normal = cross(light.edge1, light.edge2), corner = light.corner - p;
  const double height = dot(normal, corner);
  if (light.oneSided ? !(height < 0) : height == 0) return s;
  const std::optional<SphericalTriangle> near = nearTriangle(light, p);
  if (near) {
    s.toLight = near->sample(u);
    s.toLight = s.toLight * (height / dot(normal, s.toLight));
  } else {
    const Float2 b = warpToTriangle(u);
    s.toLight = corner + light.edge1 * double(b.x) + light.edge2 * double(b.y);
  }
  const double distanceSquared = lengthSquared(s.toLight), distance = std::sqrt(distanceSquared);
  const double cosine = std::abs(height) / (length(normal) * distance);
  if (!(distanceSquared > 0) || !(cosine > 0)) return s;
  s.radiance = light.emission;
  s.pdf = float(chance * (near ? 1 / near->solidAngle() : areaPdf(light, distanceSquared, cosine)));
  s.tfar = shadowEnd(reach_, distance, cosine);
  s.instance = light.instance;
  s.solid = light.solid;
  return s;
}

float TriangleLights::foundPdf(const TraceHit& hit, const Ray& ray) const {
  const std::uint32_t index = emitters_.find(hit.instance, hit.triangle);
  if (index == kNone) return 0;
  const EmissiveTriangle& light = emitters_.triangles()[index];
  if (light.solid == kNone) {
    if (light.oneSided && !(dot(cross(light.edge1, light.edge2), light.corner - ray.origin) < 0)) return 0;
    const double chance = chanceOf(index, ray.origin);
    if (const auto near = nearTriangle(light, ray.origin)) return float(chance / near->solidAngle());
    return float(chance * areaPdf(light, hit.t * hit.t, std::abs(dot(ray.direction, hit.normal))));
  }
  // Through the facet of P where the ray goes in, which need not be the facet of the triangle that was met.
  // The chance over the area is the same for all of a solid's triangles.
  const auto entry = emitters_.entry(hit.instance, hit.solid, ray);
  if (!entry) return 0;
  return float(chanceOf(index, ray.origin) * areaPdf(light, entry->t * entry->t, entry->cosine));
}

std::size_t TriangleLights::memoryBytes() const {
  return emitters_.memoryBytes() + table_.memoryBytes() + few_.size() * sizeof(Target);
}

} // namespace chamfer
