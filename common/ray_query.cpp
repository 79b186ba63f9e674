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
#include "common/ray_query.h"

#include "common/core_view.h"

#include <algorithm>

namespace chamfer {
namespace {

/// Where the line enters the offset surface of one feature, or is nearest to the feature.
struct Solution {
  bool hit;
  bool bounded; ///< false: the line has no such place (parallel to the feature, or leaves the half-space)
  double t;
};

Solution solvePlane(const CoreView& core, std::uint32_t facet, const Vector3& o, const Vector3& d) {
  const Vector3 n = core.normal(facet);
  const double slope = dot(n, d);
  if (!(slope < 0)) return {false, false, 0};
  return {true, true, (double(core.facet(facet).offset) - dot(n, o)) / slope};
}

/// `w`, `d`: the line relative to the axis or centre, with the part along the axis removed.
Solution solveOffset(const Vector3& w, const Vector3& d, double scale, double r) {
  const double a = lengthSquared(d);
  if (!(a > 1e-28 * scale)) return {false, false, 0};
  const double nearest = -dot(w, d) / a;
  const double left = r * r - lengthSquared(w + d * nearest);
  if (left < 0) return {false, true, nearest};
  return {true, true, nearest - std::sqrt(left / a)};
}

Solution solve(const CoreView& core, const CoreFeature& feature, const Vector3& o, const Vector3& d) {
  if (feature.kind == CoreFeature::Face) return solvePlane(core, core.halfEdge(feature.halfEdge).facet, o, d);
  const Vector3 c = core.start(feature.halfEdge), w = o - c;
  if (feature.kind == CoreFeature::Vertex) return solveOffset(w, d, lengthSquared(d), core.radius());
  const Vector3 axis = core.end(feature.halfEdge) - c;
  const double squared = lengthSquared(axis);
  if (!(squared > 0)) return solveOffset(w, d, lengthSquared(d), core.radius());
  return solveOffset(w - axis * (dot(w, axis) / squared), d - axis * (dot(d, axis) / squared),
                     lengthSquared(d), core.radius());
}

/// Where to go when the feature gives no place on the line: to the side that the line comes from.
CoreFeature upstream(const CoreView& core, const CoreFeature& feature, const Vector3& d) {
  const HalfEdge he = core.halfEdge(feature.halfEdge);
  if (feature.kind == CoreFeature::Edge) {
    const Vector3 axis = core.end(feature.halfEdge) - core.start(feature.halfEdge);
    return {CoreFeature::Vertex, dot(axis, d) > 0 ? feature.halfEdge : he.twin};
  }
  const Vector3 n = core.normal(he.facet);
  std::uint32_t best = feature.halfEdge;
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
  const HalfEdge he = core.halfEdge(feature.halfEdge);
  if (feature.kind == CoreFeature::Face) {
    const Vector3 n = core.normal(he.facet);
    return {n, dot(n, p) - (double(core.facet(he.facet).offset) - core.radius())};
  }
  const Vector3 c = core.centre(he.sphere);
  Vector3 w = p - c;
  if (feature.kind == CoreFeature::Edge) {
    const Vector3 axis = core.end(feature.halfEdge) - c;
    const double squared = lengthSquared(axis);
    if (squared > 0) w -= axis * (dot(w, axis) / squared);
  }
  const double distance = length(w);
  if (!(distance > 0)) return {core.normal(he.facet), 0};
  return {w / distance, distance};
}

RoundedEnd makeEnd(const CoreView& core, const CoreFeature& feature, const Vector3& o, const Vector3& d,
                   double t) {
  const Feature kind = feature.kind == CoreFeature::Face   ? Feature::Flat
                       : feature.kind == CoreFeature::Edge ? Feature::Cylinder
                                                           : Feature::Sphere;
  return {t, offsetFrom(core, feature, o + d * t).direction, kind};
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
    if (feature.kind == CoreFeature::Face && !aboveFace(core, feature, p)) break;
    return feature;
  }
  return nearestOfAll(core, p);
}

std::optional<RoundedEnd> guardedEntry(const CoreView& core, const Vector3& o, const Vector3& d,
                                       CoreFeature feature) {
  const Solution ball = solveOffset(o, d, lengthSquared(d), core.boundRadius());
  if (!ball.hit) return std::nullopt;
  // Below this no distance means anything: the float32 noise of the stored centres.
  const double noise = 1e-7 * core.boundRadius();
  double t = ball.t;
  for (int i = 0; i < 100; ++i) {
    const Vector3 p = o + d * t;
    feature = nearestFeature(core, p, feature.halfEdge);
    if (const Solution s = solve(core, feature, o, d); s.bounded) {
      CoreFeature there = feature;
      if (core.inCell(there, o + d * s.t)) {
        if (!s.hit) return std::nullopt;
        return makeEnd(core, feature, o, d, s.t);
      }
    }
    const Offset offset = offsetFrom(core, feature, p);
    const double excess = offset.distance - core.radius(), slope = dot(offset.direction, d);
    if (excess <= 1e-3 * noise && slope < 0) return makeEnd(core, feature, o, d, t);
    if (slope >= 0) {
      if (excess > noise) return std::nullopt;
      return makeEnd(core, feature, o, d, t);
    }
    t += excess / -slope;
  }
  const Offset last = offsetFrom(core, feature, o + d * t);
  if (last.distance - core.radius() > noise) return std::nullopt;
  return makeEnd(core, feature, o, d, t);
}

std::optional<RoundedEnd> walkEntry(const CoreView& core, const Vector3& o, const Vector3& d,
                                    std::uint32_t startHalfEdge) {
  CoreFeature feature{CoreFeature::Edge, startHalfEdge};
  // Two or three steps are the rule. Many-sided solids seen from the wrong side take a step a facet on the
  // way.
  for (int i = 0; i < 24; ++i) {
    const Solution s = solve(core, feature, o, d);
    if (!s.bounded) {
      feature = upstream(core, feature, d);
      continue;
    }
    CoreFeature there = feature;
    if (core.inCell(there, o + d * s.t)) {
      if (!s.hit) return std::nullopt;
      return makeEnd(core, feature, o, d, s.t);
    }
    feature = there;
  }
  return guardedEntry(core, o, d, feature);
}

Vector3 solidOrigin(const SolidRecord& s) { return {s.origin[0], s.origin[1], s.origin[2]}; }

std::optional<RoundedEnd> shifted(std::optional<RoundedEnd> end, double by) {
  if (end) end->t += by;
  return end;
}

} // namespace

