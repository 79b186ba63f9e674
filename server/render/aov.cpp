#include "server/render/aov.h"

#include "common/error.h"
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

Color value(const Scene& scene, Aov aov, const TraceHit& hit) {
  switch (aov) {
  case Aov::Albedo:
    return surfaceAt(scene, materialAt(*scene.data, hit), hit).baseColor;
  case Aov::Normal:
    return {float(hit.normal.x), float(hit.normal.y), float(hit.normal.z)};
  case Aov::Depth:
    return grey(float(hit.t));
  case Aov::Feature:
    return featureColor(hit.feature);
  case Aov::Beauty:
    break;
  }
  throw Error(ErrorKind::Internal, "this output is not of the first hit");
}

} // namespace

AovSample aovSample(const Scene& scene, const Tracer& tracer, Aov aov, const Ray& ray, const RayOrigin& from,
                    RayStatistics& statistics) {
  ++statistics.cameraRays;
  const auto hit = tracer.intersect(ray, from);
  if (!hit) return {};
  ++statistics.hits;
  statistics.roundedHits += hit->rounded();
  return {value(scene, aov, *hit), 1};
}

} // namespace chamfer
