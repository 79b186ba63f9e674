// Embree 3 behind tracer.h.
//
// Embree holds the unmodified meshes, float32, each about its own centre; the rounding is applied in filter
// functions. A filter sees every triangle that a ray meets on its way. For a triangle of a rounded solid it
// asks the rounding for the first end of the ray's interval in the solid (double arithmetic, the double ray)
// and either rejects the triangle, so that the ray goes on through the sliver in the same traversal, or
// accepts it and moves the ray's tfar to that end. The end lies at or behind the triangle, but before the
// tfar that the traversal had, so tfar only ever decreases from one accepted hit to the next, which is what
// the traversal relies on.
#include "server/render/tracer.h"

#include "common/error.h"
#include "server/render/flat_margins.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <embree3/rtcore.h>
#include <limits>
#include <map>
#include <mutex>
#include <string>
#include <thread>

namespace chamfer {
namespace {

/// Bytes that Embree has allocated, by its own count.
std::atomic<std::ptrdiff_t> embreeBytes{0};

/// Process-wide handle without state of ours; Embree's devices are thread safe.
RTCDevice device() {
  static const RTCDevice shared = [] {
    const RTCDevice made = rtcNewDevice(nullptr);
    if (!made) throw Error(ErrorKind::Internal, "Embree cannot start on this machine");
    rtcSetDeviceMemoryMonitorFunction(
        made,
        [](void*, ssize_t bytes, bool) {
          embreeBytes += bytes;
          return true;
        },
        nullptr);
    return made;
  }();
  return shared;
}

constexpr const char* kCancelled = "cancelled while a bounding volume hierarchy was built";

void checkDevice(const char* step) {
  const RTCError error = rtcGetDeviceError(device());
  if (error == RTC_ERROR_CANCELLED) throw Error(ErrorKind::Cancelled, kCancelled);
  if (error != RTC_ERROR_NONE)
    throw Error(ErrorKind::Internal, std::string("Embree failed to ") + step + " (error " +
                                         std::to_string(error) +
                                         (error == RTC_ERROR_OUT_OF_MEMORY ? ", out of memory)" : ")"));
}

/// Owns an RTCScene and measures what building it took.
class EmbreeScene {
public:
  EmbreeScene() : scene_(rtcNewScene(device())) {
    rtcSetSceneFlags(scene_, RTCSceneFlags(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
  }
  ~EmbreeScene() { rtcReleaseScene(scene_); }
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  void attach(RTCGeometry geometry) {
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
  }
  /// As makeTracedMesh() about `cancelled`.
  void build(const std::function<bool()>& cancelled = {}) {
    static std::mutex oneAtATime; // so that the bytes counted are this scene's
    std::unique_lock lock(oneAtATime, std::defer_lock);
    while (!lock.try_lock()) {
      if (cancelled && cancelled()) throw Error(ErrorKind::Cancelled, kCancelled);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    const std::ptrdiff_t before = embreeBytes;
    if (cancelled)
      rtcSetSceneProgressMonitorFunction(
          scene_, [](void* ask, double) { return !(*static_cast<const std::function<bool()>*>(ask))(); },
          const_cast<std::function<bool()>*>(&cancelled));
    rtcCommitScene(scene_);
    rtcSetSceneProgressMonitorFunction(scene_, nullptr, nullptr);
    checkDevice("build a bounding volume hierarchy");
    const std::ptrdiff_t after = embreeBytes;
    bytes_ = after > before ? std::size_t(after - before) : 0;
  }
  RTCScene get() const { return scene_; }
  std::size_t bytes() const { return bytes_; }

private:
  RTCScene scene_;
  std::size_t bytes_ = 0;
};

} // namespace

class TracedMesh {
public:
  TracedMesh(std::shared_ptr<const TriangleMesh> mesh, const std::function<bool()>& cancelled)
      : mesh_(std::move(mesh)) {
    for (const auto& t : mesh_->triangles)
      for (const std::uint32_t v : t)
        bounds_.extend(mesh_->positions[v]);
    centre_ = bounds_.empty() ? Vector3() : Vector3(bounds_.centre());
    const RTCGeometry geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* positions = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh_->positions.size()));
    auto* indices = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(std::uint32_t), mesh_->triangles.size()));
    if (!positions || !indices) checkDevice("hold a mesh");
    for (const Point3& p : mesh_->positions) {
      const Vector3 local = Vector3(p) - centre_;
      for (std::size_t k = 0; k < 3; ++k)
        *positions++ = float(local[k]);
    }
    for (const auto& t : mesh_->triangles)
      for (const std::uint32_t v : t)
        *indices++ = v;
    scene_.attach(geometry);
    scene_.build(cancelled);
  }
  const TriangleMesh& mesh() const { return *mesh_; }
  const Vector3& centre() const { return centre_; } ///< object coordinates of Embree's origin
  const Bounds3& bounds() const { return bounds_; }
  RTCScene scene() const { return scene_.get(); }
  std::size_t bytes() const {
    return scene_.bytes() + 12 * (mesh_->positions.size() + mesh_->triangles.size());
  }

private:
  std::shared_ptr<const TriangleMesh> mesh_;
  Bounds3 bounds_;
  Vector3 centre_;
  EmbreeScene scene_;
};

