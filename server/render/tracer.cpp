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

#include <algorithm>
#include <atomic>
#include <chrono>
#include <embree3/rtcore.h>
#include <limits>
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
  const RoundingView* view; ///< null: sharp
  const TracedMesh* mesh;
  Transform objectFromWorld;
};

/// Nearest float32 not below.
float above(double t) {
  const float f = float(t);
  return double(f) >= t ? f : std::nextafter(f, std::numeric_limits<float>::infinity());
}

/// A solid whose mesh the ray entered at `t` without meeting its rounded solid there.
struct Entered {
  double t = INFINITY;
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
  RoundedEnd end; ///< the best so far, object frame; valid when found
  std::uint32_t instance, solid, triangle;
  float u, v;
  bool found;
  double keep;  ///< tfar may not fall below this
  double limit; ///< tfar as Embree has it
  Entered entered[2];
  std::uint32_t frameInstance = kNone; ///< whose frame objectRay is in
  Ray objectRay;

  /// Remembers the first such entry of each of two solids: one of them is not the solid that is hit.
  void enter(double t, std::uint32_t i, std::uint32_t s) {
    for (Entered& e : entered) {
      if (e.instance == i && e.solid == s) {
        e.t = std::min(e.t, t);
        return;
      }
      if (t < e.t) {
        if (&e == &entered[0]) entered[1] = e;
        e = {t, i, s};
        return;
      }
    }
  }
  bool enteredBeforeHit() const {
    for (const Entered& e : entered)
      if (e.t < best && (e.instance != instance || e.solid != solid)) return true;
    return false;
  }
  /// The tfar to go on with after a hit at `t`.
  float tfarAfter(double t) {
    limit = std::min(limit, std::max(t, keep));
    return above(limit);
  }

  const Ray& rayFor(std::uint32_t i) {
    if (frameInstance != i) {
      objectRay = (*instances)[i].objectFromWorld(ray);
      frameInstance = i;
    }
    return objectRay;
  }
};

/// What a candidate triangle means for the query: the end of its solid that is hit, or nothing.
std::optional<RoundedEnd> judge(Query& q, std::uint32_t instance, std::uint32_t facet, float t) {
  const Instance& in = (*q.instances)[instance];
  const RoundingView& view = *in.view;
  const Ray& ray = q.rayFor(instance);
  const Candidate candidate{facet, double(t)};
  if (q.from.instance == instance && q.from.solid == view.facets[facet].solid) {
    // The path left this very surface: outward it never meets it again, inward only its far end.
    if (!q.from.inside) return std::nullopt;
    return farEnd(view, candidate, ray);
  }
  const auto end = firstEndBeyond(view, candidate, ray, q.tnear);
  if (!end || end->feature != Feature::Flat) q.enter(double(t), instance, view.facets[facet].solid);
  return end;
}

