// Embree 3 behind tracer.h.
//
// Embree holds the unmodified meshes, float32, each about its own centre; the rounding is applied in filter
// functions. A filter sees every triangle that a ray meets on its way and asks the query (trace_query.h) what
// it means: a rejected triangle lets the ray go on in the same traversal, an accepted one ends it at the
// rounding, which lies at or behind the triangle. The traversal's tfar is then the query's limit: where the
// hit is, or a little beyond where surfaces that coincide with it matter. It only ever decreases, which is
// what the traversal relies on.
#include "server/render/tracing/embree_mesh.h"
#include "server/render/tracing/trace_query.h"

#include "common/error.h"
#include "common/text.h"

#include <boost/container/static_vector.hpp>
#include <map>
#include <tuple>

namespace chamfer {
namespace {

/// Embree's context, extended by the query. Lives on the caller's stack. No aggregate: that would be zeroed.
struct Context {
  /// The rest as TraceQuery's.
  template <class... Query>
  explicit Context(RTCFilterFunctionN filter, Query&&... ofQuery) : query(std::forward<Query>(ofQuery)...) {
    rtcInitIntersectContext(&embree);
    embree.filter = filter;
  }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  RTCIntersectContext embree; // first, so that Embree's pointer to it is ours
  TraceQuery query;
};

MetTriangle metTriangle(const RTCFilterFunctionNArguments* args) {
  const auto& ray = *reinterpret_cast<const RTCRay*>(args->ray); // in the instance's frame
  const auto& hit = *reinterpret_cast<const RTCHit*>(args->hit);
  return {hit.instID[0],
          hit.primID,
          ray.tfar,
          hit.u,
          hit.v,
          {hit.Ng_x, hit.Ng_y, hit.Ng_z},
          {ray.dir_x, ray.dir_y, ray.dir_z}};
}

void intersectFilter(const RTCFilterFunctionNArguments* args) {
  TraceQuery& query = reinterpret_cast<Context*>(args->context)->query;
  args->valid[0] = 0;
  if (!query.take(metTriangle(args))) return;
  reinterpret_cast<RTCRay*>(args->ray)->tfar = above(query.limit - query.start);
  args->valid[0] = -1;
}

void occludedFilter(const RTCFilterFunctionNArguments* args) {
  TraceQuery& query = reinterpret_cast<Context*>(args->context)->query;
  if (!query.isBlockedBy(metTriangle(args))) args->valid[0] = 0;
}

/// Rays that Embree traces at once.
constexpr std::size_t kPacket = 8;

/// As Context, of a packet: the ray's id is its query's place.
struct PacketContext {
  PacketContext(RTCFilterFunctionN filter, RTCIntersectContextFlags flags) {
    rtcInitIntersectContext(&embree);
    embree.filter = filter;
    embree.flags = flags;
  }
  PacketContext(const PacketContext&) = delete;
  PacketContext& operator=(const PacketContext&) = delete;

  RTCIntersectContext embree; // first, so that Embree's pointer to it is ours
  boost::container::static_vector<TraceQuery, kPacket> queries;
};

MetTriangle metTriangle(const RTCFilterFunctionNArguments* args, unsigned i) {
  return {RTCHitN_instID(args->hit, args->N, i, 0),
          RTCHitN_primID(args->hit, args->N, i),
          RTCRayN_tfar(args->ray, args->N, i),
          RTCHitN_u(args->hit, args->N, i),
          RTCHitN_v(args->hit, args->N, i),
          {RTCHitN_Ng_x(args->hit, args->N, i), RTCHitN_Ng_y(args->hit, args->N, i),
           RTCHitN_Ng_z(args->hit, args->N, i)},
          {RTCRayN_dir_x(args->ray, args->N, i), RTCRayN_dir_y(args->ray, args->N, i),
           RTCRayN_dir_z(args->ray, args->N, i)}};
}

void intersectPacketFilter(const RTCFilterFunctionNArguments* args) {
  auto& queries = reinterpret_cast<PacketContext*>(args->context)->queries;
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] != -1) continue;
    TraceQuery& query = queries[RTCRayN_id(args->ray, args->N, i)];
    if (query.take(metTriangle(args, i)))
      RTCRayN_tfar(args->ray, args->N, i) = above(query.limit - query.start);
    else
      args->valid[i] = 0;
  }
}