std::shared_ptr<const TracedMesh> makeTracedMesh(std::shared_ptr<const TriangleMesh> mesh,
                                                 const std::function<bool()>& cancelled) {
  return std::make_shared<TracedMesh>(std::move(mesh), cancelled);
}

std::size_t memoryBytes(const TracedMesh& mesh) { return mesh.bytes(); }

namespace {

struct Instance {
  const RoundingView* view;  ///< null: sharp
  const TriangleFlat* flats; ///< by triangle; null: sharp
  float objectScale;         ///< an upper bound of what objectFromWorld makes of lengths
  Transform objectFromWorld;
};

/// Nearest float32 not below.
float above(double t) {
  const float f = float(t);
  return double(f) >= t ? f : std::nextafter(f, std::numeric_limits<float>::infinity());
}

/// The ray's way through the mesh of a solid whose rounded solid it does not meet there, as far as it is
/// known.
struct Passage {
  double in = INFINITY, out = INFINITY; ///< `out`: surely by then
  std::uint32_t instance = kNone, solid = kNone;
};

/// One query: Embree's context, extended by what the filters need. Lives on the caller's stack.
struct Query {
  RTCIntersectContext context; // first, so that Embree's pointer to it is ours
  const std::vector<Instance>* instances;
  Ray ray;        ///< world
  Vector3 offset; ///< of Embree's ray only
  RayOrigin from;
  double tnear;
  double best;    ///< ends at or beyond this do not count
  RoundedEnd end; ///< the best so far, object frame; valid when found and not surelyFlat
  bool
      surelyFlat; ///< the best so far is where the ray meets the plane of this facet, as far as float32 tells
  std::uint32_t facet;
  float originSize, directionSize;                  ///< largest coordinates, in Embree's world
  std::uint32_t ownFirstFacet = 0, ownEndFacet = 0; ///< of the solid that the path is at
  std::uint32_t instance, triangle;
  float u, v;
  bool found;
  double keep;               ///< tfar may not fall below this
  double limit;              ///< tfar as Embree has it
  double ownExit = INFINITY; ///< by where the ray has surely left the mesh of the solid that its origin is on
  Passage passages[4];
  unsigned passageCount = 0;           ///< above the array's size: some are not known
  std::uint32_t frameInstance = kNone; ///< whose frame objectRay is in
  Ray objectRay;

  /// Is the hit, which is on a flat, the end of its solid that the query is after?
  bool isEnd(std::uint32_t i, std::uint32_t f) {
    if (own(i, f)) return leaving(i, f);
    return !from.maybeInSliver; // from a sliver, the near end may come before
  }
  bool counts(double t) const { return t > tnear && t < best; }
  bool leaving(std::uint32_t i, std::uint32_t f) {
    return dot(Vector3((*instances)[i].view->facets[f].normal), rayFor(i).direction) > 0;
  }

