#include "server/render/path/path_tracer.h"

#include "server/render/surface/shading_normal.h"

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

/// A surface point of the path. Sides are told by the geometric normal, the BSDF stands in the frame of the
/// shading normal, both on the side that the path came from (shading_normal.h).
class PathTracer::Vertex {
public:
  Vertex(const TraceHit& hit, const Vector3& incoming, const ShadingNormal& shading,
         const SurfaceValues& surface)
      : hit_(hit), side_(dot(incoming, hit.normal) > 0 ? -1 : 1), smooth_(shading.smooth * side_),
        normal_(onThisSide(incoming, shading.normal)), turned_(!(shading.normal == shading.smooth)),
        frame_(Vector3f(normal_)),
        bsdf_(surface, localOutgoing(incoming), side_ < 0 ? 1 / surface.ior : surface.ior) {}

  bool hasSmoothPart() const { return bsdf_.hasSmoothPart(); }
  const Point3& position() const { return hit_.position; }
  RayOrigin leave(const Vector3& direction) const { return hit_.leave(direction); }

  /// `wi` world, unit.
  BsdfValue evaluate(const Vector3& wi) const {
    const Vector3f local = frame_.toLocal(Vector3f(wi));
    if (!sameSide(local, wi)) return {};
    return bsdf_.evaluate(local, diffuseLeft(wi));
  }
  /// `wi` is set to the direction in the world, unit.
  BsdfSample sample(float lobe, const Float2& u, Vector3& wi) const {
    BsdfSample s = bsdf_.sample(lobe, u);
    if (!s.valid) return s;
    wi = normalize(Vector3(frame_.toWorld(s.wi)));
    s.valid = sameSide(s.wi, wi);
    if (turned_ && s.valid && !s.delta) s.weight = bsdf_.evaluate(s.wi, diffuseLeft(wi)).f * (1 / s.pdf);
    return s;
  }

private:
  /// Does the direction lie on the same side of the surface as of the shading frame? If not, light would go
  /// through the surface; where the two normals are one, grazing directions can be parted by rounding.
  bool sameSide(const Vector3f& local, const Vector3& world) const {
    const double cosine = dot(world, hit_.normal) * side_;
    return local.z > 0 ? cosine > 0 : cosine < 0;
  }
  Vector3 onThisSide(const Vector3& incoming, const Vector3& shading) const {
    if (shading == hit_.normal) return shading * side_;
    return bendNormal(-incoming, shading * side_, hit_.normal * side_);
  }
  Vector3f localOutgoing(const Vector3& incoming) const {
    Vector3f wo = frame_.toLocal(Vector3f(-incoming));
    wo.z = std::max(wo.z, 1e-6f); // a cosine: exactly grazing rays still need a side
    return wo;
  }
  float diffuseLeft(const Vector3& wi) const {
    return turned_ ? float(terminatorFactor(smooth_, normal_, wi)) : 1;
  }
  const TraceHit& hit_;
  double side_; ///< -1: the path is inside the solid
  Vector3 smooth_, normal_;
  bool turned_;
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
    blocker = surfaces_.place(*hit).feature;
  }
  count.hits += !reached;
  count.rounded += !reached && blocker != Feature::Flat;
  return reached;
}

Color PathTracer::directLight(const Vertex& vertex, const Float2& choice, const Float2& u,
                              RayStatistics& statistics) const {
  const LightSample light = lights_.sample(vertex.position(), choice.x, u);
  if (!(light.pdf > 0) || light.radiance.isBlack()) return {};
  const BsdfValue scattered = vertex.evaluate(light.toLight * (1 / length(light.toLight)));
  if (scattered.f.isBlack()) return {};
  if (!reaches(vertex, light, statistics.shadow)) return {};
  if (light.delta) return scattered.f * light.radiance;
  return scattered.f * light.radiance * (powerHeuristic(light.pdf, scattered.pdf) / light.pdf);
}

Color PathTracer::radiance(Ray ray, RayOrigin from, const Sampler& sampler, RayStatistics& statistics) const {
  Color sum, throughput = grey(1);
  float scatterPdf = 0; // with which the last direction was drawn; 0: delta or camera
  unsigned spread = 0;  // scatterings so far that were no deltas
  const auto limited = [this](const Color& light, bool indirect) {
    const float most = maxComponent(light);
    return indirect && most > indirectClamp_ ? light * (indirectClamp_ / most) : light;
  };
  float etaScale = 1; // undoes the compression of radiance in glass, for Russian roulette only
  RayCount* count = &statistics.camera;
  for (unsigned bounce = 0;; ++bounce) {
    ++count->traced;
    const auto hit = tracer_.intersect(ray, from);
    if (!hit)
      return sum + limited(throughput * lights_.escaped(Vector3f(ray.direction), scatterPdf), spread > 1);
    ++count->hits;
    const SurfacePlace place = surfaces_.place(*hit);
    const Material& material = *place.material;
    count->rounded += place.rounded();
    const double cosine = dot(ray.direction, hit->normal);
    if (cosine > 0 && material.transmission > 0 && !material.absorption.isBlack())
      throughput *= transmittance(material.absorption, hit->t);
    if (material.emits()) {
      const float lightPdf = scatterPdf > 0 ? lights_.foundPdf(*hit, ray) : 0;
      const float weight = lightPdf > 0 ? powerHeuristic(scatterPdf, lightPdf) : 1;
      sum += limited(throughput * material.emission * weight, spread > 1);
    }
    if (bounce == maxBounces_) return sum;

    const Vertex vertex(*hit, ray.direction, surfaces_.shadingNormal(*hit, place, sampler, bounce),
                        surfaces_.values(*hit, place));
    const std::uint32_t pair = kFirstPathPair + bounce * kPairsPerBounce;
    const Float2 choice = sampler.pair(pair + kChoicePair);
    if (vertex.hasSmoothPart() && !lights_.empty())
      sum += limited(throughput * directLight(vertex, choice, sampler.pair(pair + kLightPair), statistics),
                     spread > 0);

    const BsdfSample scattered = vertex.sample(choice.y, sampler.pair(pair + kScatterPair), ray.direction);
    if (!scattered.valid) return sum;
    ray.origin = hit->position;
    from = vertex.leave(ray.direction);
    throughput *= scattered.weight;
    etaScale *= scattered.etaSquared;
    scatterPdf = scattered.pdf;
    spread += !scattered.delta;
    if (bounce + 1 >= kRouletteFrom) {
      const float survive = std::min(1.f, maxComponent(throughput) * etaScale);
      if (!(sampler.pair(pair + kRoulettePair).x < survive)) return sum;
      throughput *= 1 / survive;
    }
    count = &statistics.bounce;
  }
}

} // namespace chamfer
