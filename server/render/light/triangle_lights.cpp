#include "server/render/light/triangle_lights.h"

#include "server/render/path/warp.h"

#include <algorithm>

namespace chamfer {
namespace {

double areaOf(const EmissiveTriangle& t) { return length(cross(t.edge1, t.edge2)) / 2; }

double longerEdge2(const EmissiveTriangle& t) {
  return std::max(lengthSquared(t.edge1), lengthSquared(t.edge2));
}

} // namespace

TriangleLights::TriangleLights(Emitters emitters, double reach)
    : emitters_(std::move(emitters)), perReach_(1 / reach) {
  std::vector<double> powers;
  for (const EmissiveTriangle& t : emitters_.triangles()) {
    powers.push_back(areaOf(t) * luminance(t.emission));
    anyRounded_ |= t.solid != kNone;
    power_ += (t.oneSided ? 1 : 2) * std::numbers::pi * powers.back();
    const Vector3 edge1 = t.edge1 * perReach_, edge2 = t.edge2 * perReach_, normal = cross(edge1, edge2);
    aims_.push_back({Vector3f(edge1), Vector3f(edge2), Vector3f(normal),
                     float(longerEdge2(t) * perReach_ * perReach_), float(length(normal) / 2)});
  }
  if (!(power_ > 0)) return;
  if (powers.size() > kFewLights) {
    table_ = AliasTable(powers);
    return;
  }
  const double most = *std::max_element(powers.begin(), powers.end());
  for (std::size_t i = 0; i < powers.size(); ++i) {
    const EmissiveTriangle& t = emitters_.triangles()[i];
    Target target{t.corner + (t.edge1 + t.edge2) / 3,
                  Vector3f(normalize(cross(t.edge1, t.edge2))),
                  float(powers[i] / most),
                  aims_[i].size2,
                  t.oneSided,
                  false};
    if (t.solid != kNone) {
      const Emitters::Ball ball = emitters_.ball(t.instance, t.solid);
      target.centre = ball.centre;
      target.size2 = float(ball.radius * ball.radius * perReach_ * perReach_);
      target.wholeSolid = true;
    }
    few_.push_back(target);
  }
}

/// About what the triangle sends to the point if nothing is in the way. The floor under the cosine is for
/// large triangles whose centre alone is seen edge-on.
float TriangleLights::importance(const Target& t, const Point3& p) const {
  const Vector3f d((t.centre - p) * perReach_);
  const float distance2 = lengthSquared(d);
  if (t.wholeSolid) return t.power * 0.5f / (distance2 + t.size2);
  const float height = dot(t.normal, d);
  if (t.oneSided && !(height < 0)) return 0;
  const float cosine = std::abs(height) / std::sqrt(std::max(distance2, 1e-30f * t.size2));
  return t.power * (cosine + 0.05f) / (distance2 + t.size2);
}

std::uint32_t TriangleLights::choose(const Point3& p, float choice, float& chance) const {
  if (few_.empty()) {
    const AliasTable::Choice c = table_.sample(choice);
    chance = c.probability;
    return c.index;
  }
  float weights[kFewLights], sum = 0;
  for (std::size_t i = 0; i < few_.size(); ++i)
    sum += weights[i] = importance(few_[i], p);
  chance = 0;
  if (!(sum > 0)) return 0;
  float left = choice * sum;
  std::uint32_t chosen = 0;
  for (std::uint32_t i = 0; i < few_.size(); ++i) {
    if (weights[i] > 0) chosen = i; // rounding may leave a rest beyond the last
    if ((left -= weights[i]) < 0) break;
  }
  chance = weights[chosen] / sum;
  return chosen;
}

float TriangleLights::chanceOf(std::uint32_t index, const Point3& p) const {
  if (few_.empty()) return table_.probability(index);
  float sum = 0, own = 0;
  for (std::uint32_t i = 0; i < few_.size(); ++i) {
    const float weight = importance(few_[i], p);
    sum += weight;
    if (i == index) own = weight;
  }
  return sum > 0 ? own / sum : 0;
}

Vector3f TriangleLights::corner(std::uint32_t index, const Point3& p) const {
  return Vector3f((emitters_.triangles()[index].corner - p) * perReach_);
}

/// The light as a spherical triangle where it is near enough to look much unlike a distant point (its
/// directions are then drawn by solid angle: by area, the nearest part would be drawn too seldom), nothing
/// elsewhere. Depends on triangle and point alone, so that both techniques of multiple importance sampling
/// agree.
std::optional<SphericalTriangleT<float>> TriangleLights::near(std::uint32_t index, const Vector3f& a) const {
  if (emitters_.triangles()[index].solid != kNone) return {};
  const Aim& aim = aims_[index];
  const Vector3f b = a + aim.edge1, c = a + aim.edge2;
  if (lengthSquared(a + b + c) > 9 * kFarLight * aim.size2) return {};
  const SphericalTriangleT<float> s(a, b, c, dot(aim.normal, a));
  if (!(s.solidAngle() > kSmallestNear && s.solidAngle() < kLargestNear)) return {};
  return s;
}

LightSample TriangleLights::sample(const Point3& p, float choice, const Float2& u) const {
  LightSample s;
  float chance;
  const std::uint32_t index = choose(p, choice, chance);
  const EmissiveTriangle& light = emitters_.triangles()[index];
  const Aim& aim = aims_[index];
  const Vector3f a = corner(index, p);
  const float height = dot(aim.normal, a);
  if (light.oneSided ? !(height < 0) : height == 0) return s;
  const auto nearOne = near(index, a);
  // The place on the light in double: rays from afar must meet it.
  const Vector3 fromPoint = light.corner - p;
  if (nearOne) {
    const Vector3 d(nearOne->sample(u)), normal = cross(light.edge1, light.edge2);
    s.toLight = d * (dot(normal, fromPoint) / dot(normal, d));
  } else {
    const Float2 b = warpToTriangle(u);
    s.toLight = fromPoint + light.edge1 * double(b.x) + light.edge2 * double(b.y);
  }
  const Vector3f toLight(s.toLight * perReach_);
  const float distanceSquared = lengthSquared(toLight), distance = std::sqrt(distanceSquared);
  const float cosine = std::abs(height) / (2 * aim.area * distance);
  if (!(distanceSquared > 0) || !(cosine > 0)) return s;
  s.direction = toLight * (1 / distance);
  s.radiance = light.emission;
  s.pdf = chance * (nearOne ? 1 / nearOne->solidAngle() : distanceSquared / (cosine * aim.area));
  s.tfar = shadowEnd(distance, cosine);
  s.instance = light.instance;
  s.solid = light.solid;
  return s;
}
float TriangleLights::foundPdf(const TraceHit& hit, const Ray& ray) const {
  const std::uint32_t index = emitters_.find(hit.instance, hit.triangle);
  if (index == kNone) return 0;
  const EmissiveTriangle& light = emitters_.triangles()[index];
  const auto areaPdf = [&](double distance, double cosine) {
    const auto inReaches = float(distance * perReach_);
    return inReaches * inReaches / (float(cosine) * aims_[index].area);
  };
  if (light.solid == kNone) {
    const Vector3f a = corner(index, ray.origin);
    if (light.oneSided && !(dot(aims_[index].normal, a) < 0)) return 0;
    const float chance = chanceOf(index, ray.origin);
    if (const auto nearOne = near(index, a)) return chance / nearOne->solidAngle();
    return chance * areaPdf(hit.t, std::abs(dot(ray.direction, hit.normal)));
  }
  // Through the facet of P where the ray goes in, which need not be the facet of the triangle that was met.
  // The chance over the area is the same for all of a solid's triangles.
  const auto entry = emitters_.entry(hit.instance, hit.solid, ray);
  if (!entry) return 0;
  return chanceOf(index, ray.origin) * areaPdf(entry->t, entry->cosine);
}

std::size_t TriangleLights::memoryBytes() const {
  return emitters_.memoryBytes() + table_.memoryBytes() + few_.size() * sizeof(Target) +
         aims_.size() * sizeof(Aim);
}

} // namespace chamfer