  /// Remembers where the ray enters or leaves the mesh of a solid.
  void pass(double t, std::uint32_t i, std::uint32_t s, bool front) {
    const unsigned known = std::min(passageCount, unsigned(std::size(passages)));
    unsigned k = 0;
    while (k < known && (passages[k].instance != i || passages[k].solid != s))
      ++k;
    if (k == known) {
      if (passageCount++ >= std::size(passages)) return;
      passages[k].instance = i;
      passages[k].solid = s;
    }
    double& place = front ? passages[k].in : passages[k].out;
    place = std::min(place, t);
  }
  /// May the hit lie inside the mesh of another solid, by what the ray passed on its way?
  bool hitInPassage() const {
    if (passageCount == 0) return false;
    if (passageCount > std::size(passages)) return true;
    const std::uint32_t hit = solid();
    for (unsigned k = 0; k < passageCount; ++k) {
      const Passage& p = passages[k];
      if (p.in < best && !(p.out < best) && (p.instance != instance || p.solid != hit)) return true;
    }
    return false;
  }
  std::uint32_t solid() const {
    return facet == kNone ? kNone : (*instances)[instance].view->facets[facet].solid;
  }
  /// The tfar to go on with after a hit at `t`.
  float tfarAfter(double t) {
    limit = std::min(limit, std::max(t, keep));
    return above(limit);
  }

  OriginIs origin() const { return from.maybeInSolid ? OriginIs::Anywhere : OriginIs::Outside; }
  /// The first triangle that a path outward meets is often the one that it leaves: nothing to look up for
  /// that.
  bool leaves(std::uint32_t i, std::uint32_t t) const {
    return from.triangle == t && from.instance == i && !from.inside;
  }

  /// Outward, a path never meets the solid again that it leaves.
  bool leavesSolid(std::uint32_t i, std::uint32_t f) const { return !from.inside && own(i, f); }
  bool own(std::uint32_t i, std::uint32_t f) const {
    return from.instance == i && f >= ownFirstFacet && f < ownEndFacet;
  }