void occludedPacketFilter(const RTCFilterFunctionNArguments* args) {
  auto& queries = reinterpret_cast<PacketContext*>(args->context)->queries;
  for (unsigned i = 0; i < args->N; ++i)
    if (args->valid[i] == -1 && !queries[RTCRayN_id(args->ray, args->N, i)].isBlockedBy(metTriangle(args, i)))
      args->valid[i] = 0;
}

void put(const RTCRay& r, unsigned id, RTCRay8& packet, std::size_t at) {
  packet.org_x[at] = r.org_x;
  packet.org_y[at] = r.org_y;
  packet.org_z[at] = r.org_z;
  packet.dir_x[at] = r.dir_x;
  packet.dir_y[at] = r.dir_y;
  packet.dir_z[at] = r.dir_z;
  packet.tnear[at] = r.tnear;
  packet.tfar[at] = r.tfar;
  packet.time[at] = 0;
  packet.mask[at] = ~0u;
  packet.flags[at] = 0;
  packet.id[at] = id;
}

/// An upper bound of what the transform makes of lengths: the Frobenius norm of its linear part.
double norm(const Transform& t) {
  double square = 0;
  for (const auto& row : t.rows())
    for (std::size_t k = 0; k < 3; ++k)
      square += row[k] * row[k];
  return std::sqrt(square);
}
Bounds3 worldBounds(std::span<const TracedInstance> instances) {
  Bounds3 bounds;
  for (const TracedInstance& i : instances) {
    const Bounds3& b = i.mesh->bounds();
    if (b.empty()) continue;
    for (int corner = 0; corner < 8; ++corner)
      bounds.extend(
          i.worldFromObject(Point3(corner & 1 ? b.upper.x : b.lower.x, corner & 2 ? b.upper.y : b.lower.y,
                                   corner & 4 ? b.upper.z : b.lower.z)));
  }
  return bounds;
}

/// All solids that a point may be in.
struct PointQuery {
  RTCIntersectContext context;
  const std::vector<RayInstance>* instances;
  Ray ray; ///< from the point itself, where Embree's begins before it
  struct Solid {
    std::uint32_t instance, solid, triangle, facet;
    int leaving; ///< of a sharp one: how often more the ray leaves it than it enters it
  };
  boost::container::small_vector<Solid, 8> solids;
};

/// Notes the triangle's solid and lets the ray go on. A ray from inside a solid meets its far side, so any
/// ray from the point finds every such solid.
void insideFilter(const RTCFilterFunctionNArguments* args) {
  auto& q = *reinterpret_cast<PointQuery*>(args->context);
  const auto& hit = *reinterpret_cast<const RTCHit*>(args->hit);
  args->valid[0] = 0;
  const RayForm& form = *(*q.instances)[hit.instID[0]].form;
  std::uint32_t solid = kNone, facet = kNone;
  int leaving = 0;
  if (form.flats) {
    facet = form.flats[hit.primID].facet;
    if (facet != kNone) solid = form.view->facets[facet].solid;
  }
  if (facet == kNone && form.closed && form.closed->ofTriangle[hit.primID] != kNone) {
    const std::uint32_t entry = form.closed->ofTriangle[hit.primID];
    solid = form.closedSolid(entry);
    const auto& t = form.mesh->triangles[hit.primID];
    const auto& p = form.mesh->positions;
    const Vector3 n = cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]);
    const Ray object = (*q.instances)[hit.instID[0]].worldFromObject->applyInverse(q.ray);
    const double slope = dot(n, object.direction);
    if (!(dot(n, p[t[0]] - object.origin) / slope > 0)) return; // behind the point
    const bool along = slope > 0;
    leaving = along == ((entry & ClosedSolids::kTurned) == 0) ? 1 : -1;
  }
  if (solid == kNone) return;
  for (PointQuery::Solid& s : q.solids)
    if (s.instance == hit.instID[0] && s.solid == solid) {
      s.leaving += leaving;
      return;
    }
  q.solids.push_back({hit.instID[0], solid, hit.primID, facet, leaving});
}