Detection detect(const RoundingView& view, std::uint32_t solid, std::uint32_t facet, const Point3& p) {
  // On its own two facets a detection cylinder (axis midway between the edge and the rounding axis, radius
  // r / (2 sin alpha)) holds, by Thales, just the points between the edge and the tangent line. The tangent
  // line is E's edge moved out by r along the facet's normal, so "in the cylinder" is the side of the plane
  // through E's edge and the normal: linear, where the squared distance to the axis would cancel.
  const CoreView core(view, solid);
  const FacetRecord& record = view.facets[facet];
  if (record.vanished()) return {true, record.firstHalfEdge()};
  const Vector3 q(p);
  if (!record.hasTree()) {
    CoreFeature feature{CoreFeature::Face, record.firstHalfEdge()};
    const bool flat = core.inCell(feature, q);
    return {!flat, feature.halfEdge};
  }
  const auto root = std::lower_bound(view.treeRoots.begin(), view.treeRoots.end(), facet,
                                     [](const TreeRoot& r, std::uint32_t f) { return r.facet < f; });
  std::uint32_t node = root->node;
  while (!view.treeNodes[node].leaf()) {
    const TreeNode& n = view.treeNodes[node];
    node = n.first() + (p[n.axis()] < double(n.split) ? 0u : 1u);
  }
  const TreeNode& leaf = view.treeNodes[node];
  const Vector3 normal(record.normal);
  double deepest = 0;
  std::uint32_t found = kNone;
  for (std::uint32_t i = 0, h = leaf.first(); i < leaf.count; ++i, h = core.next(h))
    if (const double depth = core.squaredBeyond(h, normal, q); depth > deepest) {
      deepest = depth;
      found = h;
    }
  if (found == kNone) return {false, record.firstHalfEdge()};
  return {true, found};
}

std::optional<RoundedEnd> entry(const RoundingView& view, std::uint32_t solid, const Ray& ray,
                                std::uint32_t startHalfEdge) {
  return walkEntry(CoreView(view, solid), Vector3(ray.origin), ray.direction, startHalfEdge);
}