  const Ray& rayFor(std::uint32_t i) {
    if (frameInstance != i) {
      objectRay = (*instances)[i].objectFromWorld(ray);
      frameInstance = i;
    }
    return objectRay;
  }
};

/// Is the hit on the triangle's flat, by its barycentric coordinates alone? The ray is in the instance's
/// frame.
inline bool surelyFlat(const Query& q, const Instance& in, const TriangleFlat& flat, const RTCRay& ray,
                       const RTCHit& hit) {
  const Vector3f n(hit.Ng_x, hit.Ng_y, hit.Ng_z), d(ray.dir_x, ray.dir_y, ray.dir_z);
  const float slope = dot(n, d), squared = lengthSquared(d);
  // Embree's arithmetic is float32 on places about the origin and the hit: an error of a few units in the
  // last place of the larger.
  const float off = 0x1p-21f * (q.originSize + ray.tfar * q.directionSize) * in.objectScale;
  return flat.holds(hit.u, hit.v, off, slope * slope / (lengthSquared(n) * squared));
}

/// By where the ray has surely crossed the triangle's plane. Where the hit's object touches a solid, a path
/// that goes on from the hit may be back in the solid's mesh, for all that float32 can tell.
double crossedBy(const Query& q, const Instance& in, const RTCRay& ray, const RTCHit& hit) {
  const Vector3 n(hit.Ng_x, hit.Ng_y, hit.Ng_z), d(ray.dir_x, ray.dir_y, ray.dir_z);
  const double off = 0x1p-20 * double(q.originSize + ray.tfar * q.directionSize) * double(in.objectScale);
  return double(ray.tfar) + off * length(n) / std::abs(dot(n, d));
}

/// What a candidate triangle means for the query: the end of its solid that is hit, or nothing.
std::optional<RoundedEnd> judge(Query& q, std::uint32_t instance, std::uint32_t facet,
                                const RTCRay& embreeRay, const RTCHit& hit) {
  const Instance& in = (*q.instances)[instance];
  const RoundingView& view = *in.view;
  const double t = double(embreeRay.tfar);
  const Candidate candidate{facet, t};
  // The path goes on inward from this very surface: it meets the far end.
  if (q.own(instance, facet)) return farEnd(view, candidate, q.rayFor(instance));
  const Ray& ray = q.rayFor(instance);
  const auto end = firstEndBeyond(view, candidate, ray, q.tnear, q.origin());
  if (!end || end->feature != Feature::Flat) {
    const bool front = dot(Vector3(view.facets[facet].normal), ray.direction) < 0;
    q.pass(front ? t : crossedBy(q, in, embreeRay, hit), instance, view.facets[facet].solid, front);
  }
  return end;
}

/// What a candidate triangle blocks the ray with, if it does. The far side of the solid that the path is in
/// counts as flat: which feature it is need not be found out.
std::optional<Feature> blockerAt(Query& q, std::uint32_t instance, std::uint32_t facet, float t) {
  if (q.own(instance, facet)) {
    // From its own surface inward a path leaves the rounded solid before the mesh.
    if (q.from.inside && q.leaving(instance, facet)) return Feature::Flat;
    return std::nullopt;
  }
  return endWithin(*(*q.instances)[instance].view, {facet, double(t)}, q.rayFor(instance), q.tnear, q.best,
                   q.origin());
}

void intersectFilter(const RTCFilterFunctionNArguments* args) {
  auto& q = *reinterpret_cast<Query*>(args->context);
  auto& ray = *reinterpret_cast<RTCRay*>(args->ray);
  const auto& hit = *reinterpret_cast<const RTCHit*>(args->hit);
  const std::uint32_t instance = hit.instID[0], triangle = hit.primID;
  args->valid[0] = 0;
  const Instance& in = (*q.instances)[instance];
  if (q.leaves(instance, triangle)) {
    if (q.from.onRounding) q.ownExit = std::min(q.ownExit, crossedBy(q, in, ray, hit));
    return;
  }
  const std::uint32_t facet = in.flats ? in.flats[triangle].facet : kNone;
  bool flat = false;
  if (facet == kNone) {
    if (q.from.instance == instance && q.from.triangle == triangle) return;
    if (!(double(ray.tfar) < q.best)) return;
    q.best = double(ray.tfar);
  } else if (q.leavesSolid(instance, facet)) {
    if (q.from.onRounding) q.ownExit = std::min(q.ownExit, crossedBy(q, in, ray, hit));
    return;
  } else if (surelyFlat(q, in, in.flats[triangle], ray, hit) && q.isEnd(instance, facet)) {
    if (!q.counts(double(ray.tfar))) return;
    q.best = double(ray.tfar);
    flat = true;
  } else {
    const auto end = judge(q, instance, facet, ray, hit);
    if (!end || !q.counts(end->t)) return;
    q.best = end->t;
    q.end = *end;
  }
  ray.tfar = q.tfarAfter(q.best);
  q.found = true;
  q.surelyFlat = flat;
  q.instance = instance;
  q.facet = facet;
  q.triangle = triangle;
  q.u = hit.u;
  q.v = hit.v;
  args->valid[0] = -1;
}

void occludedFilter(const RTCFilterFunctionNArguments* args) {
  auto& q = *reinterpret_cast<Query*>(args->context);
  const auto& ray = *reinterpret_cast<const RTCRay*>(args->ray);
  const auto& hit = *reinterpret_cast<const RTCHit*>(args->hit);
  const std::uint32_t instance = hit.instID[0], triangle = hit.primID;
  if (q.leaves(instance, triangle)) {
    args->valid[0] = 0;
    return;
  }
  const Instance& in = (*q.instances)[instance];
  const std::uint32_t facet = in.flats ? in.flats[triangle].facet : kNone;
  if (facet == kNone) {
    if ((q.from.instance == instance && q.from.triangle == triangle) || !(double(ray.tfar) < q.best))
      args->valid[0] = 0;
    return;
  }
  if (!q.own(instance, facet) && surelyFlat(q, in, in.flats[triangle], ray, hit) &&
      q.isEnd(instance, facet) && q.counts(double(ray.tfar)))
    return;
  if (const auto blocker = blockerAt(q, instance, facet, ray.tfar))
    q.end.feature = *blocker;
  else
    args->valid[0] = 0;
}

struct PointQuery {
  RTCIntersectContext context;
  const std::vector<Instance>* instances;
  Point3 point;
};

/// Accepts a triangle whose solid's mesh holds the point. A ray from inside a solid meets its far side, so
/// any ray from the point finds every such solid.
void insideFilter(const RTCFilterFunctionNArguments* args) {
  const auto& q = *reinterpret_cast<const PointQuery*>(args->context);
  const auto& hit = *reinterpret_cast<const RTCHit*>(args->hit);
  const Instance& in = (*q.instances)[hit.instID[0]];
  args->valid[0] = 0;
  if (!in.flats || in.flats[hit.primID].facet == kNone) return;
  const std::uint32_t solid = in.view->facets[in.flats[hit.primID].facet].solid;
  const SolidRecord &record = in.view->solids[solid], &end = in.view->solids[solid + 1];
  const Vector3 p =
      in.objectFromWorld(q.point) - Point3(record.origin[0], record.origin[1], record.origin[2]);
  const double slack = 0x1p-20 * record.boundRadius; // on the surface is inside
  for (std::uint32_t f = record.firstFacet; f < end.firstFacet; ++f)
    if (dot(Vector3(in.view->facets[f].normal), p) > double(in.view->facets[f].offset) + slack) return;
  args->valid[0] = -1;
}

class EmbreeTracer final : public Tracer {
public:
  explicit EmbreeTracer(std::vector<TracedInstance> instances) : owned_(std::move(instances)) {
    for (const TracedInstance& i : owned_)
      for (int corner = 0; corner < 8; ++corner) {
        const Bounds3& b = i.mesh->bounds();
        if (b.empty()) continue;
        bounds_.extend(
            i.worldFromObject(Point3(corner & 1 ? b.upper.x : b.lower.x, corner & 2 ? b.upper.y : b.lower.y,
                                     corner & 4 ? b.upper.z : b.lower.z)));
      }
    centre_ = bounds_.empty() ? Vector3() : Vector3(bounds_.centre());
    reach_ = 0.5 * bounds_.diagonal();
    instances_.reserve(owned_.size());
    for (const TracedInstance& i : owned_) {
      instances_.push_back(instanceOf(i));
      attachInstance(i);
      if (i.rounding) largestDiameter_ = std::max(largestDiameter_, worldDiameter(i));
    }
    scene_.build();
  }

