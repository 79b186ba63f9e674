// Candidates judged: is the mesh hit on a flat, and if not, where does the ray meet the rounded solid? The
// search behind the second question is in core_walk.h.
#include "common/ray_query.h"

#include "common/core_walk.h"

#include <algorithm>

namespace chamfer {
namespace {

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
    return {!flat, feature.halfEdge()};
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

/// A solid with more facets is not looked at plane by plane.
bool hasFewFacets(const RoundingView& view, std::uint32_t solid) {
  return view.solids[solid + 1].firstFacet - view.solids[solid].firstFacet <= 32;
}

/// Is the point (solid's frame) inside every plane of the solid moved inward by `margin`?
bool withinPlanes(const RoundingView& view, std::uint32_t solid, const Vector3& p, double margin) {
  for (std::uint32_t f = view.solids[solid].firstFacet; f < view.solids[solid + 1].firstFacet; ++f)
    if (dot(Vector3(view.facets[f].normal), p) > double(view.facets[f].offset) - margin) return false;
  return true;
}

/// Is the point in P, or on it for all that float32 can tell?
bool inOrOnSolid(const RoundingView& view, std::uint32_t solid, const Vector3& p) {
  return withinPlanes(view, solid, p, -0x1p-20 * view.solids[solid].boundRadius);
}

/// May the point be inside P?
bool maybeInSolid(const RoundingView& view, std::uint32_t solid, const Vector3& p) {
  const double bound = view.solids[solid].boundRadius;
  return lengthSquared(p) <= bound * bound && (!hasFewFacets(view, solid) || inOrOnSolid(view, solid, p));
}

} // namespace

bool inUnroundedSolid(const RoundingView& view, std::uint32_t solid, const Point3& point) {
  return inOrOnSolid(view, solid, Vector3(point) - solidOrigin(view.solids[solid]));
}

bool maybeInUnroundedSolid(const RoundingView& view, std::uint32_t solid, const Point3& point) {
  return maybeInSolid(view, solid, Vector3(point) - solidOrigin(view.solids[solid]));
}

bool holdsSolid(const RoundingView& view, std::uint32_t outer, std::uint32_t inner) {
  const SolidRecord &o = view.solids[outer], &i = view.solids[inner];
  const Vector3 shift = solidOrigin(i) - solidOrigin(o);
  const double quantum = sphereQuantum(i), noise = 0x1p-20 * std::max(o.boundRadius, i.boundRadius);
  for (std::uint32_t f = o.firstFacet; f < view.solids[outer + 1].firstFacet; ++f) {
    const Vector3 n(view.facets[f].normal);
    if (dot(n, shift) + double(i.boundRadius) <= double(view.facets[f].offset))
      continue; // its ball is inside
    const double most = double(view.facets[f].offset) - double(i.radius) + noise - dot(n, shift);
    for (std::uint32_t s = i.firstSphere; s < view.solids[inner + 1].firstSphere; ++s)
      if (dot(n, decodeSphere(view.spheres[s], quantum)) > most) return false;
  }
  return true;
}

bool isDeepIn(const RoundingView& view, std::uint32_t solid, const Point3& point, double radius) {
  return hasFewFacets(view, solid) &&
         withinPlanes(view, solid, Vector3(point) - solidOrigin(view.solids[solid]),
                      double(view.solids[solid].radius) + radius);
}

std::optional<RoundedEnd> firstEndBeyond(const RoundingView& view, const Candidate& candidate, const Ray& ray,
                                         double tnear) {
  const std::uint32_t solid = view.facets[candidate.facet].solid;
  const Vector3 o = Vector3(ray.origin) - solidOrigin(view.solids[solid]);
  const Vector3 n(view.facets[candidate.facet].normal);
  const bool front = dot(n, ray.direction) < 0;
  if (!front && !maybeInSolid(view, solid, o + ray.direction * tnear)) return std::nullopt;
  const Approach a = approach(view, candidate, o, ray.direction);
  const auto in = a.in(view);
  if (!in || in->t > tnear) return in;
  const auto out = a.out(view);
  return out && out->t > tnear ? out : std::nullopt;
}

std::optional<RoundedEnd> nearEnd(const RoundingView& view, const Candidate& candidate, const Ray& ray) {
  const FacetRecord& facet = view.facets[candidate.facet];
  if (!(dot(Vector3(facet.normal), ray.direction) < 0)) return std::nullopt;
  return approach(view, candidate, Vector3(ray.origin) - solidOrigin(view.solids[facet.solid]), ray.direction)
      .in(view);
}

std::optional<RoundedEnd> farEnd(const RoundingView& view, const Candidate& candidate, const Ray& ray) {
  const FacetRecord& facet = view.facets[candidate.facet];
  if (!(dot(Vector3(facet.normal), ray.direction) > 0)) return std::nullopt;
  return approach(view, candidate, Vector3(ray.origin) - solidOrigin(view.solids[facet.solid]), ray.direction)
      .out(view);
}

std::optional<RoundedInterval> intervalFrom(const RoundingView& view, std::uint32_t facet, const Ray& ray) {
  const FacetRecord& record = view.facets[facet];
  const Vector3 o = Vector3(ray.origin) - solidOrigin(view.solids[record.solid]);
  return interval(view, record.solid, {Point3(o), ray.direction}, record.firstHalfEdge());
}

bool contains(const RoundingView& view, std::uint32_t solid, const Point3& point) {
  const SolidRecord& record = view.solids[solid];
  const CoreView core(view, solid);
  const Vector3 p = Vector3(point) - solidOrigin(record);
  // The face of E that the point is highest over is the nearest feature where the point is in its cell.
  double highest = -INFINITY;
  std::uint32_t over = record.firstFacet;
  for (std::uint32_t f = record.firstFacet; f < view.solids[solid + 1].firstFacet; ++f) {
    const double height = dot(Vector3(view.facets[f].normal), p) - double(view.facets[f].offset);
    if (height > 0) return false;
    if (height > highest) {
      highest = height;
      over = f;
    }
  }
  if (highest <= -core.radius()) return true;
  const FacetRecord& facet = view.facets[over];
  CoreFeature feature{CoreFeature::Face, facet.firstHalfEdge()};
  if (!facet.vanished() && core.inCell(feature, p)) return true;
  return nearCore(core, p, feature.halfEdge());
}

} // namespace chamfer