/// Is some triangle's box within the query's radius?
bool nearFilter(RTCPointQueryFunctionArguments* args) {
  *static_cast<bool*>(args->userPtr) = true;
  args->query->radius = 0; // enough
  return true;
}

class EmbreeTracer final : public Tracer {
public:
  explicit EmbreeTracer(std::vector<TracedInstance> instances) : owned_(std::move(instances)) {
    checkCoordinates(owned_, [](std::size_t k) { return "instance " + std::to_string(k); });
    bounds_ = worldBounds(owned_);
    centre_ = bounds_.empty() ? Vector3() : Vector3(bounds_.centre());
    reach_ = 0.5 * bounds_.diagonal();
    instances_.reserve(owned_.size());
    for (const TracedInstance& i : owned_) {
      instances_.push_back(rayInstance(i));
      attachInstance(i);
      largestDiameter_ = std::max(largestDiameter_, worldDiameter(instances_.back()));
    }
    scene_.build();
  }

  std::optional<TraceHit> intersect(const Ray& ray, const PathState& from, double tnear, double tfar,
                                    Arrival* arrival) const override {
    if (isFar(ray, from, tnear)) return intersectFromAfar(ray, tnear, tfar, arrival);
    if (!hasGoodLength(ray.direction)) {
      const double size = length(ray.direction);
      if (!(size > 0)) return std::nullopt;
      auto hit = intersect({ray.origin, ray.direction / size}, from, tnear * size, tfar * size, arrival);
      if (hit) inLengthsOf(size, 0, *hit, arrival);
      return hit;
    }
    Context c = context(ray, from, tnear, tfar, &intersectFilter);
    c.query.notesPassages |= arrival != nullptr;
    std::optional<TraceHit> hit;
    search(c);
    if (!answer(c.query, tfar, arrival, hit.emplace())) hit.reset();
    return hit;
  }

  bool occluded(const Ray& ray, const PathState& from, double tnear, double tfar,
                Feature* blocker) const override {
    if (!hasGoodLength(ray.direction)) {
      const double size = length(ray.direction);
      return size > 0 &&
             occluded({ray.origin, ray.direction / size}, from, tnear * size, tfar * size, blocker);
    }
    if (!from.empty() && inUnion(from, ray.direction)) {
      const auto hit = intersect(ray, from, tnear, tfar, nullptr);
      if (hit && blocker) *blocker = hit->feature;
      return hit.has_value();
    }
    Context c = context(ray, from, tnear, tfar, &occludedFilter);
    c.query.begin();
    if (blocker) *blocker = c.query.best.feature;
    if (c.query.found() || c.query.isBlockedByFarSide()) return true;
    RTCRay r = embreeRay(c.query);
    rtcOccluded1(scene_.get(), &c.embree, &r);
    if (blocker) *blocker = c.query.blocker;
    return r.tfar < 0;
  }

  void intersect(std::span<RayTask> tasks, bool alike) const override {
    if (alike) {
      for (std::size_t first = 0; first < tasks.size(); first += kPacket)
        intersectPacket(tasks.subspan(first, std::min(kPacket, tasks.size() - first)));
      return;
    }
    for (RayTask& t : tasks) {
      if (isOdd(t)) {
        intersectOdd(t);
        continue;
      }
      Context c = context(*t.ray, *t.from, t.tnear, t.tfar, &intersectFilter);
      c.query.notesPassages |= t.arrival != nullptr;
      search(c);
      t.found = answer(c.query, t.tfar, t.arrival, *t.hit);
    }
  }

  void occluded(std::span<ShadowTask> tasks) const override {
    for (std::size_t first = 0; first < tasks.size(); first += kPacket)
      occludedPacket(tasks.subspan(first, std::min(kPacket, tasks.size() - first)));
  }

