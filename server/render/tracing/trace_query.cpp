#include "server/render/tracing/trace_query.h"

namespace chamfer {
namespace {

/// Surfaces nearer than this share of their solids' size touch: some units in the last place of a float32,
/// which planes are stored in.
constexpr double kTouch = 0x1p-21;
/// Surfaces that the ray meets at a smaller cosine are compared as if it were this.
constexpr double kLeastCosine = 1e-3;
/// Solids with more are not looked at facet by facet.
constexpr std::uint32_t kFewFacets = 64;
/// Surfaces that touch are nearly parallel there.
constexpr double kSameDirection = 0.999;

} // namespace

std::uint32_t TraceQuery::solidOf(const Found& f) const {
  return f.facet == kNone ? f.solid : (*instances)[f.instance].form->view->facets[f.facet].solid;
}

double TraceQuery::solidRadius(const Found& f) const {
  const RayInstance& in = (*instances)[f.instance];
  const std::uint32_t solid = solidOf(f);
  if (solid == kNone) return 0;
  return double(in.worldScale) * in.form->solidRadius(solid);
}

void TraceQuery::setEnd(Found& f, const RoundedEnd& end) const {
  f.t = end.t;
  f.feature = end.feature;
  f.normal = normalize(Vector3((*(*instances)[f.instance].worldFromObject)(Normal3(end.normal))));
  f.exact = true;
}

/// Puts the place on the plane that was met, in double.
void TraceQuery::refine(Found& f) const {
  if (f.exact) return;
  const RayInstance& in = (*instances)[f.instance];
  f.exact = true;
  if (f.facet == kNone) {
    const auto& t = in.form->mesh->triangles[f.triangle];
    const auto& p = in.form->mesh->positions;
    f.normal =
        normalize(Vector3((*in.worldFromObject)(Normal3(cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]])))));
    if (turned(f)) f.normal = -f.normal;
    // Where the ray is along the triangle, Embree's place is as good.
    const double exact =
        dot(f.normal, (*in.worldFromObject)(p[t[0]]) - ray.origin) / dot(f.normal, ray.direction);
    if (std::abs(exact - f.t) <= 1e-4 * std::abs(f.t) && exact > tnear) f.t = exact;
    return;
  }
  const FacetRecord& record = in.form->view->facets[f.facet];
  const SolidRecord& s = in.form->view->solids[record.solid];
  const Ray object = in.worldFromObject->applyInverse(ray);
  const Vector3 n(record.normal), o = object.origin - Point3(s.origin[0], s.origin[1], s.origin[2]);
  f.t = (double(record.offset) - dot(n, o)) / dot(n, object.direction);
  f.normal = normalize(Vector3((*in.worldFromObject)(Normal3(n))));
}

void TraceQuery::lookAround(double doubt) {
  bool mayTouch = from->places.size() > 1;
  for (const PathState::Place& p : from->places) {
    const RayForm& form = *(*instances)[p.instance].form;
    mayTouch = mayTouch || form.transmits;
    if (p.solid == kNone || !from->inside(p, ray.direction)) continue;
    mayTouch = insideAny_ = true;
    amongOthers_ = amongOthers_ || form.transmits || (form.view && form.view->solidCount() > 1);
  }
  if (mayTouch) {
    start = tnear - doubt;
    near_ = tnear + 2 * doubt;
  }
}

bool TraceQuery::meetsSharpClosely(const RayInstance& in, const MetTriangle& met,
                                   const PathState::Place* place, Found& found) {
  if (place && place->at == PathState::At::Surface && place->triangle == met.triangle) return false;
  const auto& t = in.form->mesh->triangles[met.triangle];
  const auto& p = in.form->mesh->positions;
  const Point3& a = p[t[0]];
  const Vector3 n = cross(p[t[1]] - a, p[t[2]] - a);
  const Ray& object = rayFor(met.instance);
  const double slope = dot(n, object.direction);
  if (in.form->closed) {
    const std::uint32_t entry = in.form->closed->ofTriangle[met.triangle];
    if (entry != kNone) {
      found.solid = in.form->closedSolid(entry);
      const bool front = (slope < 0) == ((entry & ClosedSolids::kTurned) == 0);
      const bool inside = place && from->inside(*place, ray.direction);
      if (inside == front) return false; // only the far side of what the path is in, and near sides else
    }
  }
  if (!isNear(found.t)) return true;
  const Point3 origin = object.at(tnear);
  const double height = dot(n, origin - a), size = length(n);
  // On the triangle's plane, for all that double can tell: it is part of the surface that the path leaves.
  const double noise = 0x1p-44 * (largest(Vector3(origin)) + largest(Vector3(a)) +
                                  double(in.objectScale) * largest(Vector3(ray.at(tnear))));
  if (std::abs(height) <= noise * size) return false;
  if (!(height * slope < 0)) return false; // behind
  found.t = tnear - height / slope;
  return found.t > tnear;
}

