#include "server/render/aov.h"

#include "common/error.h"
#include "server/render/sampler.h"
#include "server/render/surface.h"

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

Color value(const Scene& scene, Aov aov, const TraceHit& hit) {
  switch (aov) {
  case Aov::Albedo:
    return surfaceAt(scene, materialAt(*scene.data, hit), hit).baseColor;
  case Aov::Normal:
  case Aov::GeometricNormal:
    return {float(hit.normal.x), float(hit.normal.y), float(hit.normal.z)};
  case Aov::Depth:
    return grey(float(hit.t));
  case Aov::Feature:
    return featureColor(hit.feature);
  case Aov::Instance:
    return instanceColor(hit.instance);
  case Aov::Beauty:
    break;
  }
  throw Error(ErrorKind::Internal, "this output is not of the first hit");
}

} // namespace

AovSample aovSample(const Scene& scene, const Tracer& tracer, Aov aov, const Ray& ray, const RayOrigin& from,
                    RayStatistics& statistics) {
  ++statistics.camera.traced;
  const auto hit = tracer.intersect(ray, from);
  if (!hit) return {};
  ++statistics.camera.hits;
  statistics.camera.rounded += hit->rounded();
  return {value(scene, aov, *hit), 1};
}

} // namespace chamfer
