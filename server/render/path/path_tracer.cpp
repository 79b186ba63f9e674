#include "server/render/path/path_tracer.h"

#include "server/render/surface/shading_normal.h"

namespace chamfer {
namespace {

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

  BsdfValue evaluate(const LightSample& light) const {
    const Vector3f local = frame_.toLocal(light.direction);
    if (!sameSide(local, light.toLight)) return {};
    return bsdf_.evaluate(local, diffuseLeft(Vector3(light.direction)));
  }
  /// `wi` is set to the direction in the world, unit for float32.
  BsdfSample sample(float lobe, const Float2& u, Vector3& wi) const {
    BsdfSample s = bsdf_.sample(lobe, u);
    if (!s.valid) return s;
    wi = Vector3(normalize(frame_.toWorld(s.wi)));
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
  const BsdfValue scattered = vertex.evaluate(light);
  if (scattered.f.isBlack()) return {};
  Color through = grey(1);
  if (!reaches(vertex, light, statistics.shadow, through)) return {};
  const Color arriving = scattered.f * light.radiance * through;
  if (light.delta) return arriving;
  return arriving * (powerHeuristic(light.pdf, scattered.pdf) / light.pdf);
}

void PathTracer::escape(Path& path) const {
  path.sum += limited(path.throughput * lights_.escaped(Vector3f(path.ray.direction), path.scatterPdf),
                      path.spread > 1);
}

PathTracer::Met PathTracer::meet(Path& path, const Crossing& crossing, RayCount& count) const {
  ++count.hits;
  count.rounded += crossing.place.rounded();
  if (crossing.before) path.throughput *= transmittance(crossing.before, crossing.hit->t - path.start);
  if (crossing.nothing) {
    path.start = crossing.hit->t;
    return ++path.nothings > kMostNothings ? Met::End : Met::Nothing;
  }
  if (crossing.place.material->emits()) {
    const float lightPdf = path.scatterPdf > 0 ? lights_.foundPdf(*crossing.hit, path.ray) : 0;
    const float weight = lightPdf > 0 ? powerHeuristic(path.scatterPdf, lightPdf) : 1;
    path.sum += limited(path.throughput * crossing.place.material->emission * weight, path.spread > 1);
  }
  return path.bounce == maxBounces_ ? Met::End : Met::Surface;
}

bool PathTracer::scatter(Path& path, const Crossing& crossing, const PathState& state,
                         RayStatistics& statistics) const {
  const Vertex vertex(*crossing.hit, state, path.ray.direction,
                      surfaces_.shadingNormal(*crossing.hit, crossing.place, path.sampler, path.bounce),
                      surfaces_.values(*crossing.hit, crossing.place), crossing.eta);
  const std::uint32_t pair = path.firstPair();
  const Float2 choice = path.sampler.pair(pair + kChoicePair);
  if (vertex.hasSmoothPart() && !lights_.empty())
    path.sum += limited(path.throughput *
                            directLight(vertex, choice, path.sampler.pair(pair + kLightPair), statistics),
                        path.spread > 0);

  const BsdfSample scattered =
      vertex.sample(choice.y, path.sampler.pair(pair + kScatterPair), path.ray.direction);
  if (!scattered.valid) return false;
  path.ray.origin = crossing.hit->position;
  return goOn(path, scattered.weight, scattered.pdf, scattered.delta, scattered.etaSquared);
}

bool PathTracer::goOn(Path& path, const Color& weight, float pdf, bool delta, float etaSquared) const {
  path.start = 0;
  path.throughput *= weight;
  path.etaScale *= etaSquared;
  path.scatterPdf = pdf;
  path.spread += !delta;
  if (path.bounce + 1 >= kRouletteFrom) {
    const float survive = std::min(1.f, maxComponent(path.throughput) * path.etaScale);
    if (!(path.sampler.pair(path.firstPair() + kRoulettePair).x < survive)) return false;
    path.throughput *= 1 / survive;
  }
  ++path.bounce;
  return true;
}

Color PathTracer::radiance(const Ray& ray, const PathState& from, const Sampler& sampler,
                           RayStatistics& statistics) const {
  Path path(ray, sampler);
  Arrival arrival;
  const PathState* state = &from;
  for (;;) {
    RayCount& count = path.bounce == 0 ? statistics.camera : statistics.bounce;
    ++count.traced;
    const auto hit = tracer_.intersect(path.ray, *state, path.start, INFINITY, &arrival);
    if (!hit) {
      escape(path);
      return path.sum;
    }
    state = &arrival.state;
    const Crossing crossing = media_.crossing(*hit, arrival, path.ray.direction);
    const Met met = meet(path, crossing, count);
    if (met == Met::End) return path.sum;
    if (met == Met::Surface && !scatter(path, crossing, *state, statistics)) return path.sum;
  }
}

} // namespace chamfer