bool TraceQuery::beginsOnSurface(Found& found) {
  const RayInstance& in = (*instances)[found.instance];
  const double reach = kTouch * solidRadius(found) / length(ray.direction);
  if (!(found.t >= tnear - std::max(reach / kLeastCosine, near_ - tnear))) return false;
  const auto both = intervalFrom(*in.form->view, found.facet, rayFor(found.instance));
  if (!both || !(both->out.t > tnear + reach)) return false;
  found.t = tnear;
  return true;
}

/// Is the triangle of a closed component that is wound inside out?
bool TraceQuery::turned(const Found& f) const {
  const ClosedSolids* closed = (*instances)[f.instance].form->closed;
  if (f.facet != kNone || !closed) return false;
  const std::uint32_t entry = closed->ofTriangle[f.triangle];
  return entry != kNone && (entry & ClosedSolids::kTurned) != 0;
}

void TraceQuery::nameTriangle(const MetTriangle& met, std::uint32_t f) {
  if (met.instance != best.instance || best.feature != Feature::Flat) return;
  const auto& facets = (*instances)[met.instance].form->view->facets;
  if (facets[f].solid != facets[best.facet].solid) return;
  const Vector3 n =
      normalize(Vector3((*(*instances)[met.instance].worldFromObject)(Normal3(Vector3(facets[f].normal)))));
  if (!(dot(n, best.normal) > 0.9999)) return;
  best.triangle = met.triangle;
  best.facet = f;
  best.u = met.u;
  best.v = met.v;
  best.guessed = false;
}

/// The normal-wise distance between surfaces at which they touch, along the ray.
double TraceQuery::touchReach(const Found& f) const {
  const double cosine = std::abs(dot(f.normal, ray.direction));
  return kTouch * solidRadius(f) / std::max(cosine, kLeastCosine * length(ray.direction));
}

bool TraceQuery::coincide(const Found& a, const Found& b) const {
  return std::abs(dot(a.normal, b.normal)) > kSameDirection &&
         std::abs(a.t - b.t) <= std::max(touchReach(a), touchReach(b));
}

bool TraceQuery::acceptWithTouching(Found& f) {
  refine(f);
  if (!(f.t < tfar)) return false;
  if (f.t < tnear) return false;
  bool nearer = true;
  if (found_) {
    refine(best);
    nearer = f.t < best.t;
    if (solidOf(f) == solidOf(best) && f.instance == best.instance && solidOf(f) != kNone) {
      if (!nearer) return false; // another triangle of the same end
    } else if (coincide(f, best)) {
      touching_.push_back(nearer ? best : f);
    } else if (const Found& behind = nearer ? best : f;
               behind.facet != kNone && dot(behind.normal, ray.direction) < 0) {
      passages_.push_back({behind.instance, behind.triangle, behind.facet, behind.t, true});
    }
  }
  if (nearer) {
    best = f;
    found_ = true;
    coincidenceMatters_ = amongOthers_ || (*instances)[f.instance].form->transmits;
    const double before = limit;
    limit = std::min(limit, best.t);
    if (coincidenceMatters_) {
      const double cosine =
          std::max(std::abs(dot(f.normal, ray.direction)), kLeastCosine * length(ray.direction));
      const double doubt = 0x1p-20 * (double(originSize) + std::abs(best.t - tnear) * double(directionSize));
      // On by what touches may be off, and Embree with it.
      limit = std::min(before, best.t + touchReach(best) + doubt / cosine);
    }
  }
  return nearer;
}