void intersectFilter(const RTCFilterFunctionNArguments* args) {
  auto& q = *reinterpret_cast<Query*>(args->context);
  auto& ray = *reinterpret_cast<RTCRay*>(args->ray);
  const auto& hit = *reinterpret_cast<const RTCHit*>(args->hit);
  const std::uint32_t instance = hit.instID[0], triangle = hit.primID;
  const Instance& in = (*q.instances)[instance];
  const std::uint32_t facet = in.view ? in.view->facetOfTriangle[triangle] : kNone;
  args->valid[0] = 0;
  std::uint32_t solid = kNone;
  if (facet == kNone) {
    if (q.from.instance == instance && q.from.triangle == triangle) return;
    if (!(double(ray.tfar) < q.best)) return;
    q.best = double(ray.tfar);
    ray.tfar = q.tfarAfter(q.best);
  } else {
    const auto end = judge(q, instance, facet, ray.tfar);
    if (!end || !(end->t < q.best) || !(end->t > q.tnear)) return;
    q.best = end->t;
    q.end = *end;
    solid = in.view->facets[facet].solid;
    ray.tfar = q.tfarAfter(end->t);
  }
  q.found = true;
  q.instance = instance;
  q.solid = solid;
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
  const Instance& in = (*q.instances)[instance];
  const std::uint32_t facet = in.view ? in.view->facetOfTriangle[triangle] : kNone;
  if (facet == kNone) {
    if ((q.from.instance == instance && q.from.triangle == triangle) || !(double(ray.tfar) < q.best))
      args->valid[0] = 0;
    return;
  }
  const auto end = judge(q, instance, facet, ray.tfar);
  if (!end || !(end->t < q.best) || !(end->t > q.tnear))
    args->valid[0] = 0;
  else
    q.end.feature = end->feature;
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
  if (!in.view || in.view->facetOfTriangle[hit.primID] == kNone) return;
  const std::uint32_t solid = in.view->facets[in.view->facetOfTriangle[hit.primID]].solid;
  const SolidRecord &record = in.view->solids[solid], &end = in.view->solids[solid + 1];
  const Vector3 p =
      in.objectFromWorld(q.point) - Point3(record.origin[0], record.origin[1], record.origin[2]);
  for (std::uint32_t f = record.firstFacet; f < end.firstFacet; ++f)
    if (dot(Vector3(in.view->facets[f].normal), p) > double(in.view->facets[f].offset)) return;
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
      instances_.push_back(
          {i.rounding ? &i.rounding->view() : nullptr, i.mesh.get(), i.worldFromObject.inverse()});
      attachInstance(i);
      if (i.rounding) largestDiameter_ = std::max(largestDiameter_, worldDiameter(i));
    }
    scene_.build();
  }

  std::optional<TraceHit> intersect(const Ray& ray, const RayOrigin& from, double tnear,
                                    double tfar) const override {
    if (from.instance == kNone && isFar(ray)) return intersectFromAfar(ray, from, tnear, tfar);
    Query q = query(ray, from, tnear, tfar, &intersectFilter);
    RTCRayHit rayHit;
    rayHit.ray = embreeRay(q);
    rayHit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rayHit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_.get(), &q.context, &rayHit);
    if (!q.found) return std::nullopt;
    return q.solid == kNone ? sharpHit(q) : roundedHit(q);
  }

  bool occluded(const Ray& ray, const RayOrigin& from, double tnear, double tfar,
                Feature* blocker) const override {
    Query q = query(ray, from, tnear, tfar, &occludedFilter);
    q.end.feature = Feature::Flat;
    RTCRay r = embreeRay(q);
    rtcOccluded1(scene_.get(), &q.context, &r);
    if (blocker) *blocker = q.end.feature;
    return r.tfar < 0;
  }

  bool insideSolid(const Point3& point) const override {
    const double away = length(Vector3(point) - centre_);
    if (!(away <= 2 * reach_)) return false; // Embree takes no coordinates beyond 1.8e18
    PointQuery q;
    rtcInitIntersectContext(&q.context);
    q.context.filter = &insideFilter;
    q.instances = &instances_;
    q.point = point;
    RTCRay r = embreeRay(Vector3(point) - centre_, {0.8, 0.5, 0.33166}, 0, largestDiameter_);
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
    q.keep = from.maybeInSliver || from.inside ? tnear + largestDiameter_ / length(ray.direction) : 0;
    q.limit = std::max(tfar, q.keep);
    // A path that leaves a sharp triangle starts off its plane by what float32 can put on the wrong side of
    // it: the rounding of the origin and of the transforms, a few units in the last place of the largest
    // coordinate involved.
    q.offset = {0, 0, 0};
    if (from.instance != kNone && from.solid == kNone) {
      const Vector3 o = Vector3(ray.origin) - centre_, n = triangleNormal(from.instance, from.triangle);
      const double largest = std::max({std::abs(o.x), std::abs(o.y), std::abs(o.z), reach_});
      q.offset = n * std::copysign(16 * 0x1p-24 * largest, dot(n, ray.direction));
    }
    return q;
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

  /// Near an origin that may be in a sliver, the hit may be in the same one.
  static bool maybeInSliver(const Query& q) {
    return q.enteredBeforeHit() || (q.from.maybeInSliver && q.from.instance != kNone && q.best < q.keep);
  }

  TraceHit roundedHit(const Query& q) const {
    const Normal3 n = owned_[q.instance].worldFromObject(Normal3(q.end.normal));
    return {q.end.t,
            q.ray.at(q.end.t),
            normalize(Vector3(n)),
            q.end.feature,
            q.instance,
            q.solid,
            q.triangle,
            q.u,
            q.v,
            maybeInSliver(q)};
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
    return {exact, q.ray.at(exact), n,   Feature::Flat, q.instance,
            kNone, q.triangle,      q.u, q.v,           maybeInSliver(q)};
  }

  std::vector<TracedInstance> owned_;
  std::vector<Instance> instances_;
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