  PathState stateAt(const Point3& point) const override {
    PathState state;
    const double away = length(Vector3(point) - centre_);
    if (!(away <= 2 * reach_)) return state; // Embree takes no coordinates beyond 1.8e18
    PointQuery q;
    rtcInitIntersectContext(&q.context);
    q.context.filter = &insideFilter;
    q.instances = &instances_;
    // Begins a little before the point, so that it meets the far side also of a solid that the point is on.
    const Vector3 direction{0.8, 0.5, 0.33166}, o = Vector3(point) - centre_;
    q.ray = {point, direction};
    const double before = 0x1p-18 * (length(o) + reach_);
    RTCRay r = embreeRay(o - direction * before, direction, 0, largestDiameter_ + 2 * before);
    rtcOccluded1(scene_.get(), &q.context, &r);
    for (const PointQuery::Solid& s : q.solids) {
      const RayInstance& in = instances_[s.instance];
      if (s.facet == kNone) {
        if (s.leaving > 0)
          state.places.push_back(
              {s.instance, s.solid, s.triangle, kNone, kNone, PathState::At::Inside, false});
        continue;
      }
      const RoundingView& view = *in.form->view;
      const Point3 p = in.worldFromObject->applyInverse(point);
      if (!inUnroundedSolid(view, s.solid, p)) continue;
      state.places.push_back({s.instance, s.solid, s.triangle, view.solids[s.solid].firstFacet,
                              view.solids[s.solid + 1].firstFacet,
                              contains(view, s.solid, p) ? PathState::At::Inside : PathState::At::Sliver,
                              false});
    }
    return state;
  }

  bool sameStateAround(const Point3& point, double radius) const override {
    const double away = length(Vector3(point) - centre_);
    if (away > 2 * reach_ + radius) return true;
    for (const PathState::Place& p : stateAt(point).places) {
      // Where a sliver ends in the rounded solid no triangle tells.
      const RayInstance& in = instances_[p.instance];
      if (p.rounded() && !isDeepIn(*in.form->view, p.solid, in.worldFromObject->applyInverse(point),
                                   radius * double(in.objectScale)))
        return false;
    }
    bool near = false;
    RTCPointQuery query{};
    const Vector3 o = Vector3(point) - centre_;
    query.x = float(o.x);
    query.y = float(o.y);
    query.z = float(o.z);
    query.radius = above(radius + 0x1p-18 * (length(o) + reach_));
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene_.get(), &query, &context, &nearFilter, &near);
    return !near;
  }

  double worldRadius(std::uint32_t instance, std::uint32_t solid) const override {
    const RayInstance& in = instances_[instance];
    return double(in.worldScale) * in.form->solidRadius(solid);
  }

  bool isCavity(std::uint32_t instance, std::uint32_t solid) const override {
    const RayForm& form = *instances_[instance].form;
    return form.closed && solid >= form.firstClosed && form.closed->solids[solid - form.firstClosed].cavity;
  }

  const Bounds3& bounds() const override { return bounds_; }

  std::size_t memoryBytes() const override {
    std::vector<const void*> seen;
    const auto first = [&](const void* p) {
      for (const void* s : seen)
        if (s == p) return false;
      seen.push_back(p);
      return true;
    };
    std::size_t bytes = scene_.bytes() + instances_.size() * sizeof(RayInstance);
    for (const auto& [key, form] : forms_)
      bytes += form->flats.size() * sizeof(TriangleFlat) + (form->ray.closed ? form->ray.closed->bytes() : 0);
    const void *lastMesh = nullptr, *lastRounding = nullptr;
    for (const TracedInstance& i : owned_) {
      if (i.mesh.get() != lastMesh && first(i.mesh.get())) bytes += i.mesh->bytes();
      if (i.rounding && i.rounding.get() != lastRounding && first(i.rounding.get()))
        bytes += i.rounding->bytes();
      lastMesh = i.mesh.get();
      lastRounding = i.rounding.get();
    }
    return bytes;
  }