void TraceQuery::beginInSlivers() {
  for (const PathState::Place& p : from->places) {
    if (p.at != PathState::At::Sliver) continue;
    const RoundingView& view = *(*instances)[p.instance].form->view;
    const auto both = intervalFrom(view, p.firstFacet, rayFor(p.instance));
    if (!both) continue;
    Found f;
    f.instance = p.instance;
    f.triangle = p.triangle;
    f.facet = p.firstFacet;
    setEnd(f, both->in);
    f.guessed = true;
    if (!(f.t > tnear)) { // on the surface but for rounding, or past it
      const double reach = kTouch * solidRadius(f) / length(ray.direction);
      if (!(f.t >= tnear - reach / kLeastCosine && both->out.t > tnear + reach)) continue;
      f.t = tnear;
    }
    if (accept(f)) limit = std::min(tfar, best.t + (near_ - tnear)); // so that its triangle is still met
  }
}

bool TraceQuery::outsideAt(const PathState::Place& p, double t) {
  const RayInstance& in = (*instances)[p.instance];
  const RoundingView& view = *in.form->view;
  if (p.endFacet - p.firstFacet <= kFewFacets) return !contains(view, p.solid, rayFor(p.instance).at(t));
  const auto both = intervalFrom(view, p.firstFacet, rayFor(p.instance));
  return both && t > both->out.t;
}

void TraceQuery::findFarSides() {
  for (const PathState::Place& p : from->places) {
    if (!p.rounded() || !from->inside(p, ray.direction)) continue;
    if (found_ && best.instance == p.instance && best.facet >= p.firstFacet && best.facet < p.endFacet)
      continue;
    // What was met may lie behind that side, in the sliver.
    const double end = found_ ? best.t : tfar;
    if (std::isfinite(end) && !outsideAt(p, end)) continue;
    const auto both = intervalFrom(*(*instances)[p.instance].form->view, p.firstFacet, rayFor(p.instance));
    if (!both) { // along the surface: the origin is in it only by rounding
      grazed_.push_back(&p);
      continue;
    }
    Found f;
    f.instance = p.instance;
    f.triangle = p.triangle;
    f.facet = p.firstFacet;
    setEnd(f, both->out);
    f.t = std::max(f.t, tnear);
    accept(f);
  }
}

bool TraceQuery::farSideBlocks() {
  for (const PathState::Place& p : from->places)
    if (p.rounded() && from->inside(p, ray.direction) && (std::isinf(tfar) || outsideAt(p, tfar)))
      return true;
  return false;
}

/// Number by number: a copy of the whole would wait for the narrow stores just before it.
void TraceQuery::write(const Found& f, TraceHit& out) const {
  out.t = f.t;
  const Point3 p = ray.at(f.t);
  out.position.x = p.x;
  out.position.y = p.y;
  out.position.z = p.z;
  out.normal.x = f.normal.x;
  out.normal.y = f.normal.y;
  out.normal.z = f.normal.z;
  out.feature = f.feature;
  out.instance = f.instance;
  out.solid = solidOf(f);
  out.triangle = f.triangle;
  out.u = f.u;
  out.v = f.v;
}

/// Is the wall inside another solid of its instance that the path is in, so that it bounds nothing?
bool TraceQuery::buries(std::uint32_t instance, std::uint32_t solid, const Found& wall) const {
  const RayForm& form = *(*instances)[instance].form;
  return instance == wall.instance && solid != solidOf(wall) && form.view && !form.transmits &&
         !holdsSolid(*form.view, solid, solidOf(wall));
}

bool TraceQuery::isWallWithin() {
  const auto buried = [&](const Found& wall) {
    if (wall.facet == kNone) return false;
    for (const PathState::Place& p : from->places)
      if (p.rounded() && from->inside(p, ray.direction) && buries(p.instance, p.solid, wall)) return true;
    const auto entersBeside = [&](const Found& other) {
      return &other != &wall && other.facet != kNone && dot(other.normal, ray.direction) < 0 &&
             buries(other.instance, solidOf(other), wall);
    };
    if (!(dot(wall.normal, ray.direction) > 0)) return false;
    return (&wall != &best && entersBeside(best)) ||
           std::any_of(touching_.begin(), touching_.end(), entersBeside);
  };
  refine(best);
  if (!buried(best)) return false;
  for (Found& t : touching_)
    if (coincide(t, best) && !buried(t)) {
      std::swap(t, best);
      return false;
    }
  return true;
}

