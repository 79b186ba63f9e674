#include "server/render/lights.h"

#include "server/render/spherical_triangle.h"
#include "server/render/warp.h"

#include <limits>

namespace chamfer {
namespace {

/// Where a shadow ray to a point of a triangle must end so that it does not meet the triangle itself. The
/// tracer meets triangles in float32 and starts rays off the plane that they leave: both move the meeting by
/// some units in the last place of the scene's extent, over the cosine. Within that distance of a light
/// nothing casts a shadow.
double shadowEnd(double reach, double distance, double cosine) {
  constexpr double kErrors = 32 * 0x1p-24;
  return std::max(0.0, 1 - kErrors * (1 + reach / (distance * cosine)));
}

/// A sky with less contrast than this is left to scattered rays alone: they find it as often as it is bright,
/// and a shadow ray towards it would be taken from lights that need one.
constexpr float kEvenSky = 4;

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

} // namespace

Lights::Lights(std::shared_ptr<const Environment> environment, std::vector<DistantLight> distant,
               std::vector<PointLight> points, Emitters emitters, const Bounds3& bounds, double reach)
    : environment_(std::move(environment)), distant_(std::move(distant)), points_(std::move(points)),
      emitters_(std::move(emitters)), reach_(reach) {
  const double radius =
      bounds.empty() ? 1 : std::max(bounds.diagonal() / 2, std::numeric_limits<double>::min());
  const double disk = std::numbers::pi * radius * radius;
  std::vector<double> power;
  const bool sampleEnvironment = environment_ && environment_->contrast() > kEvenSky;
  power.push_back(sampleEnvironment ? 4 * std::numbers::pi * disk * environment_->meanLuminance() : 0);
  for (const DistantLight& light : distant_) {
    const double half = light.angularDiameterDegrees * std::numbers::pi / 360, s = std::sin(half / 2);
    oneMinusCos_.push_back(float(2 * s * s));
    power.push_back(disk * luminance(light.irradiance));
  }
  for (const PointLight& light : points_)
    power.push_back(4 * std::numbers::pi * luminance(light.intensity));

  for (const EmissiveTriangle& t : emitters_.triangles()) // both sides
    power.push_back(std::numbers::pi * length(cross(t.edge1, t.edge2)) * luminance(t.emission));
  // By power alone, lights that are dim over all but near would starve: every kind of light keeps some
  // chance.
  const std::size_t ends[] = {0, 1, 1 + distant_.size(), 1 + distant_.size() + points_.size(), power.size()};
  double sums[4] = {}, total = 0;
  int kinds = 0;
  for (int k = 0; k < 4; ++k) {
    for (std::size_t i = ends[k]; i < ends[k + 1]; ++i)
      sums[k] += power[i];
    total += sums[k];
    kinds += sums[k] > 0;
  }
  if (!(total > 0)) return;
  for (int k = 0; k < 4; ++k)
    for (std::size_t i = ends[k]; i < ends[k + 1]; ++i)
      if (sums[k] > 0) power[i] *= 0.8 / total + 0.2 / (kinds * sums[k]);
  choices_ = AliasTable(power);
  // A triangle's power is pi times both its sides' area times luminance: chance over area, per unit of
  // luminance.
  if (sums[3] > 0) triangleScale_ = 2 * std::numbers::pi * (0.8 / total + 0.2 / (kinds * sums[3]));
}

LightSample Lights::sample(const Point3& p, float choice, const Float2& u) const {
  const AliasTable::Choice light = choices_.sample(choice);
  std::size_t index = light.index;
  const std::size_t others = 1 + distant_.size() + points_.size();
  if (index >= others)
    return sampleTriangle(std::uint32_t(index - others), p, u); // its density has the choice in it
  LightSample s;
  if (index == 0)
    s = sampleEnvironment(u);
  else if (--index < distant_.size())
    s = sampleDistant(index, u);
  else
    s = samplePoint(index - distant_.size(), p);
  if (s.delta)
    s.radiance *= 1 / light.probability;
  else
    s.pdf *= light.probability;
  return s;
}

LightSample Lights::sampleEnvironment(const Float2& u) const {
  const Environment::Sample e = environment_->sample(u);
  LightSample s;
  s.toLight = Vector3(e.direction);
  s.tfar = INFINITY;
  s.pdf = e.pdf;
  s.radiance = environment_->radiance(e.direction);
  return s;
}

float Lights::distantPdf(std::size_t index) const { return 1 / (2 * kPi * oneMinusCos_[index]); }

Color Lights::coneRadiance(std::size_t index) const {
  // A surface that faces a cone receives pi sin^2 times its radiance; sin^2 = (1 - cos) (1 + cos).
  const float drop = oneMinusCos_[index];
  return distant_[index].irradiance * (1 / (kPi * drop * (2 - drop)));
}

LightSample Lights::sampleDistant(std::size_t index, const Float2& u) const {
  const DistantLight& light = distant_[index];
  LightSample s;
  s.tfar = INFINITY;
  if (oneMinusCos_[index] == 0) {
    s.toLight = light.direction;
    s.radiance = light.irradiance;
    s.pdf = 1;
    s.delta = true;
    return s;
  }
  s.toLight = Vector3(Frame(Vector3f(light.direction)).toWorld(warpToCone(u, oneMinusCos_[index])));
  s.pdf = distantPdf(index);
  s.radiance = coneRadiance(index);
  return s;
}

LightSample Lights::samplePoint(std::size_t index, const Point3& p) const {
  const PointLight& light = points_[index];
  LightSample s;
  s.toLight = light.position - p;
  const double distanceSquared = lengthSquared(s.toLight);
  if (!(distanceSquared > 0)) return s;
  s.tfar = 1;
  s.radiance = light.intensity * float(1 / distanceSquared);
  s.pdf = 1;
  s.delta = true;
  return s;
}

float Lights::triangleChance(std::uint32_t index) const {
  return choices_.probability(std::uint32_t(1 + distant_.size() + points_.size()) + index);
}

double Lights::areaPdf(const EmissiveTriangle& light, double distanceSquared, double cosine) const {
  return luminance(light.emission) * triangleScale_ * distanceSquared / cosine;
}

LightSample Lights::sampleTriangle(std::uint32_t index, const Point3& p, const Float2& u) const {
  const EmissiveTriangle& light = emitters_.triangles()[index];
  const Vector3 normal = cross(light.edge1, light.edge2), corner = light.corner - p;
  const double height = dot(normal, corner), area2 = length(normal);
  LightSample s;
  // Of a rounded solid only what faces the point: from behind it is its own far side.
  if (light.solid != kNone ? !(height < 0) : height == 0) return s;
  const std::optional<SphericalTriangle> near = nearTriangle(light, p);
  if (near) {
    s.toLight = near->sample(u);
    s.toLight = s.toLight * (height / dot(normal, s.toLight));
  } else {
    const Float2 b = warpToTriangle(u);
    s.toLight = corner + light.edge1 * double(b.x) + light.edge2 * double(b.y);
  }
  const double distanceSquared = lengthSquared(s.toLight), distance = std::sqrt(distanceSquared);
  const double cosine = std::abs(height) / (area2 * distance);
  if (!(distanceSquared > 0) || !(cosine > 0)) return s;
  s.radiance = light.emission;
  s.pdf = float(near ? triangleChance(index) / near->solidAngle() : areaPdf(light, distanceSquared, cosine));
  s.tfar = shadowEnd(reach_, distance, cosine);
  s.instance = light.instance;
  s.solid = light.solid;
  return s;
}

float Lights::foundPdf(const TraceHit& hit, const Ray& ray) const {
  if (hit.solid != kNone) {
    const auto entry = emitters_.entry(hit.instance, hit.solid, ray);
    const std::uint32_t index = entry ? emitters_.find(hit.instance, hit.triangle) : kNone;
    if (index == kNone) return 0;
    return float(areaPdf(emitters_.triangles()[index], entry->t * entry->t, entry->cosine));
  }
  const std::uint32_t index = emitters_.find(hit.instance, hit.triangle);
  if (index == kNone) return 0;
  const EmissiveTriangle& light = emitters_.triangles()[index];
  if (const auto near = nearTriangle(light, ray.origin))
    return float(triangleChance(index) / near->solidAngle());
  return float(areaPdf(light, hit.t * hit.t, std::abs(dot(ray.direction, hit.normal))));
}

Color Lights::escaped(const Vector3f& d, float bsdfPdf) const {
  Color sum;
  const auto weight = [&](std::size_t choice, auto pdf) {
    if (!(bsdfPdf > 0) || empty()) return 1.f;
    const float probability = choices_.probability(std::uint32_t(choice));
    return probability > 0 ? powerHeuristic(bsdfPdf, probability * pdf()) : 1.f;
  };
  if (environment_) sum += environment_->radiance(d) * weight(0, [&] { return environment_->pdf(d); });
  for (std::size_t i = 0; i < distant_.size(); ++i) {
    if (oneMinusCos_[i] == 0) continue;
    // 1 - cos from the chord, which keeps its digits for narrow cones.
    const Vector3f chord = d - Vector3f(distant_[i].direction);
    if (lengthSquared(chord) > 2 * oneMinusCos_[i]) continue;
    sum += coneRadiance(i) * weight(1 + i, [&] { return distantPdf(i); });
  }
  return sum;
}

std::size_t Lights::memoryBytes() const {
  return emitters_.memoryBytes() + choices_.memoryBytes() + (environment_ ? environment_->memoryBytes() : 0);
}

} // namespace chamfer
