#include "server/render/light/lights.h"

#include "server/render/path/warp.h"

#include <algorithm>
#include <limits>

namespace chamfer {
namespace {

/// A sky with less contrast than this is left to scattered rays alone: they find it as often as it is bright,
/// and a shadow ray towards it would be taken from lights that need one.
constexpr float kEvenSky = 4;

} // namespace

Lights::Lights(std::shared_ptr<const Environment> environment, std::vector<DistantLight> distant,
               std::vector<PointLight> points, Emitters emitters, const Bounds3& bounds, double reach)
    : environment_(std::move(environment)), distant_(std::move(distant)), points_(std::move(points)),
      triangles_(std::move(emitters), reach) {
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

  // By power alone, lights that are dim over all but near would starve: every kind of light keeps some
  // chance.
  const std::size_t ends[] = {0, 1, 1 + distant_.size(), power.size()};
  double sums[4] = {0, 0, 0, triangles_.power()}, total = triangles_.power();
  for (int k = 0; k < 3; ++k) {
    for (std::size_t i = ends[k]; i < ends[k + 1]; ++i)
      sums[k] += power[i];
    total += sums[k];
  }
  if (!(total > 0)) return;
  const auto kinds = double(std::count_if(std::begin(sums), std::end(sums), [](double s) { return s > 0; }));
  const auto share = [&](int k) { return sums[k] > 0 ? 0.8 * sums[k] / total + 0.2 / kinds : 0; };
  triangleShare_ = float(share(3));
  if (!(sums[0] + sums[1] + sums[2] > 0)) {
    triangleShare_ = 1;
    return;
  }
  for (int k = 0; k < 3; ++k)
    for (std::size_t i = ends[k]; i < ends[k + 1]; ++i)
      if (sums[k] > 0) power[i] *= share(k) / sums[k];
  choices_ = AliasTable(power);
}

LightSample Lights::sample(const Point3& p, float choice, const Float2& u) const {
  if (choice < triangleShare_) {
    LightSample s = triangles_.sample(p, std::min(choice / triangleShare_, 0x1.fffffep-1f), u);
    s.pdf *= triangleShare_;
    return s;
  }
  const float others = 1 - triangleShare_;
  const AliasTable::Choice light =
      choices_.sample(std::min((choice - triangleShare_) / others, 0x1.fffffep-1f));
  std::size_t index = light.index;
  LightSample s;
  if (index == 0)
    s = sampleEnvironment(u);
  else if (--index < distant_.size())
    s = sampleDistant(index, u);
  else
    s = samplePoint(index - distant_.size(), p);
  const float chance = others * light.probability;
  if (s.delta)
    s.radiance *= 1 / chance;
  else
    s.pdf *= chance;
  return s;
}

LightSample Lights::sampleEnvironment(const Float2& u) const {
  const Environment::Sample e = environment_->sample(u);
  LightSample s;
  s.direction = e.direction;
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
    s.direction = Vector3f(light.direction);
    s.radiance = light.irradiance;
    s.pdf = 1;
    s.delta = true;
    return s;
  }
  s.direction = Frame(Vector3f(light.direction)).toWorld(warpToCone(u, oneMinusCos_[index]));
  s.toLight = Vector3(s.direction);
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
  s.direction = Vector3f(normalize(s.toLight));
  s.tfar = 1;
  s.radiance = light.intensity * float(1 / distanceSquared);
  s.pdf = 1;
  s.delta = true;
  return s;
}

Color Lights::escaped(const Vector3f& d, float bsdfPdf) const {
  Color sum;
  const auto weight = [&](std::size_t choice, auto pdf) {
    if (!(bsdfPdf > 0) || choices_.size() == 0) return 1.f;
    const float probability = (1 - triangleShare_) * choices_.probability(std::uint32_t(choice));
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
  return triangles_.memoryBytes() + choices_.memoryBytes() + (environment_ ? environment_->memoryBytes() : 0);
}

} // namespace chamfer