  std::optional<TraceHit> intersect(const Ray& ray, const RayOrigin& from, double tnear,
                                    double tfar) const override {
    if (from.instance == kNone && isFar(ray)) return intersectFromAfar(ray, from, tnear, tfar);
    Query q = query(ray, from, tnear, tfar, &intersectFilter);
    traverse(q);
    // A path inside a rounded solid ends at its far side, unless it meets something before. What it met may
    // lie behind that side, in the sliver, and then the search may have ended before the side's triangle.
    if (from.inside && endsOutside(q)) {
      q = query(ray, from, tnear, tfar, &intersectFilter);
      holdOpen(q);
      traverse(q);
    }
    if (!q.found) return std::nullopt;
    return q.facet == kNone ? sharpHit(q) : roundedHit(q);
  }

  bool occluded(const Ray& ray, const RayOrigin& from, double tnear, double tfar,
                Feature* blocker) const override {
    Query q = query(ray, from, tnear, tfar, &occludedFilter);
    q.end.feature = Feature::Flat;
    RTCRay r = embreeRay(q);
    rtcOccluded1(scene_.get(), &q.context, &r);
    if (blocker) *blocker = q.end.feature;
    return r.tfar < 0 || (from.inside && endsOutside(q));
  }

  bool insideSolid(const Point3& point) const override {
    const double away = length(Vector3(point) - centre_);
    if (!(away <= 2 * reach_)) return false; // Embree takes no coordinates beyond 1.8e18
    PointQuery q;
    rtcInitIntersectContext(&q.context);
    q.context.filter = &insideFilter;
    q.instances = &instances_;
    q.point = point;
    // Begins a little before the point, so that it meets the far side also of a solid that the point is on.
    const Vector3 direction{0.8, 0.5, 0.33166}, o = Vector3(point) - centre_;
    const double before = 0x1p-18 * (length(o) + reach_);
    RTCRay r = embreeRay(o - direction * before, direction, 0, largestDiameter_ + 2 * before);
    rtcOccluded1(scene_.get(), &q.context, &r);
    return r.tfar < 0;
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
    std::size_t bytes = scene_.bytes() + instances_.size() * sizeof(Instance);
    for (const auto& [key, flats] : flats_)
      bytes += flats.size() * sizeof(TriangleFlat);
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
    constexpr double kNear = 64;                 // reaches
    constexpr double kShort = 1e-6, kLong = 1e6; // lengths; a scene file's scales are near 1
    const double away = lengthSquared(Vector3(ray.origin) - centre_), size = lengthSquared(ray.direction);
    return !(away <= kNear * kNear * reach_ * reach_ && size >= kShort * kShort && size <= kLong * kLong);
  }

