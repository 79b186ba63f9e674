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
  const Float2 choice = path.sampler.pair(pair + kChoicePair), light = path.sampler.pair(pair + kLightPair),
               scatter = path.sampler.pair(pair + kScatterPair);
  choice_[i] = choice.x;
  lobe_[i] = choice.y;
  lightX_[i] = light.x;
  lightY_[i] = light.y;
  scatterX_[i] = scatter.x;
  scatterY_[i] = scatter.y;
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
    choice_[i] = choice_[0];
    lobe_[i] = lobe_[0];
    lightX_[i] = lightX_[0];
    lightY_[i] = lightY_[0];
    scatterX_[i] = scatterX_[0];
    scatterY_[i] = scatterY_[0];
  }
  const FrameT<Lanes> frame{VectorLanes(normal_)};
  VectorLanes wo = frame.toLocal(outgoing_);
  wo.z = max(wo.z, Lanes(1e-6f));
  const OpaqueBsdf bsdf(surfaces_, wo);

  const LaneMask smooth = bsdf.hasSmoothPart();
  if (!tracer.lights().empty() && any_of(smooth)) {
    LightLanes light;
    lightSampler.sample(positions_, choice_, lightX_, lightY_, count_, light);
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

  const BsdfSampleLanes next = bsdf.sample(lobe_, scatterX_, scatterY_);
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
