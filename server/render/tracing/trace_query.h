// One ray's search, without Embree: what is known of the ray, the best hit so far, and what each triangle
// that the ray meets means for it. Internal to the tracer.
//
// Embree's arithmetic is float32 on places about the ray's origin and the hit. Its ray therefore begins a
// little before the true one, by all that it may be off, and what it meets near there is decided in double:
// nothing that touches the origin is missed, and the origin's own surface is never met again. What a rounded
// solid means for the ray follows from the path's relation to it (PathState):
//  - none: the near end of the ray's interval in it, for its front-facing triangles;
//  - inside: the far end, for its back-facing ones, and again without a triangle in finish();
//  - in its sliver: the near end, found before the traversal in begin();
//  - leaving its surface: nothing, it is convex.
#pragma once

#include "server/render/tracing/closed_solids.h"
#include "server/render/tracing/flat_margins.h"
#include "server/render/tracing/tracer.h"

#include <algorithm>
#include <cmath>

namespace chamfer {

/// A mesh with its rounding, or sharp, as rays see it; pointers into the tracer's own.
struct RayForm {
  const RoundingView* view = nullptr;  ///< null: sharp
  const TriangleFlat* flats = nullptr; ///< by triangle; null: sharp
  const TriangleMesh* mesh = nullptr;
  const ClosedSolids* closed = nullptr; ///< of a mesh that transmits: for its sharp triangles
  std::uint32_t firstClosed = 0;        ///< solids from here on are those of `closed`
  bool transmits = false;
  float vertexDoubt = 0; ///< by which float32 may put the mesh and its vertices elsewhere, mesh units

  std::uint32_t closedSolid(std::uint32_t entry) const {
    return firstClosed + (entry & ~ClosedSolids::kTurned);
  }
  double solidRadius(std::uint32_t solid) const { ///< object units
    return solid < firstClosed ? double(view->solids[solid].boundRadius)
                               : 0.5 * closed->solids[solid - firstClosed].bounds.diagonal();
  }
};

struct RayInstance {
  const RayForm* form;
  const Transform* worldFromObject;
  float objectScale; ///< an upper bound of what the way from the world to the object makes of lengths
  float worldScale;  ///< the same the other way
};

/// A triangle that the ray meets, as Embree reports it.
struct MetTriangle {
  std::uint32_t instance, triangle;
  float t, u, v;
  Vector3f normal, direction; ///< of the triangle and the ray, instance's frame, any length
};

/// A place that the ray may end at.
struct Found {
  double t = INFINITY;
  std::uint32_t instance = kNone, triangle = kNone;
  std::uint32_t facet = kNone; ///< kNone: a sharp triangle
  std::uint32_t solid = kNone; ///< of a sharp triangle of a closed component
  bool guessed = false;        ///< the triangle is only one of the solid's, not the one that is met
  float u = 0, v = 0;
  bool exact = false; ///< `t`, `normal` and `feature` are final, else the place is where the plane is met
  Feature feature = Feature::Flat;
  Vector3 normal; ///< world, unit, outward

  void set(const MetTriangle& met, std::uint32_t itsFacet, double there) {
    t = there;
    instance = met.instance;
    triangle = met.triangle;
    facet = itsFacet;
    solid = kNone;
    guessed = false;
    u = met.u;
    v = met.v;
    feature = Feature::Flat;
  }