  /// The same hit, found by a unit ray that starts before the scene.
  std::optional<TraceHit> intersectFromAfar(const Ray& ray, const RayOrigin& from, double tnear,
                                            double tfar) const {
    const double size = length(ray.direction);
    const Vector3 unit = ray.direction / size;
    const double skipped =
        std::max(0.0, dot(centre_ - Vector3(ray.origin), unit) - 2 * reach_); // the scene is behind it
    const Ray near{ray.origin + unit * skipped, unit};
    if (isFar(near)) return std::nullopt; // passes the scene by, or there is none
    auto hit = intersect(near, from, std::max(0.0, tnear * size - skipped), tfar * size - skipped);
    if (hit) hit->t = (hit->t + skipped) / size;
    return hit;
  }

  Instance instanceOf(const TracedInstance& i) {
    Instance in{nullptr, nullptr, 1, i.worldFromObject.inverse()};
    if (!i.rounding) return in;
    in.view = &i.rounding->view();
    auto& flats = flats_[{i.mesh.get(), i.rounding.get()}];
    if (flats.empty()) flats = flatMargins(*in.view, i.mesh->mesh(), 0.5 * i.mesh->bounds().diagonal());
    in.flats = flats.data();
    double square = 0;
    for (const auto& row : in.objectFromWorld.rows())
      for (std::size_t k = 0; k < 3; ++k)
        square += row[k] * row[k];
    in.objectScale = float(std::sqrt(square));
    return in;
  }

