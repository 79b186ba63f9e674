#include "server/render/path/aov.h"

#include "common/error.h"

namespace chamfer {
namespace {

Color featureColor(Feature feature) {
  switch (feature) {
  case Feature::Flat:
    return grey(0.25f);
  case Feature::Cylinder:
    return {1, 0.5f, 0};
  case Feature::Sphere:
    return {0, 0.5f, 1};
  }
  throw Error(ErrorKind::Internal, "unknown feature");
}

Color instanceColor(std::uint32_t instance) {
  const std::uint64_t bits = mixBits(instance + 1ull);
  const auto channel = [&](int shift) { return float((bits >> shift) & 0xffu) / 255; };
  return {channel(0), channel(8), channel(16)};
}

Color directionColor(const Vector3& v) { return {float(v.x), float(v.y), float(v.z)}; }

Color value(const Surfaces& surfaces, Aov aov, const TraceHit& hit, const SurfacePlace& place,
            const Sampler& sampler) {
  switch (aov) {
  case Aov::Albedo:
    return surfaces.values(hit, place).baseColor;
  case Aov::Normal:
    return directionColor(surfaces.shadingNormal(hit, place, sampler, 0).normal);
  case Aov::GeometricNormal:
    return directionColor(hit.normal);
  case Aov::Depth:
    return grey(float(hit.t));
  case Aov::Feature:
    return featureColor(place.feature);
  case Aov::Instance:
    return instanceColor(hit.instance);
  case Aov::Beauty:
    break;
  }
  throw Error(ErrorKind::Internal, "this output is not of the first hit");
}

} // namespace

AovSample aovSample(const Surfaces& surfaces, const Tracer& tracer, Aov aov, const Ray& ray,
                    const PathState& from, const Sampler& sampler, RayStatistics& statistics) {
  ++statistics.camera.traced;
  const auto hit = tracer.intersect(ray, from);
  if (!hit) return {};
  ++statistics.camera.hits;
  const SurfacePlace place = surfaces.place(*hit);
  statistics.camera.rounded += place.rounded();
  return {value(surfaces, aov, *hit, place, sampler), 1};
}

} // namespace chamfer