  Found() = default;
  Found(const Found& o) { *this = o; }
  /// Member by member: a copy in wide words would wait for the narrow stores just before it.
  Found& operator=(const Found& o) {
    t = o.t;
    instance = o.instance;
    triangle = o.triangle;
    facet = o.facet;
    solid = o.solid;
    guessed = o.guessed;
    u = o.u;
    v = o.v;
    exact = o.exact;
    feature = o.feature;
    normal.x = o.normal.x;
    normal.y = o.normal.y;
    normal.z = o.normal.z;
    return *this;
  }
};

inline double largest(const Vector3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

/// Lives on the caller's stack. Places along the ray are in units of its direction's length.
class TraceQuery {
public:
  /// All must outlive the query. `embreeOrigin`: the ray's as Embree has it, about the scene's centre;
  /// `reach`: from there, of all that is traced.
  TraceQuery(const std::vector<RayInstance>& rayInstances, const Ray& worldRay, const PathState& origin,
             double near, double far, const Vector3& embreeOrigin, double reach)
      : instances(&rayInstances), ray(worldRay), from(&origin), tnear(near), tfar(far), limit(far),
        originSize(float(largest(embreeOrigin))), directionSize(float(largest(ray.direction))) {
    // By which Embree may be off at the ray's origin, from rounding it and the transforms: some units in the
    // last place of the largest coordinate.
    const double doubt = 0x1p-21 * std::max(largest(embreeOrigin), reach);
    const double inUnits = doubt / length(ray.direction);
    near_ = near + inUnits;
    start = near;
    if (!origin.empty()) lookAround(inUnits);
    notesPassages = amongOthers_;
  }

  /// Solves for the solids whose sliver the origin is in. Call before the traversal.
  void begin() {
    if (!from->empty()) beginInSlivers();
  }
  /// Takes the triangle's end of its solid as the hit if it is nearer than the best so far, or notes that it
  /// coincides with it. True: `limit` is lower than it was.
  bool take(const MetTriangle& met) {
    const RayInstance& in = (*instances)[met.instance];
    const RayForm& form = *in.form;
    const double t = start + double(met.t);
    if (t > limit) return false;
    const std::uint32_t f = form.flats ? form.flats[met.triangle].facet : kNone;
    const PathState::Place* place = from->empty() ? nullptr : placeOf(met, f);
    // From outside, a flat that is met is the near end: what is met of the far side lies behind that.
    const bool plain = !place && !isNear(t) && (f == kNone ? !form.closed : isSurelyFlat(in, met));
    if (plain && isAlone(form)) {
      if (!(t < best.t) && !isTieBefore(t, met.instance, met.triangle)) return false;
      best.set(met, f, t);
      best.exact = false;
      limit = t;
      found_ = true;
      return true;
    }
    Found found;
    found.set(met, f, t);
    if (!plain) {
      if (f == kNone) {
        if (!meetsSharp(in, met, place, found)) return false;
      } else if (place) {
        if (best.guessed) nameTriangle(met, f);
        if (!from->inside(*place, ray.direction) || !meetsFarSide(in, met, found)) return false;
      } else if (!meetsNearSide(in, met, found)) {
        return false;
      }
    }
    return accept(found);
  }
  /// Looks for the far sides of solids that the origin is in and that the traversal may have ended before.
  void finish() {
    if (insideAny_) findFarSides();
  }

  /// Does the triangle mean that something is hit before tfar? Sets `blocker`.
  bool isBlockedBy(const MetTriangle& met) {
    const RayInstance& in = (*instances)[met.instance];
    const RayForm& form = *in.form;
    const double t = start + double(met.t);
    const std::uint32_t f = form.flats ? form.flats[met.triangle].facet : kNone;
    const PathState::Place* place = from->empty() ? nullptr : placeOf(met, f);
    if (f == kNone && !place && !form.closed && !isNear(t)) return t < tfar;
    Found found;
    found.set(met, f, t);
    if (f == kNone) return meetsSharp(in, met, place, found) && found.t < tfar;
    if (place) {
      // From inward a path leaves the rounded solid before the mesh. That far side counts as flat: which
      // feature it is need not be found out.
      return from->inside(*place, ray.direction) && t < tfar && leaving(met.instance, f);
    }
    if (!isNear(t) && t < tfar && isSurelyFlat(in, met)) return true;
    if (!meetsNearSide(in, met, found) || !(found.t < tfar)) return false;
    blocker = found.feature;
    return true;
  }
  /// Does the ray, of which no triangle was in the way, leave a solid that it begins in before tfar?
  bool isBlockedByFarSide() { return insideAny_ && farSideBlocks(); }

  bool found() const { return found_; }
  /// Is the hit a wall within a union of solids that the path is in? If so, the query of the rest of the ray
  /// begins there. May change which of the coinciding surfaces is the hit.
  bool isBuried() { return insideAny_ && found_ && isWallWithin(); }
  void hit(TraceHit& out) {
    refine(best);
    write(best, out);
  }
  /// `hit`: what hit() gave. `arrival` may hold `from`.
  void arrive(const TraceHit& hit, Arrival& arrival);

  const std::vector<RayInstance>* instances;
  Ray ray; ///< world
  const PathState* from;
  double tnear, tfar;
  double start; ///< where Embree's ray begins
  double limit; ///< the traversal may end there
  Found best;
  Feature blocker = Feature::Flat;
  float originSize, directionSize; ///< largest coordinates of the ray as Embree has it
  bool notesPassages = false;      ///< arrive() will be asked for

private:
  /// A rounded solid whose mesh the ray enters at `t` and which it does not meet there, or which it meets so
  /// shortly behind another that Embree could not find it from there.
  struct Passage {
    std::uint32_t instance, triangle, facet;
    double t;
    bool close;
  };

  bool isNear(double t) const { return t <= near_; }
  const PathState::Place* placeOf(const MetTriangle& met, std::uint32_t f) const {
    for (const PathState::Place& p : from->places)
      if (p.instance == met.instance &&
          (f != kNone ? f >= p.firstFacet && f < p.endFacet : belongs(p, met.instance, met.triangle)))
        return &p;
    return nullptr;
  }
  bool belongs(const PathState::Place& place, std::uint32_t i, std::uint32_t triangle) const {
    if (place.rounded()) return false;
    if (place.solid == kNone) return place.triangle == triangle;
    const ClosedSolids* closed = (*instances)[i].form->closed;
    return closed && closed->ofTriangle[triangle] != kNone &&
           (*instances)[i].form->closedSolid(closed->ofTriangle[triangle]) == place.solid;
  }

  const Ray& rayFor(std::uint32_t i) {
    if (frameInstance_ != i) {
      objectRay_ = (*instances)[i].worldFromObject->applyInverse(ray);
      frameInstance_ = i;
    }
    return objectRay_;
  }
  bool leaving(std::uint32_t i, std::uint32_t f) {
    return dot(Vector3((*instances)[i].form->view->facets[f].normal), rayFor(i).direction) > 0;
  }

  /// How far Embree's ray may be off, across itself, in the instance's units: a few units in the last place
  /// of the larger of origin and hit; and what it meets.
  float off(const RayInstance& in, const MetTriangle& met) const {
    return 0x1p-21f * (originSize + met.t * directionSize) * in.objectScale + in.form->vertexDoubt;
  }
  /// Is the place on the triangle's flat, by its barycentric coordinates alone?
  bool isSurelyFlat(const RayInstance& in, const MetTriangle& met) const {
    const float slope = dot(met.normal, met.direction);
    return in.form->flats[met.triangle].holds(met.u, met.v, off(in, met),
                                              slope * slope /
                                                  (lengthSquared(met.normal) * lengthSquared(met.direction)));
  }

  bool meetsFarSide(const RayInstance& in, const MetTriangle& met, Found& found) {
    if (isSurelyFlat(in, met) && !isNear(found.t)) return leaving(met.instance, found.facet);
    const auto end = farEnd(*in.form->view, {found.facet, found.t}, rayFor(met.instance));
    if (!end) return false;
    setEnd(found, *end);
    found.t = std::max(found.t, tnear); // grazing: in and out within rounding
    return true;
  }
  /// Does the ray leave the facet's solid there, for all that float32 can tell?
  bool surelyLeaves(const RayInstance& in, const MetTriangle& met, std::uint32_t f) const {
    const float slope = dot(Vector3f(in.form->view->facets[f].normal), met.direction);
    return slope > 0x1p-19f * in.objectScale * directionSize;
  }
  bool meetsNearSide(const RayInstance& in, const MetTriangle& met, Found& found) {
    if (surelyLeaves(in, met, found.facet)) return false; // a front-facing triangle speaks for the solid
    const auto end = nearEnd(*in.form->view, {found.facet, found.t}, rayFor(met.instance));
    if (notesPassages && (!end || end->t > found.t) && !leaving(met.instance, found.facet))
      passages_.push_back({met.instance, met.triangle, found.facet, found.t, false});
    if (!end) return false;
    setEnd(found, *end);
    return end->t > tnear || beginsOnSurface(found);
  }
  bool meetsSharp(const RayInstance& in, const MetTriangle& met, const PathState::Place* place,
                  Found& found) {
    return (!in.form->closed && !place && !isNear(found.t)) || meetsSharpClosely(in, met, place, found);
  }
  bool meetsSharpClosely(const RayInstance& in, const MetTriangle& met, const PathState::Place* place,
                         Found& found);

  void setEnd(Found& found, const RoundedEnd& end) const;
  void refine(Found& found) const;
  /// The near end lies at the origin or behind, for rounding, and the ray goes on into the solid: then it is
  /// met at once.
  bool beginsOnSurface(Found& found);
  /// Of triangles that are met at one place the first in the scene counts, in whatever order they come.
  bool isTieBefore(double t, std::uint32_t instance, std::uint32_t triangle) const {
    return t == best.t &&
           (instance < best.instance || (instance == best.instance && triangle < best.triangle));
  }
  /// Does nothing that coincides with a surface of the form matter?
  bool isAlone(const RayForm& form) const { return !amongOthers_ && !coincidenceMatters_ && !form.transmits; }
  bool accept(Found& found) {
    if (isAlone(*(*instances)[found.instance].form)) {
      if (!(found.t < best.t) && !isTieBefore(found.t, found.instance, found.triangle)) return false;
      if (!(found.t < tfar)) return false;
      best = found;
      found_ = true;
      limit = best.t;
      return true;
    }
    return acceptWithTouching(found);
  }
  bool acceptWithTouching(Found& found);
  bool turned(const Found& found) const;
  double touchReach(const Found& found) const;
  double solidRadius(const Found& found) const;
  std::uint32_t solidOf(const Found& found) const;
  bool coincide(const Found& a, const Found& b) const;
  void write(const Found& found, TraceHit& out) const;
  bool arrivesAlone(const TraceHit& hit) const;
  void arriveAmongOthers(const TraceHit& hit, Arrival& arrival);
  PathState::Place placeOn(const Found& found, std::uint32_t solid, bool facesNormal, PathState::At at) const;
  /// The best so far was found without a triangle: is this it?
  void nameTriangle(const MetTriangle& met, std::uint32_t f);
  void lookAround(double doubt);
  void findFarSides();
  bool farSideBlocks();
  bool isWallWithin();
  void beginInSlivers();
  bool outsideAt(const PathState::Place& place, double t);
  bool buries(std::uint32_t instance, std::uint32_t solid, const Found& wall) const;

  double near_;                     ///< up to here Embree's places mean nothing
  bool insideAny_ = false;          ///< the origin is in a solid
  bool amongOthers_ = false;        ///< of those that light goes through, or that are one with others
  bool coincidenceMatters_ = false; ///< of other surfaces with the best so far
  bool found_ = false;
  boost::container::small_vector<Found, 1> touching_;
  boost::container::small_vector<Passage, 4> passages_;
  boost::container::small_vector<const PathState::Place*, 1>
      grazed_;                          ///< of `from`, which the ray is not in after all
  std::uint32_t frameInstance_ = kNone; ///< whose frame objectRay_ is in
  Ray objectRay_;
};

} // namespace chamfer
