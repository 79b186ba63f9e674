#include "server/render/path_tracer.h"

#include "server/render/surface.h"

namespace chamfer {
namespace {

constexpr std::uint32_t kPairsPerBounce = 4;
enum PathPair : std::uint32_t { kChoicePair, kLightPair, kScatterPair, kRoulettePair };
/// Bounces before Russian roulette begins.
constexpr unsigned kRouletteFrom = 3;

Color transmittance(const Color& absorption, double distance) {
  const float d = float(distance);
  return {std::exp(-absorption.r * d), std::exp(-absorption.g * d), std::exp(-absorption.b * d)};
}

} // namespace

/// A surface point of the path, its frame on the side the path came from.
class PathTracer::Vertex {
public:
  Vertex(const TraceHit& hit, const Vector3& incoming, const SurfaceValues& surface)
      : hit_(hit), side_(dot(incoming, hit.normal) > 0 ? -1 : 1), frame_(Vector3f(hit.normal * side_)),
        bsdf_(surface, localOutgoing(incoming), side_ < 0) {}

  const Bsdf& bsdf() const { return bsdf_; }
  const Point3& position() const { return hit_.position; }
  RayOrigin leave(const Vector3& direction) const { return hit_.leave(direction); }
  Vector3f toLocal(const Vector3& w) const { return frame_.toLocal(Vector3f(w)); }
  Vector3 toWorld(const Vector3f& w) const { return normalize(Vector3(frame_.toWorld(w))); }
  /// Do the float direction and the double one lie on the same side of the surface? At grazing angles
  /// rounding can part them, and the path would go on inside the solid.
  bool sameSide(const Vector3f& local, const Vector3& world) const {
    const double cosine = dot(world, hit_.normal) * side_;
    return local.z > 0 ? cosine > 0 : cosine < 0;
  }

private:
  Vector3f localOutgoing(const Vector3& incoming) const {
    Vector3f wo = frame_.toLocal(Vector3f(-incoming));
    wo.z = std::max(wo.z, 1e-6f); // a cosine: exactly grazing rays still need a side
    return wo;
  }
  const TraceHit& hit_;
  double side_; ///< -1: the path is inside the solid
  Frame frame_;
  Bsdf bsdf_;
};

bool PathTracer::reaches(const Vertex& vertex, const LightSample& light, RayCount& count) const {
  const Ray ray{vertex.position(), light.toLight};
  const RayOrigin from = vertex.leave(light.toLight);
  ++count.traced;
  Feature blocker = Feature::Flat;
  bool reached;
  if (light.solid == kNone) {
    reached = !tracer_.occluded(ray, from, 0, light.tfar, &blocker);
  } else {
    const auto hit = tracer_.intersect(ray, from);
    reached = hit && hit->instance == light.instance && hit->solid == light.solid;
    if (!hit) return false; // past the rounded emitter, into the void
    blocker = hit->feature;
  }
  count.hits += !reached;
  count.rounded += !reached && blocker != Feature::Flat;
  return reached;
}

Color PathTracer::directLight(const Vertex& vertex, const Float2& choice, const Float2& u,
                              RayStatistics& statistics) const {
  const LightSample light = lights_.sample(vertex.position(), choice.x, u);
  if (!(light.pdf > 0) || light.radiance.isBlack()) return {};
  const Vector3f wi = vertex.toLocal(light.toLight * (1 / length(light.toLight)));
  const BsdfValue scattered = vertex.bsdf().evaluate(wi);
  if (scattered.f.isBlack() || !vertex.sameSide(wi, light.toLight)) return {};
  if (!reaches(vertex, light, statistics.shadow)) return {};
  if (light.delta) return scattered.f * light.radiance;
  return scattered.f * light.radiance * (powerHeuristic(light.pdf, scattered.pdf) / light.pdf);
}

Color PathTracer::radiance(Ray ray, RayOrigin from, const Sampler& sampler, RayStatistics& statistics) const {
  const SceneData& data = *scene_.data;
  Color sum, throughput = grey(1);
  float scatterPdf = 0; // with which the last direction was drawn; 0: delta or camera
  float etaScale = 1;   // undoes the compression of radiance in glass, for Russian roulette only
  RayCount* count = &statistics.camera;
  for (unsigned bounce = 0;; ++bounce) {
    ++count->traced;
    const auto hit = tracer_.intersect(ray, from);
    if (!hit) return sum + throughput * lights_.escaped(Vector3f(ray.direction), scatterPdf);
    ++count->hits;
    count->rounded += hit->rounded();
    const Material& material = materialAt(data, *hit);
    const double cosine = dot(ray.direction, hit->normal);
    if (cosine > 0 && material.transmission > 0 && !material.absorption.isBlack())
      throughput *= transmittance(material.absorption, hit->t);
    if (material.emits()) {
      const float lightPdf = scatterPdf > 0 ? lights_.foundPdf(*hit, ray) : 0;
      sum += throughput * material.emission * (lightPdf > 0 ? powerHeuristic(scatterPdf, lightPdf) : 1);
    }
    if (bounce == maxBounces_) return sum;

    const Vertex vertex(*hit, ray.direction, surfaceAt(scene_, material, *hit));
    const std::uint32_t pair = kFirstPathPair + bounce * kPairsPerBounce;
    const Float2 choice = sampler.pair(pair + kChoicePair);
    if (vertex.bsdf().hasSmoothPart() && !lights_.empty())
      sum += throughput * directLight(vertex, choice, sampler.pair(pair + kLightPair), statistics);

    const BsdfSample scattered = vertex.bsdf().sample(choice.y, sampler.pair(pair + kScatterPair));
    if (!scattered.valid) return sum;
    ray.origin = hit->position;
    ray.direction = vertex.toWorld(scattered.wi);
    if (!vertex.sameSide(scattered.wi, ray.direction)) return sum;
    from = vertex.leave(ray.direction);
    throughput *= scattered.weight;
    etaScale *= scattered.etaSquared;
    scatterPdf = scattered.pdf;
    if (bounce + 1 >= kRouletteFrom) {
      const float survive = std::min(1.f, maxComponent(throughput) * etaScale);
      if (!(sampler.pair(pair + kRoulettePair).x < survive)) return sum;
      throughput *= 1 / survive;
    }
    count = &statistics.bounce;
  }
}

} // namespace chamfer