private:
  /// Does the ray start so far away, or is its direction so long or short, that float32 would lose the scene?
  /// Embree itself ends the process where a coordinate is beyond 1.8e18, in an instance's frame too.
  bool isFar(const Ray& ray) const {
    constexpr double kNear = 64; // reaches
    return !(lengthSquared(Vector3(ray.origin) - centre_) <= kNear * kNear * reach_ * reach_) ||
           !hasGoodLength(ray.direction);
  }
  bool isFar(const Ray& ray, const PathState& from, double tnear) const {
    return from.empty() && (isFar(ray) || (tnear > 0 && isFar({ray.at(tnear), ray.direction})));
  }
  static bool hasGoodLength(const Vector3& direction) {
    constexpr double kShort = 1e-6, kLong = 1e6; // a scene file's scales are near 1
    const double size = lengthSquared(direction);
    return size >= kShort * kShort && size <= kLong * kLong;
  }

  /// From a unit ray that starts `skipped` later to one of length `size`.
  static void inLengthsOf(double size, double skipped, TraceHit& hit, Arrival* arrival) {
    hit.t = (hit.t + skipped) / size;
    if (!arrival) return;
    for (TraceHit& t : arrival->touching)
      t.t = (t.t + skipped) / size;
  }
  /// The same hit, found by a unit ray that starts before the scene, or at tnear.
  std::optional<TraceHit> intersectFromAfar(const Ray& ray, double tnear, double tfar,
                                            Arrival* arrival) const {
    const double size = length(ray.direction);
    const Vector3 unit = ray.direction / size;
    const double begin = std::max(tnear * size, dot(centre_ - Vector3(ray.origin), unit) -
                                                    2 * reach_); // the scene is behind it
    const Ray near{ray.origin + unit * begin, unit};
    if (isFar(near)) return std::nullopt; // passes the scene by, or there is none
    auto hit = intersect(near, {}, 0, tfar * size - begin, arrival);
    if (hit) inLengthsOf(size, begin, *hit, arrival);
    return hit;
  }

  /// Is the ray none that Embree takes as it is?
  bool isOdd(const RayTask& t) const {
    return isFar(*t.ray, *t.from, t.tnear) || !hasGoodLength(t.ray->direction);
  }
  void intersectOdd(RayTask& t) const {
    const auto hit = intersect(*t.ray, *t.from, t.tnear, t.tfar, t.arrival);
    if ((t.found = hit.has_value())) *t.hit = *hit;
  }

  void intersectPacket(std::span<RayTask> tasks) const {
    PacketContext c(&intersectPacketFilter, RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
    RTCRayHit8 packet;
    alignas(32) int valid[kPacket] = {};
    RayTask* asked[kPacket];
    for (RayTask& t : tasks) {
      if (isOdd(t)) {
        intersectOdd(t);
        continue;
      }
      const std::size_t at = c.queries.size();
      TraceQuery& query = c.queries.emplace_back(instances_, *t.ray, *t.from, t.tnear, t.tfar,
                                                 Vector3(t.ray->origin) - centre_, reach_);
      query.notesPassages |= t.arrival != nullptr;
      query.begin();
      put(embreeRay(query), unsigned(at), packet.ray, at);
      packet.hit.geomID[at] = packet.hit.instID[0][at] = RTC_INVALID_GEOMETRY_ID;
      valid[at] = -1;
      asked[at] = &t;
    }
    rtcIntersect8(valid, scene_.get(), &c.embree, &packet);
    for (std::size_t i = 0; i < c.queries.size(); ++i) {
      RayTask& t = *asked[i];
      c.queries[i].finish();
      t.found = answer(c.queries[i], t.tfar, t.arrival, *t.hit);
    }
  }

  void occludedPacket(std::span<ShadowTask> tasks) const {
    // Coherent traversal loses where light comes from all sides, to a room's walls.
    PacketContext c(&occludedPacketFilter, RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
    RTCRay8 packet;
    alignas(32) int valid[kPacket] = {};
    ShadowTask* asked[kPacket];
    for (ShadowTask& t : tasks) {
      if (!hasGoodLength(t.ray.direction) || (!t.from->empty() && inUnion(*t.from, t.ray.direction))) {
        t.blocked = occluded(t.ray, *t.from, 0, t.tfar, &t.blocker);
        continue;
      }
      const std::size_t at = c.queries.size();
      TraceQuery& query = c.queries.emplace_back(instances_, t.ray, *t.from, 0, t.tfar,
                                                 Vector3(t.ray.origin) - centre_, reach_);
      query.begin();
      t.blocker = query.best.feature;
      t.blocked = query.found() || query.isBlockedByFarSide();
      if (t.blocked) {
        c.queries.pop_back();
        continue;
      }
      put(embreeRay(query), unsigned(at), packet, at);
      valid[at] = -1;
      asked[at] = &t;
    }
    rtcOccluded8(valid, scene_.get(), &c.embree, &packet);
    for (std::size_t i = 0; i < c.queries.size(); ++i) {
      asked[i]->blocked = packet.tfar[i] < 0;
      asked[i]->blocker = c.queries[i].blocker;
    }
  }

  /// After the traversal. Of walls within a union that the path is in: again from each.
  bool answer(TraceQuery& query, double tfar, Arrival* arrival, TraceHit& hit) const {
    if (meet(query, arrival, hit) != Met::Wall) return query.found();
    Arrival within;
    query.arrive(hit, within);
    for (;;) {
      Context c = context(query.ray, within.state, hit.t, tfar, &intersectFilter);
      c.query.notesPassages |= arrival != nullptr;
      search(c);
      const Met what = meet(c.query, arrival, hit);
      if (what != Met::Wall) return what == Met::Surface;
      c.query.arrive(hit, within);
    }
  }
  enum class Met { Nothing, Surface, Wall };
  /// Of a wall within a union `arrival` is left as it was.
  static Met meet(TraceQuery& query, Arrival* arrival, TraceHit& hit) {
    if (!query.found()) return Met::Nothing;
    const bool buried = query.isBuried(); // may choose another hit
    query.hit(hit);
    if (buried) return Met::Wall;
    if (arrival) query.arrive(hit, *arrival);
    return Met::Surface;
  }

  /// A mesh in one form, for all of its instances.
  struct Form {
    std::vector<TriangleFlat> flats;
    RayForm ray;
  };

  RayInstance rayInstance(const TracedInstance& i) {
    auto& form = forms_[{i.mesh.get(), i.rounding.get(), i.transmits}];
    if (!form) {
      form = std::make_unique<Form>();
      form->ray.mesh = &i.mesh->mesh();
      form->ray.transmits = i.transmits;
      if (i.rounding) {
        form->ray.view = &i.rounding->view();
        form->flats = flatMargins(*form->ray.view, i.mesh->mesh());
        form->ray.vertexDoubt = float(0x1p-22 * 0.5 * i.mesh->bounds().diagonal());
        form->ray.flats = form->flats.data();
        form->ray.firstClosed = std::uint32_t(form->ray.view->solidCount());
      }
      const auto staysSharp = [](const TriangleFlat& f) { return f.facet == kNone; };
      if (i.transmits && (!i.rounding || std::any_of(form->flats.begin(), form->flats.end(), staysSharp)))
        form->ray.closed = &i.mesh->closed();
    }
    return {&form->ray, &i.worldFromObject, float(norm(i.worldFromObject.inverse())),
            float(norm(i.worldFromObject))};
  }

  void attachInstance(const TracedInstance& i) {
    // Embree's frames are about the mesh's and the scene's centres: float32 keeps its digits far from the
    // origin.
    const Transform t =
        Transform::translate(-centre_) * i.worldFromObject * Transform::translate(i.mesh->centre());
    const RTCGeometry geometry = rtcNewGeometry(embreeDevice(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, i.mesh->scene());
    float rows[12];
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 4; ++c)
        rows[4 * r + c] = float(t.rows()[r][c]);
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, rows);
    scene_.attach(geometry);
  }

  Context context(const Ray& ray, const PathState& from, double tnear, double tfar,
                  RTCFilterFunctionN filter) const {
    return Context(filter, instances_, ray, from, tnear, tfar, Vector3(ray.origin) - centre_, reach_);
  }

  void search(Context& c) const {
    c.query.begin();
    RTCRayHit rayHit;
    rayHit.ray = embreeRay(c.query);
    rayHit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rayHit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_.get(), &c.embree, &rayHit);
    c.query.finish();
  }

  /// Is the origin in a solid that others of its instance may continue?
  bool inUnion(const PathState& from, const Vector3& direction) const {
    for (const PathState::Place& p : from.places) {
      if (!p.rounded() || !from.inside(p, direction)) continue;
      const RayForm& form = *instances_[p.instance].form;
      if (!form.transmits && form.view->solidCount() > 1) return true;
    }
    return false;
  }

  RTCRay embreeRay(const TraceQuery& q) const {
    RTCRay r = embreeRay(Vector3(q.ray.at(q.start)) - centre_, q.ray.direction, 0, q.limit - q.start);
    if (q.from->empty() || q.start < q.tnear) return r;
    // Rounded to the side that the path goes on: mostly the surface that it leaves is not met again then.
    const Vector3& n = q.from->normal;
    const bool along = dot(n, q.ray.direction) > 0;
    const auto step = [&](float& x, double by) {
      if (by != 0) x += ((by > 0) == along ? 0x1p-23f : -0x1p-23f) * std::abs(x);
    };
    step(r.org_x, n.x);
    step(r.org_y, n.y);
    step(r.org_z, n.z);
    return r;
  }

  /// `origin` relative to the scene's centre.
  static RTCRay embreeRay(const Vector3& origin, const Vector3& direction, double tnear, double tfar) {
    RTCRay r;
    r.org_x = float(origin.x);
    r.org_y = float(origin.y);
    r.org_z = float(origin.z);
    r.dir_x = float(direction.x);
    r.dir_y = float(direction.y);
    r.dir_z = float(direction.z);
    r.tnear = float(tnear);
    r.tfar = above(tfar);
    r.mask = ~0u;
    r.flags = 0;
    r.time = 0;
    r.id = 0;
    return r;
  }

  /// An upper bound of the diameter of an instance's solids in the world.
  static double worldDiameter(const RayInstance& in) {
    double largest = 0;
    if (in.form->view)
      for (const SolidRecord& s : in.form->view->solids)
        largest = std::max(largest, double(s.boundRadius));
    if (in.form->closed)
      for (const ClosedSolids::Solid& s : in.form->closed->solids)
        largest = std::max(largest, 0.5 * s.bounds.diagonal());
    return 2 * largest * double(in.worldScale);
  }

  std::vector<TracedInstance> owned_;
  std::vector<RayInstance> instances_; ///< point into owned_ and forms_
  std::map<std::tuple<const TracedMesh*, const Rounding*, bool>, std::unique_ptr<Form>> forms_;
  Bounds3 bounds_;
  Vector3 centre_;
  double reach_ = 0, largestDiameter_ = 0;
  EmbreeScene scene_;
};

} // namespace

