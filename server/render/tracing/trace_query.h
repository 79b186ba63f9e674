// One ray's search, without Embree: what is known of the ray, the best hit so far, and what each triangle
// that the ray meets means for it. Internal to the tracer.
#pragma once

#include "common/sidecar.h"
#include "server/render/tracing/flat_margins.h"
#include "server/render/tracing/tracer.h"

#include <algorithm>
#include <cmath>

namespace chamfer {

/// An instance as rays see it; pointers into the tracer's own.
struct RayInstance {
  const RoundingView* view;  ///< null: sharp
  const TriangleFlat* flats; ///< by triangle; null: sharp
  const Transform* worldFromObject;
  float objectScale; ///< an upper bound of what the way from the world to the object makes of lengths
};

/// A triangle that the ray meets, as Embree reports it.
struct MetTriangle {
  std::uint32_t instance, triangle;
  float t, u, v;
  Vector3f normal, direction; ///< of the triangle and the ray, instance's frame, any length
};

/// Lives on the caller's stack. Places along the ray are in units of its direction's length.
class TraceQuery {
public:
  TraceQuery(const std::vector<RayInstance>& rayInstances, const Ray& worldRay, const RayOrigin& origin,
             double near, double far)
      : instances(&rayInstances), ray(worldRay), from(origin), tnear(near), best(far), limit(far) {
    if (from.solid == kNone) return;
    const auto& solids = rayInstances[from.instance].view->solids;
    ownFirstFacet_ = solids[from.solid].firstFacet;
    ownEndFacet_ = solids[from.solid + 1].firstFacet;
  }

  /// Takes the triangle's end of its solid as the hit if it is nearer than the best so far.
  bool takeIfNearer(const MetTriangle& met) {
    const RayInstance& in = (*instances)[met.instance];
    if (leaves(met)) {
      noteOwnExit(in, met);
      return false;
    }
    const std::uint32_t f = in.flats ? in.flats[met.triangle].facet : kNone;
    bool flat = false;
    if (f == kNone) {
      if ((from.instance == met.instance && from.triangle == met.triangle) || !(double(met.t) < best))
        return false;
      best = double(met.t);
    } else if (!from.inside &&
               own(met.instance, f)) { // outward, a path never meets again the solid that it leaves
      noteOwnExit(in, met);
      return false;
    } else if (isSurelyFlat(in, met) && isEnd(met.instance, f)) {
      if (!counts(double(met.t))) return false;
      best = double(met.t);
      flat = true;
    } else {
      const auto nearest = endAt(in, f, met);
      if (!nearest || !counts(nearest->t)) return false;
      best = nearest->t;
      end = *nearest;
    }
    limit = std::min(limit, std::max(best, keep));
    found = true;
    surelyFlat = flat;
    instance = met.instance;
    facet = f;
    triangle = met.triangle;
    u = met.u;
    v = met.v;
    return true;
  }

  /// Does the triangle mean that something is hit before `best`? Sets end.feature to what.
  bool isBlockedBy(const MetTriangle& met) {
    if (leaves(met)) return false;
    const RayInstance& in = (*instances)[met.instance];
    const std::uint32_t f = in.flats ? in.flats[met.triangle].facet : kNone;
    if (f == kNone)
      return !(from.instance == met.instance && from.triangle == met.triangle) && double(met.t) < best;
    if (own(met.instance, f)) {
      // From its own surface inward a path leaves the rounded solid before the mesh. That far side counts as
      // flat: which feature it is need not be found out.
      return from.inside && counts(double(met.t)) && leaving(met.instance, f);
    }
    if (isSurelyFlat(in, met) && isEnd(met.instance, f) && counts(double(met.t))) return true;
    const auto feature =
        endWithin(*in.view, {f, double(met.t)}, rayFor(met.instance), tnear, best, originIs());
    if (feature) end.feature = *feature;
    return feature.has_value();
  }

  /// Lets the traversal see all triangles of the solids that the origin may be in.
  void holdOpen(double largestDiameter) {
    keep = tnear + largestDiameter / length(ray.direction);
    limit = std::max(best, keep);
  }

  bool own(std::uint32_t i, std::uint32_t f) const {
    return from.instance == i && f >= ownFirstFacet_ && f < ownEndFacet_;
  }
  std::uint32_t solid() const { ///< that is hit; kNone: a sharp triangle
    return facet == kNone ? kNone : (*instances)[instance].view->facets[facet].solid;
  }
  /// The hit's end of its solid, object frame.
  RoundedEnd hitEnd() const { return surelyFlat ? planeEnd() : end; }
  /// May the hit be in the sliver of a solid other than its own? Near an origin that may be in a sliver, it
  /// may be in the same one.
  bool hitMaybeInSliver() const {
    return hitInPassage() || inOwnSliver() || (from.maybeInSliver && from.instance != kNone && best < keep);
  }
  bool hitMaybeInSolid() const { return from.maybeInSolid || hitInPassage() || inOwnSliver(); }

  const std::vector<RayInstance>* instances;
  Ray ray; ///< world
  RayOrigin from;
  double tnear;
  double best;             ///< ends at or beyond this do not count
  double limit;            ///< the traversal may end there
  double keep = 0;         ///< `limit` may not fall below this
  bool found = false;      ///< the rest is of the best hit so far
  bool surelyFlat = false; ///< it is where the ray meets the plane of `facet`; else it is `end`
  RoundedEnd end;
  std::uint32_t instance = kNone, triangle = kNone, facet = kNone;
  float u = 0, v = 0;
  float originSize = 0, directionSize = 0; ///< largest coordinates of the ray as Embree has it

private:
  /// The ray's way through the mesh of a solid whose rounded solid it does not meet there, as far as it is
  /// known.
  struct Passage {
    double in, out; ///< infinite where not known; `out`: surely by then
    std::uint32_t instance, solid;
  };