  void attachInstance(const TracedInstance& i) {
    // Embree's frames are about the mesh's and the scene's centres: float32 keeps its digits far from the
    // origin.
    const Transform t =
        Transform::translate(-centre_) * i.worldFromObject * Transform::translate(i.mesh->centre());
    const RTCGeometry geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, i.mesh->scene());
    float rows[12];
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 4; ++c)
        rows[4 * r + c] = float(t.rows()[r][c]);
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, rows);
    scene_.attach(geometry);
  }

  Query query(const Ray& ray, const RayOrigin& from, double tnear, double tfar,
              RTCFilterFunctionN filter) const {
    Query q;
    rtcInitIntersectContext(&q.context);
    q.context.filter = filter;
    q.instances = &instances_;
    q.ray = ray;
    q.from = from;
    q.tnear = tnear;
    q.best = tfar;
    q.found = false;
    const Vector3 o = Vector3(ray.origin) - centre_;
    const auto largest = [](const Vector3& v) {
      return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    };
    const double size = largest(o);
    q.originSize = float(size);
    q.directionSize = float(largest(ray.direction));
    if (from.solid != kNone) {
      const auto& solids = instances_[from.instance].view->solids;
      q.ownFirstFacet = solids[from.solid].firstFacet;
      q.ownEndFacet = solids[from.solid + 1].firstFacet;
    }
    q.keep = 0;
    q.limit = tfar;
    if (from.maybeInSliver) holdOpen(q);
    // A path that leaves a plane starts off it by what float32 can put on the wrong side of it: the rounding
    // of the origin and of the transforms, a few units in the last place of the largest coordinate involved.
    // The hits are exact without that where the plane is a rounded solid's; it spares meeting the plane
    // again.
    q.offset = {0, 0, 0};
    if (from.instance != kNone && !from.onRounding)
      q.offset =
          from.normal * std::copysign(16 * 0x1p-24 * std::max(size, reach_), dot(from.normal, ray.direction));
    return q;
  }

  /// Lets the traversal see all triangles of the solids that the origin may be in.
  void holdOpen(Query& q) const {
    q.keep = q.tnear + largestDiameter_ / length(q.ray.direction);
    q.limit = std::max(q.best, q.keep);
  }

  void traverse(Query& q) const {
    RTCRayHit rayHit;
    rayHit.ray = embreeRay(q);
    rayHit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rayHit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_.get(), &q.context, &rayHit);
  }

  /// Does the ray of a path inside a rounded solid end outside of it, by another object's hit or by tfar?
  bool endsOutside(const Query& q) const {
    const RayOrigin& from = q.from;
    if (from.solid == kNone || !std::isfinite(q.best)) return false;
    if (q.found && q.own(q.instance, q.facet)) return false;
    const Instance& in = instances_[from.instance];
    return !contains(*in.view, from.solid, in.objectFromWorld(q.ray.at(q.best)));
  }

  RTCRay embreeRay(const Query& q) const {
    return embreeRay(Vector3(q.ray.origin) - centre_ + q.offset, q.ray.direction, q.tnear, q.limit);
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
  static double worldDiameter(const TracedInstance& i) {
    double largest = 0, square = 0;
    for (const SolidRecord& s : i.rounding->view().solids)
      largest = std::max(largest, double(s.boundRadius));
    for (const auto& row : i.worldFromObject.rows())
      for (std::size_t k = 0; k < 3; ++k)
        square += row[k] * row[k];
    return 2 * largest * std::sqrt(square);
  }

  /// Is the hit still in the sliver that the path began in?
  static bool inOwnSliver(const Query& q) {
    return q.from.onRounding && !q.from.inside && !(q.ownExit < q.best);
  }
  /// Near an origin that may be in a sliver, the hit may be in the same one.
  static bool maybeInSliver(const Query& q) {
    return q.hitInPassage() || inOwnSliver(q) ||
           (q.from.maybeInSliver && q.from.instance != kNone && q.best < q.keep);
  }
  static bool maybeInSolid(const Query& q) {
    return q.from.maybeInSolid || q.hitInPassage() || inOwnSliver(q);
  }

  TraceHit roundedHit(const Query& q) const {
    const RoundedEnd end = q.surelyFlat ? planeHit(q) : q.end;
    const Normal3 n = owned_[q.instance].worldFromObject(Normal3(end.normal));
    return {
        end.t, q.ray.at(end.t),  normalize(Vector3(n)), end.feature, q.instance, q.solid(), q.triangle, q.u,
        q.v,   maybeInSliver(q), maybeInSolid(q)};
  }

  /// Where the ray meets the facet's plane, in double.
  RoundedEnd planeHit(const Query& q) const {
    const Instance& in = instances_[q.instance];
    const FacetRecord& facet = in.view->facets[q.facet];
    const SolidRecord& solid = in.view->solids[facet.solid];
    const Ray ray = in.objectFromWorld(q.ray);
    const Vector3 n(facet.normal), o = ray.origin - Point3(solid.origin[0], solid.origin[1], solid.origin[2]);
    return {(double(facet.offset) - dot(n, o)) / dot(n, ray.direction), n, Feature::Flat};
  }

  /// World, unit, outward by the winding of the file (kept under mirroring).
  Vector3 triangleNormal(std::uint32_t instance, std::uint32_t triangle) const {
    const TracedInstance& in = owned_[instance];
    const TriangleMesh& mesh = in.mesh->mesh();
    const auto& t = mesh.triangles[triangle];
    const Point3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    return normalize(Vector3(in.worldFromObject(Normal3(cross(b - a, c - a)))));
  }

  TraceHit sharpHit(const Query& q) const {
    const TracedInstance& in = owned_[q.instance];
    const TriangleMesh& mesh = in.mesh->mesh();
    const Point3 a = in.worldFromObject(mesh.positions[mesh.triangles[q.triangle][0]]);
    const Vector3 n = triangleNormal(q.instance, q.triangle);
    // Embree's t is a float32: put the hit on the triangle's plane where the ray is not along it.
    const double slope = dot(n, q.ray.direction);
    double exact = dot(n, a - q.ray.origin) / slope;
    if (!(std::abs(exact - q.best) <= 1e-4 * std::abs(q.best)) || !(exact > 0)) exact = q.best;
    return {exact,          q.ray.at(exact), n,   Feature::Flat, q.instance,
            kNone,          q.triangle,      q.u, q.v,           maybeInSliver(q),
            maybeInSolid(q)};
  }

  std::vector<TracedInstance> owned_;
  std::vector<Instance> instances_;
  std::map<std::pair<const TracedMesh*, const Rounding*>, std::vector<TriangleFlat>> flats_;
  Bounds3 bounds_;
  Vector3 centre_;
  double reach_ = 0, largestDiameter_ = 0;
  EmbreeScene scene_;
};

} // namespace

