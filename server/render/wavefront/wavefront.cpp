#include "server/render/wavefront/wavefront.h"

namespace chamfer {

void Wavefront::clear() {
  paths_.clear();
  from_.clear();
  active_.clear();
  cameraRays_ = true;
}

std::size_t Wavefront::add(const Ray& ray, const PathState& from, const Sampler& sampler) {
  const std::size_t number = paths_.size();
  paths_.emplace_back(ray, sampler);
  from_.push_back(&from);
  active_.push_back(std::uint32_t(number));
  return number;
}

void Wavefront::follow(RayStatistics& statistics) {
  if (hits_.size() < paths_.size()) {
    hits_.resize(paths_.size());
    arrivals_.resize(paths_.size());
  }
  while (!active_.empty()) {
    trace(statistics);
    meet(statistics);
    addUnshadowed(statistics);
  }
}

void Wavefront::trace(RayStatistics& statistics) {
  tasks_.clear();
  for (const std::uint32_t i : active_) {
    const Path& p = paths_[i];
    ++(p.bounce == 0 ? statistics.camera : statistics.bounce).traced;
    tasks_.push_back({&p.ray, from_[i], p.start, INFINITY, &hits_[i], &arrivals_[i]});
  }
  tracer_.tracer().intersect(tasks_, cameraRays_);
  cameraRays_ = false;
}

bool Wavefront::isCommon(const Crossing& crossing, const PathState& state) const {
  const Surfaces& surfaces = tracer_.surfaces();
  return inLanes_ && crossing.place.material->transmission == 0 && state.places.size() == 1 &&
         surfaces.filling(state.places[0].instance, state.places[0].triangle).transmission == 0 &&
         surfaces.hasOwnNormal(*crossing.hit, crossing.place);
}

/// What emits and what ends, one path after the other; vertices are shaded here or in lanes.
void Wavefront::meet(RayStatistics& statistics) {
  next_.clear();
  for (std::size_t k = 0; k < active_.size(); ++k) {
    const std::uint32_t i = active_[k];
    Path& path = paths_[i];
    if (!tasks_[k].found) {
      tracer_.escape(path);
      continue;
    }
    const PathState& state = arrivals_[i].state;
    from_[i] = &state;
    const Crossing crossing = tracer_.media().crossing(hits_[i], arrivals_[i], path.ray.direction);
    const auto met = tracer_.meet(path, crossing, path.bounce == 0 ? statistics.camera : statistics.bounce);
    if (met == PathTracer::Met::End) continue;
    if (met == PathTracer::Met::Surface) {
      if (isCommon(crossing, state)) {
        common_.add(i, path, *crossing.hit, tracer_.surfaces().values(*crossing.hit, crossing.place), state);
        if (common_.full()) shade();
        continue;
      }
      if (!tracer_.scatter(path, crossing, state, statistics)) continue;
    }
    next_.push_back(i);
  }
  if (!common_.empty()) shade();
  active_.swap(next_);
}

void Wavefront::shade() {
  common_.shade(tracer_, lights_, paths_, shadows_, shadowLights_,
                [&](std::uint32_t i) { next_.push_back(i); });
}

void Wavefront::addUnshadowed(RayStatistics& statistics) {
  tracer_.tracer().occluded(shadows_);
  statistics.shadow.traced += shadows_.size();
  for (std::size_t k = 0; k < shadows_.size(); ++k) {
    const ShadowTask& shadow = shadows_[k];
    statistics.shadow.hits += shadow.blocked;
    statistics.shadow.rounded += shadow.blocked && shadow.blocker != Feature::Flat;
    if (!shadow.blocked) paths_[shadowLights_[k].path].sum += shadowLights_[k].light;
  }
  shadows_.clear();
  shadowLights_.clear();
}

} // namespace chamfer