std::optional<RoundedEnd> exit(const RoundingView& view, std::uint32_t solid, const Ray& ray,
                               std::uint32_t startHalfEdge) {
  auto end = entry(view, solid, {ray.origin, -ray.direction}, startHalfEdge);
  if (end) end->t = -end->t;
  return end;
}

std::optional<RoundedInterval> interval(const RoundingView& view, std::uint32_t solid, const Ray& ray,
                                        std::uint32_t startHalfEdge) {
  const auto in = entry(view, solid, ray, startHalfEdge);
  if (!in) return std::nullopt;
  const auto out = exit(view, solid, ray, startHalfEdge);
  if (!out) return std::nullopt;
  return RoundedInterval{*in, *out};
}

namespace {

/// A candidate looked at closely, in its solid's frame.
struct Approach {
  std::uint32_t solid;
  double t;     ///< where the ray meets the facet's plane
  Ray near;     ///< the ray with its origin moved there
  double slope; ///< of the facet's normal along the ray: below 0 for a front-facing candidate
  bool flat;    ///< that place is on the flat, so it is an end of the interval itself
  std::uint32_t start;
  Vector3 normal;

  std::optional<RoundedEnd> in(const RoundingView& view) const {
    if (flat && slope < 0) return RoundedEnd{t, normal, Feature::Flat};
    return shifted(entry(view, solid, near, start), t);
  }
  std::optional<RoundedEnd> out(const RoundingView& view) const {
    if (flat && slope > 0) return RoundedEnd{t, normal, Feature::Flat};
    return shifted(exit(view, solid, near, start), t);
  }
};

/// The facet's plane, not the triangle, gives the place: exact where the ray is not parallel to it, and
/// wherever it falls, a point on the flat is on R and any other is only a start for the walk.
Approach approach(const RoundingView& view, const Candidate& candidate, const Vector3& o, const Vector3& d) {
  const FacetRecord& facet = view.facets[candidate.facet];
  Approach a{facet.solid, candidate.t, {}, 0, false, 0, Vector3(facet.normal)};
  a.slope = dot(a.normal, d);
  if (a.slope != 0) a.t = (double(facet.offset) - dot(a.normal, o)) / a.slope;
  a.near = {Point3(o + d * a.t), d};
  const Detection detection = detect(view, facet.solid, candidate.facet, a.near.origin);
  a.flat = !detection.inZone && a.slope != 0;
  a.start = detection.halfEdge;
  return a;
}

/// Is the point inside E? False without looking where a solid has many facets.
bool inCore(const RoundingView& view, std::uint32_t solid, const Vector3& p) {
  const SolidRecord& record = view.solids[solid];
  const std::uint32_t end = view.solids[solid + 1].firstFacet;
  if (end - record.firstFacet > 32) return false;
  for (std::uint32_t f = record.firstFacet; f < end; ++f)
    if (dot(Vector3(view.facets[f].normal), p) > double(view.facets[f].offset) - double(record.radius))
      return false;
  return true;
}

} // namespace

std::optional<RoundedEnd> firstEndBeyond(const RoundingView& view, const Candidate& candidate, const Ray& ray,
                                         double tnear) {
  const SolidRecord& record = view.solids[view.facets[candidate.facet].solid];
  const Vector3 o = Vector3(ray.origin) - solidOrigin(record);
  const Approach a = approach(view, candidate, o, ray.direction);
  if (a.slope < 0) {
    const auto in = a.in(view);
    if (!in || in->t > tnear) return in;
    const auto out = a.out(view);
    return out && out->t > tnear ? out : std::nullopt;
  }
  const double bound = record.boundRadius;
  if (lengthSquared(o + ray.direction * tnear) > bound * bound) return std::nullopt;
  const auto out = a.out(view);
  if (!out || out->t <= tnear) return std::nullopt;
  // The ray begins inside P: in R, or in the sliver in front of R. Mostly deep inside, which is cheap to see.
  if (inCore(view, view.facets[candidate.facet].solid, o + ray.direction * tnear)) return out;
  const auto in = a.in(view);
  return in && in->t > tnear ? in : out;
}

std::optional<RoundedEnd> farEnd(const RoundingView& view, const Candidate& candidate, const Ray& ray) {
  const SolidRecord& record = view.solids[view.facets[candidate.facet].solid];
  return approach(view, candidate, Vector3(ray.origin) - solidOrigin(record), ray.direction).out(view);
}

} // namespace chamfer