/// Is the hit's own surface all that the path is on or in?
bool TraceQuery::arrivesAlone(const TraceHit& h) const {
  if (!touching_.empty() || !passages_.empty()) return false;
  for (const PathState::Place& p : from->places) {
    if (p.solid == kNone || (p.instance == h.instance && p.solid == h.solid)) continue;
    if (from->inside(p, ray.direction) || (p.rounded() && !p.leavesFlat)) return false;
  }
  return true;
}

PathState::Place TraceQuery::placeOn(const Found& f, std::uint32_t solid, bool facesNormal,
                                     PathState::At at) const {
  PathState::Place p{
      f.instance, solid, f.triangle,  kNone,
      kNone,      at,    facesNormal, at == PathState::At::Surface && f.feature == Feature::Flat};
  if (f.facet != kNone) {
    const auto& solids = (*instances)[f.instance].form->view->solids;
    p.firstFacet = solids[solid].firstFacet;
    p.endFacet = solids[solid + 1].firstFacet;
  }
  return p;
}

void TraceQuery::arrive(const TraceHit& h, Arrival& arrival) {
  if (!arrivesAlone(h)) return arriveAmongOthers(h, arrival);
  arrival.touching.clear();
  PathState::Places& places = arrival.state.places;
  const PathState::Place place = placeOn(best, h.solid, true, PathState::At::Surface);
  places.push_back(place);
  places.front() = place;
  places.erase(places.begin() + 1, places.end());
  arrival.state.normal = h.normal;
}

void TraceQuery::arriveAmongOthers(const TraceHit& h, Arrival& arrival) {
  PathState::Places places;
  const auto known = [&](std::uint32_t instance, std::uint32_t solid) {
    for (const PathState::Place& p : places)
      if (p.instance == instance && p.solid == solid) return true;
    return false;
  };
  const auto put = [&](const Found& f, std::uint32_t solid, bool facesNormal, PathState::At at) {
    const PathState::Place p = placeOn(f, solid, facesNormal, at);
    places.push_back(p);
  };
  const auto maybeIn = [&](std::uint32_t instance, std::uint32_t solid) {
    const RayInstance& in = (*instances)[instance];
    return maybeInUnroundedSolid(*in.form->view, solid, in.worldFromObject->applyInverse(h.position));
  };

  // Of a sharp solid Embree may miss the far side, along an edge.
  const auto stillIn = [&](const PathState::Place& p) {
    const RayInstance& in = (*instances)[p.instance];
    const Bounds3& b = in.form->closed->solids[p.solid - in.form->firstClosed].bounds;
    const Point3 at = in.worldFromObject->applyInverse(h.position);
    const double doubt = 0x1p-20 * b.diagonal();
    for (std::size_t k = 0; k < 3; ++k)
      if (!(at[k] >= b.lower[k] - doubt && at[k] <= b.upper[k] + doubt)) return false;
    return true;
  };
  put(best, h.solid, true, PathState::At::Surface);
  arrival.touching.clear();
  for (Found& t : touching_) {
    const std::uint32_t solid = solidOf(t);
    if (!coincide(t, best) || (solid != kNone && known(t.instance, solid))) continue;
    arrival.touching.push_back({});
    write(t, arrival.touching.back());
    put(t, solid, dot(t.normal, h.normal) >= 0, PathState::At::Surface);
  }
  for (const PathState::Place& p : from->places) {
    if (p.solid == kNone || known(p.instance, p.solid)) continue;
    const bool inside =
        from->inside(p, ray.direction) && std::find(grazed_.begin(), grazed_.end(), &p) == grazed_.end();
    if (inside ? !p.rounded() && !stillIn(p) : !p.rounded() || p.leavesFlat || !maybeIn(p.instance, p.solid))
      continue;
    places.push_back(p);
    places.back().at = inside ? PathState::At::Inside : PathState::At::Sliver;
  }
  for (const Passage& passed : passages_) {
    const std::uint32_t solid = (*instances)[passed.instance].form->view->facets[passed.facet].solid;
    if (known(passed.instance, solid)) continue;
    // At the hit's own place, for all that Embree can tell, is as good as before it: limit is beyond that.
    if (passed.t > limit || (passed.close ? passed.t < h.t : !maybeIn(passed.instance, solid))) continue;
    Found f;
    f.instance = passed.instance;
    f.triangle = passed.triangle;
    f.facet = passed.facet;
    put(f, solid, true, PathState::At::Sliver);
  }
  arrival.state.places = std::move(places);
  arrival.state.normal = h.normal;
}

} // namespace chamfer