std::shared_ptr<const Tracer> makeTracer(std::vector<TracedInstance> instances) {
  return std::make_shared<EmbreeTracer>(std::move(instances));
}

namespace {

struct ProbeQuery {
  RTCIntersectContext context; // first, so that Embree's pointer to it is ours
  std::span<MeshHit> hits;
  std::size_t count;
};

/// Notes the triangle and lets the ray go on.
void probeFilter(const RTCFilterFunctionNArguments* args) {
  auto& q = *reinterpret_cast<ProbeQuery*>(args->context);
  const auto& ray = *reinterpret_cast<const RTCRay*>(args->ray);
  const auto& hit = *reinterpret_cast<const RTCHit*>(args->hit);
  args->valid[0] = 0;
  const auto kept = q.hits.first(std::min(q.count, q.hits.size()));
  for (const MeshHit& seen : kept)
    if (seen.triangle == hit.primID) return; // Embree may offer a triangle several times
  if (q.count < q.hits.size()) q.hits[q.count] = {double(ray.tfar), hit.primID};
  ++q.count;
}

} // namespace

std::size_t allHits(const TracedMesh& mesh, const Ray& ray, double tfar, std::span<MeshHit> hits) {
  ProbeQuery q;
  rtcInitIntersectContext(&q.context);
  q.context.filter = &probeFilter;
  q.hits = hits;
  q.count = 0;
  RTCRayHit rayHit;
  const Vector3 origin = Vector3(ray.origin) - mesh.centre();
  rayHit.ray = {float(origin.x),
                float(origin.y),
                float(origin.z),
                0,
                float(ray.direction.x),
                float(ray.direction.y),
                float(ray.direction.z),
                0,
                above(tfar),
                ~0u,
                0,
                0};
  rayHit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rayHit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(mesh.scene(), &q.context, &rayHit);
  return q.count;
}

} // namespace chamfer