  bool counts(double t) const { return t > tnear && t < best; }
  OriginIs originIs() const { return from.maybeInSolid ? OriginIs::Anywhere : OriginIs::Outside; }
  /// The first triangle that a path outward meets is often the one that it leaves: nothing to look up for
  /// that.
  bool leaves(const MetTriangle& met) const {
    return from.triangle == met.triangle && from.instance == met.instance && !from.inside;
  }
  /// Is the met place, which is on a flat, the end of its solid that the query is after?
  bool isEnd(std::uint32_t i, std::uint32_t f) {
    if (own(i, f)) return leaving(i, f);
    return !from.maybeInSliver; // from a sliver, the near end may come before
  }
  bool leaving(std::uint32_t i, std::uint32_t f) {
    return dot(Vector3((*instances)[i].view->facets[f].normal), rayFor(i).direction) > 0;
  }
  bool inOwnSliver() const { return from.onRounding && !from.inside && !(ownExit_ < best); }

  const Ray& rayFor(std::uint32_t i) {
    if (frameInstance_ != i) {
      objectRay_ = (*instances)[i].worldFromObject->applyInverse(ray);
      frameInstance_ = i;
    }
    return objectRay_;
  }

  /// Embree's arithmetic is float32 on places about the origin and the hit: how far the ray may be off,
  /// across itself, in the instance's units, is a few units in the last place of the larger.
  float off(const RayInstance& in, const MetTriangle& met) const {
    return 0x1p-21f * (originSize + met.t * directionSize) * in.objectScale;
  }

  /// Is the place on the triangle's flat, by its barycentric coordinates alone?
  bool isSurelyFlat(const RayInstance& in, const MetTriangle& met) const {
    const float slope = dot(met.normal, met.direction);
    return in.flats[met.triangle].holds(met.u, met.v, off(in, met),
                                        slope * slope /
                                            (lengthSquared(met.normal) * lengthSquared(met.direction)));
  }

  /// By where the ray has surely crossed the triangle's plane. Where the hit's object touches a solid, a path
  /// that goes on from the hit may be back in the solid's mesh, for all that float32 can tell.
  double crossedBy(const RayInstance& in, const MetTriangle& met) const {
    const Vector3 n(met.normal), d(met.direction);
    return double(met.t) + 2 * double(off(in, met)) * length(n) / std::abs(dot(n, d));
  }
  void noteOwnExit(const RayInstance& in, const MetTriangle& met) {
    if (from.onRounding) ownExit_ = std::min(ownExit_, crossedBy(in, met));
  }

  std::optional<RoundedEnd> endAt(const RayInstance& in, std::uint32_t f, const MetTriangle& met) {
    const Candidate candidate{f, double(met.t)};
    const Ray& objectRay = rayFor(met.instance);
    // The path goes on inward from this very surface: it meets the far end.
    if (own(met.instance, f)) return farEnd(*in.view, candidate, objectRay);
    const auto nearest = firstEndBeyond(*in.view, candidate, objectRay, tnear, originIs());
    if (!nearest || nearest->feature != Feature::Flat) pass(in, f, met);
    return nearest;
  }

  /// Remembers where the ray enters or leaves the mesh of a solid.
  void pass(const RayInstance& in, std::uint32_t f, const MetTriangle& met) {
    const std::uint32_t s = in.view->facets[f].solid;
    const unsigned known = std::min(passageCount_, unsigned(std::size(passages_)));
    unsigned k = 0;
    while (k < known && (passages_[k].instance != met.instance || passages_[k].solid != s))
      ++k;
    if (k == known) {
      if (passageCount_++ >= std::size(passages_)) return;
      passages_[k] = {INFINITY, INFINITY, met.instance, s};
    }
    if (leaving(met.instance, f))
      passages_[k].out = std::min(passages_[k].out, crossedBy(in, met));
    else
      passages_[k].in = std::min(passages_[k].in, double(met.t));
  }
  /// May the hit lie inside the mesh of another solid, by what the ray passed on its way?
  bool hitInPassage() const {
    if (passageCount_ == 0) return false;
    if (passageCount_ > std::size(passages_)) return true;
    const std::uint32_t hit = solid();
    for (unsigned k = 0; k < passageCount_; ++k) {
      const Passage& p = passages_[k];
      if (p.in < best && !(p.out < best) && (p.instance != instance || p.solid != hit)) return true;
    }
    return false;
  }

  /// Where the ray meets the facet's plane, in double.
  RoundedEnd planeEnd() const {
    const RayInstance& in = (*instances)[instance];
    const FacetRecord& record = in.view->facets[facet];
    const SolidRecord& s = in.view->solids[record.solid];
    const Ray object = in.worldFromObject->applyInverse(ray);
    const Vector3 n(record.normal), o = object.origin - Point3(s.origin[0], s.origin[1], s.origin[2]);
    return {(double(record.offset) - dot(n, o)) / dot(n, object.direction), n, Feature::Flat};
  }

  std::uint32_t ownFirstFacet_ = 0, ownEndFacet_ = 0; ///< of the solid that the path is at
  double ownExit_ = INFINITY;                         ///< by where the ray has surely left that solid's mesh
  Passage passages_[4];                               ///< as many as are counted
  unsigned passageCount_ = 0;                         ///< above the array's size: some are not known
  std::uint32_t frameInstance_ = kNone;               ///< whose frame objectRay_ is in
  Ray objectRay_;
};

} // namespace chamfer
