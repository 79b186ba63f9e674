#include "server/render/path/path_tracer.h"

#include "server/render/surface/shading_normal.h"

namespace chamfer {
namespace {

constexpr std::uint32_t kPairsPerBounce = 4;
enum PathPair : std::uint32_t { kChoicePair, kLightPair, kScatterPair, kRoulettePair };
/// Bounces before Russian roulette begins.
constexpr unsigned kRouletteFrom = 3;

/// Surfaces between equal media that a path goes through from one of its vertices to the next; a path that
/// meets more is going in circles, by rounding, and ends.
constexpr unsigned kMostNothings = 1000;

} // namespace

/// A surface point of the path. Sides are told by the geometric normal, the BSDF stands in the frame of the
/// shading normal, both on the side that the path came from (shading_normal.h).
class PathTracer::Vertex {
public:
  /// `eta`: index of refraction of the far side over that of the side that the path came from. All must
  /// outlive the vertex.
  Vertex(const TraceHit& hit, const PathState& state, const Vector3& incoming, const ShadingNormal& shading,
         const SurfaceValues& surface, float eta)
      : hit_(hit), state_(state), side_(dot(incoming, hit.normal) > 0 ? -1 : 1),
        smooth_(shading.smooth * side_), normal_(onThisSide(incoming, shading.normal)),
        turned_(!(shading.normal == shading.smooth)), frame_(Vector3f(normal_)),
        bsdf_(surface, localOutgoing(incoming), eta) {}

  bool hasSmoothPart() const { return bsdf_.hasSmoothPart(); }
  const Point3& position() const { return hit_.position; }
  const PathState& state() const { return state_; }

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
  const PathState& state_;
  double side_; ///< -1: the path is inside the solid
  Vector3 smooth_, normal_;
  bool turned_;
  Frame frame_;
  Bsdf bsdf_;
};

bool PathTracer::reaches(const Vertex& vertex, const LightSample& light, RayCount& count,
                         Color& through) const {
  const Ray ray{vertex.position(), light.toLight};
  ++count.traced;
  Feature blocker = Feature::Flat;
  const bool reached = media_.at(vertex.state(), light.toLight) || light.solid != kNone
                           ? reachesThrough(ray, vertex.state(), light, through, blocker)
                           : !tracer_.occluded(ray, vertex.state(), 0, light.tfar, &blocker);
  count.hits += !reached;
  count.rounded += !reached && blocker != Feature::Flat;
  return reached;
}

/// Of a light that is a rounded solid, or as seen from inside a medium: surfaces between equal media do not
/// stop it.
bool PathTracer::reachesThrough(const Ray& ray, const PathState& from, const LightSample& light,
                                Color& through, Feature& blocker) const {
  const bool isSolid = light.solid != kNone;
  const auto isLight = [&](const TraceHit& hit) {
    return hit.instance == light.instance && hit.solid == light.solid;
  };
  const Material* medium = media_.at(from, ray.direction);
  const double size = length(ray.direction), end = isSolid ? INFINITY : light.tfar;
  Arrival arrival;
  const PathState* state = &from;
  double t = 0;
  for (unsigned nothings = 0; nothings < kMostNothings; ++nothings) {
    const auto hit = tracer_.intersect(ray, *state, t, end, &arrival);
    if (!hit) {
      if (std::isfinite(end)) through *= transmittance(medium, (end - t) * size);
      return !isSolid; // else past the rounded emitter, into the void
    }
    through *= transmittance(medium, (hit->t - t) * size);
    blocker = surfaces_.place(*hit).feature;
    if (isSolid && (isLight(*hit) || std::any_of(arrival.touching.begin(), arrival.touching.end(), isLight)))
      return true;
    if (!media_.crossing(*hit, arrival, ray.direction).nothing) return false;
    t = hit->t;
    state = &arrival.state;
  }
  return false;
}

Color PathTracer::directLight(const Vertex& vertex, const Float2& choice, const Float2& u,
                              RayStatistics& statistics) const {
  const LightSample light = lights_.sample(vertex.position(), choice.x, u);
  if (!(light.pdf > 0) || light.radiance.isBlack()) return {};
  const BsdfValue scattered = vertex.evaluate(light.toLight * (1 / length(light.toLight)));
  if (scattered.f.isBlack()) return {};
  Color through = grey(1);
  if (!reaches(vertex, light, statistics.shadow, through)) return {};
  const Color arriving = scattered.f * light.radiance * through;
  if (light.delta) return arriving;
  return arriving * (powerHeuristic(light.pdf, scattered.pdf) / light.pdf);
}

Color PathTracer::radiance(Ray ray, const PathState& from, const Sampler& sampler,
                           RayStatistics& statistics) const {
  Color sum, throughput = grey(1);
  float scatterPdf = 0; // with which the last direction was drawn; 0: delta or camera
  unsigned spread = 0;  // scatterings so far that were no deltas
  unsigned nothings = 0;
  const auto limited = [this](const Color& light, bool indirect) {
    const float most = maxComponent(light);
    return indirect && most > indirectClamp_ ? light * (indirectClamp_ / most) : light;
  };
  float etaScale = 1; // undoes the compression of radiance in glass, for Russian roulette only
  RayCount* count = &statistics.camera;
  Arrival arrival;
  const PathState* state = &from;
  double start = 0; ///< beyond 0 where the ray has gone through surfaces that are none
  for (unsigned bounce = 0;;) {
    ++count->traced;
    const auto hit = tracer_.intersect(ray, *state, start, INFINITY, &arrival);
    if (!hit)
      return sum + limited(throughput * lights_.escaped(Vector3f(ray.direction), scatterPdf), spread > 1);
    state = &arrival.state;
    ++count->hits;
    const Crossing crossing = media_.crossing(*hit, arrival, ray.direction);
    const SurfacePlace& place = crossing.place;
    const Material& material = *place.material;
    count->rounded += place.rounded();
    if (crossing.before) throughput *= transmittance(crossing.before, crossing.hit->t - start);
    if (crossing.nothing) {
      if (++nothings > kMostNothings) return sum;
      start = crossing.hit->t;
      continue;
    }
    if (material.emits()) {
      const float lightPdf = scatterPdf > 0 ? lights_.foundPdf(*crossing.hit, ray) : 0;
      const float weight = lightPdf > 0 ? powerHeuristic(scatterPdf, lightPdf) : 1;
      sum += limited(throughput * material.emission * weight, spread > 1);
    }
    if (bounce == maxBounces_) return sum;

    const Vertex vertex(*crossing.hit, arrival.state, ray.direction,
                        surfaces_.shadingNormal(*crossing.hit, place, sampler, bounce),
                        surfaces_.values(*crossing.hit, place), crossing.eta);
    const std::uint32_t pair = kFirstPathPair + bounce * kPairsPerBounce;
    const Float2 choice = sampler.pair(pair + kChoicePair);
    if (vertex.hasSmoothPart() && !lights_.empty())
      sum += limited(throughput * directLight(vertex, choice, sampler.pair(pair + kLightPair), statistics),
                     spread > 0);

    const BsdfSample scattered = vertex.sample(choice.y, sampler.pair(pair + kScatterPair), ray.direction);
    if (!scattered.valid) return sum;
    ray.origin = crossing.hit->position;
    start = 0;
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
    ++bounce;
  }
}

} // namespace chamfer
