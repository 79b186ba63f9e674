#include "server/render/path/media.h"

#include <tuple>

namespace chamfer {

Color transmittance(const Material* medium, double distance) {
  if (!medium || medium->absorption.isBlack()) return grey(1);
  const float d = float(distance);
  return {std::exp(-medium->absorption.r * d), std::exp(-medium->absorption.g * d),
          std::exp(-medium->absorption.b * d)};
}

bool Media::displaces(std::uint32_t aInstance, std::uint32_t aSolid, std::uint32_t bInstance,
                      std::uint32_t bSolid) const {
  const double a = tracer_.worldRadius(aInstance, aSolid), b = tracer_.worldRadius(bInstance, bSolid);
  if (a != b) return a < b;
  return std::tie(aInstance, aSolid) > std::tie(bInstance, bSolid);
}

const Material* Media::at(const PathState& state, const Vector3& direction) const {
  const PathState::Place* first = nullptr;
  const Material* medium = nullptr;
  for (const PathState::Place& p : state.places) {
    if (p.solid == kNone || !state.inside(p, direction)) continue;
    const Material& m = surfaces_.filling(p.instance, p.triangle);
    if (!(m.transmission > 0)) continue; // a room's, a lamp's
    if (first && !displaces(p.instance, p.solid, first->instance, first->solid)) continue;
    first = &p;
    medium = tracer_.isCavity(p.instance, p.solid) ? nullptr : &m;
  }
  return medium;
}

Crossing Media::crossing(const TraceHit& hit, Arrival& arrival, const Vector3& direction) const {
  Crossing c{&hit, surfaces_.place(hit), nullptr, 1, false};
  if (!(c.place.material->transmission > 0) && arrival.state.places.size() == 1) return c;
  c.before = at(arrival.state, -direction);
  const auto act = [&](const TraceHit& other) {
    c.hit = &other;
    c.place = surfaces_.place(other);
    PathState& state = arrival.state;
    state.normal = dot(other.normal, state.normal) < 0 ? -other.normal : other.normal;
  };
  for (const TraceHit& other : arrival.touching) {
    if (!(c.place.material->transmission > 0)) return c; // what is opaque acts
    const SurfacePlace place = surfaces_.place(other);
    if (!(place.material->transmission > 0) ||
        (other.solid != kNone &&
         (c.hit->solid == kNone || displaces(other.instance, other.solid, c.hit->instance, c.hit->solid))))
      act(other);
  }
  if (!(c.place.material->transmission > 0)) return c;
  const Material* after = at(arrival.state, direction);
  // An open surface bounds no medium: it only tints.
  c.nothing = c.before == after && c.hit->solid != kNone;
  c.eta = (after ? after->ior : 1) / (c.before ? c.before->ior : 1);
  return c;
}

} // namespace chamfer
