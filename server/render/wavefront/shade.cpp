#include "server/render/wavefront/shade.h"

namespace chamfer {

void VertexGroup::add(std::uint32_t number, const Path& path, const TraceHit& hit,
                      const SurfaceValues& surface, const PathState& state) {
  const std::size_t i = count_++;
  numbers_[i] = number;
  states_[i] = &state;
  positions_[i] = hit.position;
  upwards_[i] = hit.normal * (dot(path.ray.direction, hit.normal) > 0 ? -1.0 : 1.0);
  normal_.set(i, Vector3f(upwards_[i]));
  outgoing_.set(i, Vector3f(-path.ray.direction));
  surfaces_.baseColor.set(i, surface.baseColor);
  surfaces_.roughness[i] = surface.roughness;
  surfaces_.metallic[i] = surface.metallic;
  surfaces_.specular[i] = surface.specular;
  surfaces_.ior[i] = surface.ior;
  const std::uint32_t pair = path.firstPair();
  choice_.set(i, path.sampler.words(pair + kChoicePair));
  light_.set(i, path.sampler.words(pair + kLightPair));
  scatter_.set(i, path.sampler.words(pair + kScatterPair));
}

void VertexGroup::scatter(const PathTracer& tracer, const LightSampler& lightSampler,
                          std::vector<Path>& paths, std::vector<ShadowTask>& shadows,
                          std::vector<ShadowLight>& lights) {
  // Lanes without a vertex repeat the first one's.
  for (std::size_t i = count_; i < kLanes; ++i) {
    positions_[i] = positions_[0];
    normal_.set(i, normal_[0]);
    outgoing_.set(i, outgoing_[0]);
    surfaces_.baseColor.set(i, surfaces_.baseColor[0]);
    surfaces_.roughness[i] = surfaces_.roughness[0];
    surfaces_.metallic[i] = surfaces_.metallic[0];
    surfaces_.specular[i] = surfaces_.specular[0];
    surfaces_.ior[i] = surfaces_.ior[0];
    for (PointWords* w : {&choice_, &light_, &scatter_})
      w->set(i, {w->reversedIndex[0], w->shuffle[0], w->first[0], w->second[0]});
  }
  LaneFloats choice, lobe, ux, uy;
  choice_.make(choice, lobe);
  const FrameT<Lanes> frame{VectorLanes(normal_)};
  VectorLanes wo = frame.toLocal(outgoing_);
  wo.z = max(wo.z, Lanes(1e-6f));
  const OpaqueBsdf bsdf(surfaces_, wo);

  const LaneMask smooth = bsdf.hasSmoothPart();
  if (!tracer.lights().empty() && any_of(smooth)) {
    LightLanes light;
    light_.make(ux, uy);
    lightSampler.sample(positions_, choice, ux, uy, count_, light);
    for (std::size_t i = count_; i < kLanes; ++i)
      light.pdf[i] = 0, light.delta[i] = false;
    const VectorLanes wi = frame.toLocal(light.direction);
    const BsdfLanes scattered = bsdf.evaluate(wi);
    const ColorLaneFloats arriving(scattered.f * ColorLanes(light.radiance));
    const LaneFloats pdf(scattered.pdf), above(wi.z);
    for (std::size_t i = 0; i < count_; ++i) {
      if (!(light.pdf[i] > 0) || !smooth[i] || !(above[i] > 0) || !(dot(light.toLight[i], upwards_[i]) > 0))
        continue;
      Color c = arriving[i];
      if (c.isBlack()) continue;
      if (!light.delta[i]) c *= powerHeuristic(light.pdf[i], pdf[i]) / light.pdf[i];
      const Path& path = paths[numbers_[i]];
      shadows.push_back({{positions_[i], light.toLight[i]}, states_[i], light.tfar[i]});
      lights.push_back({numbers_[i], tracer.limited(path.throughput * c, path.spread > 0)});
    }
  }

  scatter_.make(ux, uy);
  const BsdfSampleLanes next = bsdf.sample(lobe, ux, uy);
  const VectorLaneFloats world(normalize(frame.toWorld(next.wi)));
  const LaneFloats above(next.wi.z);
  weight_ = ColorLaneFloats(next.weight);
  pdf_ = LaneFloats(next.pdf);
  for (std::size_t i = 0; i < count_; ++i) {
    delta_[i] = next.delta[i];
    const Vector3 direction(world[i]);
    const double side = dot(direction, upwards_[i]);
    valid_[i] = next.valid[i] && (above[i] > 0 ? side > 0 : side < 0);
    if (valid_[i]) paths[numbers_[i]].ray = {positions_[i], direction};
  }
}

} // namespace chamfer
