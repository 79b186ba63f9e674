// The walk over E's Voronoi cells.
//
// The distance to a convex set is convex along a line, and inside the Voronoi cell of one of E's features it
// is the distance to that feature's plane, axis or centre. So for the feature at hand we solve for the place
// where the line enters the feature's offset surface or, when it misses that, comes nearest to the feature.
// If that place lies in the feature's own cell it is the answer, hit or miss; otherwise we go to the
// neighbour across the border that it is farthest beyond. An answer found this way is right whatever the way
// to it was. Only the end of the way is not certain (rounding at borders of nearly flat edges), so after a
// bounded number of steps a guarded search takes over: Newton's method on the distance, which is monotone for
// a convex function, with the same exact solve at each place.
//
// Conditioning (Haines et al., Ray Tracing Gems, ch. 7): the place of closest approach comes first and
// squared distances are compared there; the textbook quadratic's cancellation does not occur.
#include "common/core_walk.h"

#include <algorithm>

namespace chamfer {
namespace {

/// What one feature says of a line: where it enters the feature's offset surface or, when it misses that, is
/// nearest to the feature; and whether that place is in the feature's own cell.
struct Step {
  bool bounded =
      false; ///< false: there is no such place (parallel to the feature, or leaving the half-space)
  bool hit = false;
  bool settled = false; ///< the place is in the feature's cell: it is the answer
  double t = 0;
  Vector3 outward;  ///< from the feature to the place; of any length
  CoreFeature next; ///< not settled: the neighbour across the border that the place is farthest beyond
};

/// `w`, `d`: the line relative to the axis or centre, with the part along the axis removed; `whole`: squared
/// length of the direction with it.
[[gnu::always_inline]] inline void meetOffset(Step& step, const Vector3& w, const Vector3& d, double whole,
                                              double r) {
  const double a = lengthSquared(d);
  if (!(a > 1e-28 * whole)) return;
  const double nearest = -dot(w, d) / a;
  const double left = r * r - lengthSquared(w + d * nearest);
  step.bounded = true;
  step.hit = left >= 0;
  step.t = step.hit ? nearest - std::sqrt(left / a) : nearest;
  step.outward = w + d * step.t;
}

[[gnu::always_inline]] inline void meetFace(Step& step, const CoreView& core, const Vector3& o,
                                            const Vector3& d) {
  const std::uint32_t facet = core.halfEdge(step.next.halfEdge()).facet;
  const Vector3 n = core.normal(facet);
  const double slope = dot(n, d);
  if (!(slope < 0)) return;
  step.bounded = step.hit = true;
  step.t = (double(core.facet(facet).offset) - dot(n, o)) / slope;
  step.outward = n;
  step.settled = core.inCell(step.next, o + d * step.t);
}

[[gnu::always_inline]] inline void meetVertex(Step& step, const CoreView& core, const Vector3& o,
                                              const Vector3& d) {
  meetOffset(step, o - core.start(step.next.halfEdge()), d, lengthSquared(d), core.radius());
  if (step.bounded) step.settled = core.inCell(step.next, o + d * step.t);
}

[[gnu::always_inline]] inline void meetEdge(Step& step, const CoreView& core, const Vector3& o,
                                            const Vector3& d) {
  const HalfEdge h = core.halfEdge(step.next.halfEdge()), twin = core.halfEdge(h.twin);
  const Vector3 a = core.centre(h.sphere), axis = core.centre(twin.sphere) - a, w = o - a;
  const double squared = lengthSquared(axis), whole = lengthSquared(d);
  if (!(squared > 0)) { // two centres that coincide
    meetOffset(step, w, d, whole, core.radius());
    if (step.bounded) step.settled = core.inCell(step.next, o + d * step.t);
    return;
  }
  const double inverse = 1 / squared, alongW = dot(w, axis), alongD = dot(d, axis);
  meetOffset(step, w - axis * (alongW * inverse), d - axis * (alongD * inverse), whole, core.radius());
  if (!step.bounded) return;
  // The place is a + axis * (along / squared) + outward, and the borders to the faces hold the axis.
  const double along = alongW + alongD * step.t;
  step.settled =
      core.inEdgeCell(step.next, h, along, squared, dot(step.outward, cross(axis, core.normal(h.facet))),
                      dot(step.outward, cross(axis, core.normal(twin.facet))));
}

[[gnu::always_inline]] inline Step stepAt(const CoreView& core, const CoreFeature& feature, const Vector3& o,
                                          const Vector3& d) {
  Step step;
  step.next = feature;
  switch (feature.kind()) {
  case CoreFeature::Face:
    meetFace(step, core, o, d);
    break;
  case CoreFeature::Edge:
    meetEdge(step, core, o, d);
    break;
  case CoreFeature::Vertex:
    meetVertex(step, core, o, d);
    break;
  }
  return step;
}

/// Where to go when the feature gives no place on the line: to the side that the line comes from.
CoreFeature upstream(const CoreView& core, const CoreFeature& feature, const Vector3& d) {
  const HalfEdge he = core.halfEdge(feature.halfEdge());
  if (feature.kind() == CoreFeature::Edge) {
    const Vector3 axis = core.end(feature.halfEdge()) - core.start(feature.halfEdge());
    return {CoreFeature::Vertex, dot(axis, d) > 0 ? feature.halfEdge() : he.twin};
  }
  const Vector3 n = core.normal(he.facet);
  std::uint32_t best = feature.halfEdge();
  double deepest = -INFINITY;
  for (std::uint32_t h = core.facet(he.facet).firstHalfEdge();
       h < core.halfEdgeCount() && core.halfEdge(h).facet == he.facet; ++h) {
    const Vector3 axis = core.end(h) - core.start(h);
    const double against = -dot(cross(axis, n), d);
    const double depth = against * std::abs(against) / std::max(lengthSquared(axis), 1e-300);
    if (depth > deepest) {
      deepest = depth;
      best = h;
    }
  }
  return {CoreFeature::Edge, best};
}

/// Unit direction from the feature to `p`, and the distance; a face's distance may be negative.
struct Offset {
  Vector3 direction;
  double distance;
};

Offset offsetFrom(const CoreView& core, const CoreFeature& feature, const Vector3& p) {
  const HalfEdge he = core.halfEdge(feature.halfEdge());
  if (feature.kind() == CoreFeature::Face) {
    const Vector3 n = core.normal(he.facet);
    return {n, dot(n, p) - (double(core.facet(he.facet).offset) - core.radius())};
  }
  const Vector3 c = core.centre(he.sphere);
  Vector3 w = p - c;
  if (feature.kind() == CoreFeature::Edge) {
    const Vector3 axis = core.end(feature.halfEdge()) - c;
    const double squared = lengthSquared(axis);
    if (squared > 0) w -= axis * (dot(w, axis) / squared);
  }
  const double distance = length(w);
  if (!(distance > 0)) return {core.normal(he.facet), 0};
  return {w / distance, distance};
}

Feature featureOf(const CoreFeature& feature) {
  return feature.kind() == CoreFeature::Face   ? Feature::Flat
         : feature.kind() == CoreFeature::Edge ? Feature::Cylinder
                                               : Feature::Sphere;
}

std::optional<RoundedEnd> answer(const CoreFeature& feature, const Step& step) {
  if (!step.hit) return std::nullopt;
  return RoundedEnd{step.t, feature.kind() == CoreFeature::Face ? step.outward : normalize(step.outward),
                    featureOf(feature)};
}

/// The face of E through which the segment from the origin, a point of E, to `p` leaves: the greatest n.p /
/// (d - r). A linear function over the corners of E's dual, so climbing from neighbour to neighbour finds the
/// greatest.
CoreFeature faceTowards(const CoreView& core, const Vector3& p, std::uint32_t halfEdge) {
  const auto reach = [&](std::uint32_t facet) {
    return dot(core.normal(facet), p) / (double(core.facet(facet).offset) - core.radius());
  };
  std::uint32_t facet = core.halfEdge(halfEdge).facet;
  double farthest = reach(facet);
  for (std::uint32_t steps = 0; steps < core.halfEdgeCount(); ++steps) {
    std::uint32_t best = facet;
    for (std::uint32_t h = core.facet(facet).firstHalfEdge();
         h < core.halfEdgeCount() && core.halfEdge(h).facet == facet; ++h) {
      const std::uint32_t other = core.halfEdge(core.halfEdge(h).twin).facet;
      if (const double there = reach(other); there > farthest) {
        farthest = there;
        best = other;
      }
    }
    if (best == facet) break;
    facet = best;
  }
  return {CoreFeature::Face, core.facet(facet).firstHalfEdge()};
}

bool aboveFace(const CoreView& core, const CoreFeature& face, const Vector3& p) {
  return offsetFrom(core, face, p).distance >= 0;
}

/// The feature nearest to `p`, a point outside E, by looking at all of them.
CoreFeature nearestOfAll(const CoreView& core, const Vector3& p) {
  CoreFeature best{CoreFeature::Vertex, 0};
  double nearest = INFINITY;
  const auto consider = [&](const CoreFeature& feature, double squared) {
    if (squared < nearest) {
      nearest = squared;
      best = feature;
    }
  };
  for (std::uint32_t h = 0; h < core.halfEdgeCount(); ++h) {
    const HalfEdge e = core.halfEdge(h);
    const Vector3 a = core.centre(e.sphere);
    consider({CoreFeature::Vertex, h}, lengthSquared(p - a));
    if (h < e.twin) {
      const Vector3 axis = core.end(h) - a;
      const double along = dot(p - a, axis), squared = lengthSquared(axis);
      if (along > 0 && along < squared)
        consider({CoreFeature::Edge, h}, lengthSquared(p - a - axis * (along / squared)));
    }
    if (core.facet(e.facet).firstHalfEdge() == h) {
      const CoreFeature face{CoreFeature::Face, h};
      CoreFeature there = face;
      if (aboveFace(core, face, p) && core.inCell(there, p)) {
        const double height = offsetFrom(core, face, p).distance;
        consider(face, height * height);
      }
    }
  }
  return best;
}

/// The feature of E nearest to `p`, or the face nearest in direction where `p` is inside E. From a face that
/// `p` is above, going to the neighbour whose cell `p` is farther in mostly leads there in a few steps. It
/// need not on thin solids, whose far side it may reach, nor where rounding makes a cycle of cells: then all
/// features are looked at.
CoreFeature nearestFeature(const CoreView& core, const Vector3& p, std::uint32_t startHalfEdge) {
  const CoreFeature towards = faceTowards(core, p, startHalfEdge);
  if (!aboveFace(core, towards, p)) return towards;
  CoreFeature feature = towards;
  for (std::uint32_t i = 0; i < 64; ++i) {
    if (!core.inCell(feature, p)) continue;
    if (feature.kind() == CoreFeature::Face && !aboveFace(core, feature, p)) break;
    return feature;
  }
  return nearestOfAll(core, p);
}

std::optional<RoundedEnd> guardedEntry(const CoreView& core, const Vector3& o, const Vector3& d,
                                       CoreFeature feature) {
  Step ball;
  meetOffset(ball, o, d, lengthSquared(d), core.boundRadius());
  if (!ball.hit) return std::nullopt;
  // Below this no distance means anything: the float32 noise of the stored centres.
  const double noise = 1e-7 * core.boundRadius();
  double t = ball.t;
  const auto endHere = [&](const Offset& offset) {
    return RoundedEnd{t, offset.direction, featureOf(feature)};
  };
  for (int i = 0; i < 100; ++i) {
    const Vector3 p = o + d * t;
    feature = nearestFeature(core, p, feature.halfEdge());
    if (const Step step = stepAt(core, feature, o, d); step.settled) return answer(feature, step);
    const Offset offset = offsetFrom(core, feature, p);
    const double excess = offset.distance - core.radius(), slope = dot(offset.direction, d);
    if (excess <= 1e-3 * noise && slope < 0) return endHere(offset);
    if (slope >= 0) {
      if (excess > noise) return std::nullopt;
      return endHere(offset);
    }
    t += excess / -slope;
  }
  const Offset last = offsetFrom(core, feature, o + d * t);
  if (last.distance - core.radius() > noise) return std::nullopt;
  return endHere(last);
}

} // namespace

std::optional<RoundedEnd> walkEntry(const CoreView& core, const Vector3& o, const Vector3& d,
                                    std::uint32_t startHalfEdge) {
  CoreFeature feature{CoreFeature::Edge, startHalfEdge};
  // Two or three steps are the rule. Many-sided solids seen from the wrong side take a step a facet on the
  // way.
  for (int i = 0; i < 24; ++i) {
    const Step step = stepAt(core, feature, o, d);
    if (step.settled) return answer(feature, step);
    feature = step.bounded ? step.next : upstream(core, feature, d);
  }
  return guardedEntry(core, o, d, feature);
}

bool nearCore(const CoreView& core, const Vector3& p, std::uint32_t startHalfEdge) {
  return offsetFrom(core, nearestFeature(core, p, startHalfEdge), p).distance <= core.radius();
}

} // namespace chamfer