void checkCoordinates(std::span<const TracedInstance> instances,
                      const std::function<std::string(std::size_t)>& nameOf) {
  const auto check = [&](std::size_t k, double reach) {
    if (!(reach <= kLargestCoordinate))
      throw Error(ErrorKind::OutOfRange, nameOf(k) + " is placed or scaled so that coordinates reach " +
                                             numberText(reach) + "; rays can be traced up to " +
                                             numberText(kLargestCoordinate) +
                                             ": scale the scene, or leave it out");
  };
  // What is too large by itself comes before what is only too small beside it.
  for (std::size_t k = 0; k < instances.size(); ++k) {
    const TracedInstance& i = instances[k];
    const Bounds3& b = i.mesh->bounds();
    if (b.empty()) continue;
    const double world = norm(i.worldFromObject), object = norm(i.worldFromObject.inverse());
    check(k, std::max({world * b.diagonal(), b.diagonal(), world, object,
                       length(Vector3(i.worldFromObject(b.centre())))}));
  }
  const Bounds3 bounds = worldBounds(instances);
  for (std::size_t k = 0; k < instances.size(); ++k)
    if (!instances[k].mesh->bounds().empty())
      check(k, norm(instances[k].worldFromObject.inverse()) * bounds.diagonal());
}

std::shared_ptr<const Tracer> makeTracer(std::vector<TracedInstance> instances) {
  return std::make_shared<EmbreeTracer>(std::move(instances));
}

} // namespace chamfer
