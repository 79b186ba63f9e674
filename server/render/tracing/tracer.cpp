// Embree 3 behind tracer.h.
//
// Embree holds the unmodified meshes, float32, each about its own centre; the rounding is applied in filter
// functions. A filter sees every triangle that a ray meets on its way. For a triangle of a rounded solid it
// asks the rounding for the first end of the ray's interval in the solid (double arithmetic, the double ray)
// and either rejects the triangle, so that the ray goes on through the sliver in the same traversal, or
// accepts it and moves the ray's tfar to that end. The end lies at or behind the triangle, but before the
// tfar that the traversal had, so tfar only ever decreases from one accepted hit to the next, which is what
// the traversal relies on.
#include "server/render/tracing/embree_mesh.h"
#include "server/render/tracing/trace_query.h"

#include <map>

namespace chamfer {
namespace {

/// Embree's context, extended by the query. Lives on the caller's stack.
struct Context {
  RTCIntersectContext embree; // first, so that Embree's pointer to it is ours
  TraceQuery query;
  Vector3 offset; ///< of Embree's ray only
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
  if (!query.takeIfNearer(metTriangle(args))) return;
  reinterpret_cast<RTCRay*>(args->ray)->tfar = above(query.limit);
  args->valid[0] = -1;
}

void occludedFilter(const RTCFilterFunctionNArguments* args) {
  TraceQuery& query = reinterpret_cast<Context*>(args->context)->query;
  if (!query.isBlockedBy(metTriangle(args))) args->valid[0] = 0;
}

struct PointQuery {
  RTCIntersectContext context;
  const std::vector<RayInstance>* instances;
  Point3 point;
};

/// Accepts a triangle whose solid's mesh holds the point. A ray from inside a solid meets its far side, so
/// any ray from the point finds every such solid.
void insideFilter(const RTCFilterFunctionNArguments* args) {
  const auto& q = *reinterpret_cast<const PointQuery*>(args->context);
  const auto& hit = *reinterpret_cast<const RTCHit*>(args->hit);
  const RayInstance& in = (*q.instances)[hit.instID[0]];
  args->valid[0] = 0;
  if (!in.flats || in.flats[hit.primID].facet == kNone) return;
  const std::uint32_t solid = in.view->facets[in.flats[hit.primID].facet].solid;
  if (inUnroundedSolid(*in.view, solid, in.worldFromObject->applyInverse(q.point))) args->valid[0] = -1;
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
      instances_.push_back(rayInstance(i));
      attachInstance(i);
      if (i.rounding) largestDiameter_ = std::max(largestDiameter_, worldDiameter(i));
    }
    scene_.build();
  }

  std::optional<TraceHit> intersect(const Ray& ray, const RayOrigin& from, double tnear,
                                    double tfar) const override {
    if (from.instance == kNone && isFar(ray)) return intersectFromAfar(ray, from, tnear, tfar);
    Context c = context(ray, from, tnear, tfar, &intersectFilter);
    traverse(c);
    // A path inside a rounded solid ends at its far side, unless it meets something before. What it met may
    // lie behind that side, in the sliver, and then the search may have ended before the side's triangle.
    if (from.inside && endsOutside(c.query)) {
      c = context(ray, from, tnear, tfar, &intersectFilter);
      c.query.holdOpen(largestDiameter_);
      traverse(c);
    }
    if (!c.query.found) return std::nullopt;
    return c.query.facet == kNone ? sharpHit(c.query) : roundedHit(c.query);
  }

  bool occluded(const Ray& ray, const RayOrigin& from, double tnear, double tfar,
                Feature* blocker) const override {
    Context c = context(ray, from, tnear, tfar, &occludedFilter);
    RTCRay r = embreeRay(c);
    rtcOccluded1(scene_.get(), &c.embree, &r);
    if (blocker) *blocker = c.query.end.feature;
    return r.tfar < 0 || (from.inside && endsOutside(c.query));
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
    std::size_t bytes = scene_.bytes() + instances_.size() * sizeof(RayInstance);
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

  RayInstance rayInstance(const TracedInstance& i) {
    RayInstance in{nullptr, nullptr, &i.worldFromObject, 1};
    if (!i.rounding) return in;
    in.view = &i.rounding->view();
    auto& flats = flats_[{i.mesh.get(), i.rounding.get()}];
    if (flats.empty()) flats = flatMargins(*in.view, i.mesh->mesh(), 0.5 * i.mesh->bounds().diagonal());
    in.flats = flats.data();
    in.objectScale = float(norm(i.worldFromObject.inverse()));
    return in;
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

  Context context(const Ray& ray, const RayOrigin& from, double tnear, double tfar,
                  RTCFilterFunctionN filter) const {
    Context c{{}, {instances_, ray, from, tnear, tfar}, {}};
    rtcInitIntersectContext(&c.embree);
    c.embree.filter = filter;
    const auto largest = [](const Vector3& v) {
      return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    };
    const double size = largest(Vector3(ray.origin) - centre_);
    c.query.originSize = float(size);
    c.query.directionSize = float(largest(ray.direction));
    if (from.maybeInSliver) c.query.holdOpen(largestDiameter_);
    // A path that leaves a plane starts off it by what float32 can put on the wrong side of it: the rounding
    // of the origin and of the transforms, a few units in the last place of the largest coordinate involved.
    // The hits are exact without that where the plane is a rounded solid's; it spares meeting the plane
    // again.
    if (from.instance != kNone && !from.onRounding)
      c.offset =
          from.normal * std::copysign(16 * 0x1p-24 * std::max(size, reach_), dot(from.normal, ray.direction));
    return c;
  }

  void traverse(Context& c) const {
    RTCRayHit rayHit;
    rayHit.ray = embreeRay(c);
    rayHit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rayHit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_.get(), &c.embree, &rayHit);
  }

  /// Does the ray of a path inside a rounded solid end outside of it, by another object's hit or by tfar?
  bool endsOutside(const TraceQuery& q) const {
    if (q.from.solid == kNone || !std::isfinite(q.best)) return false;
    if (q.found && q.own(q.instance, q.facet)) return false;
    const RayInstance& in = instances_[q.from.instance];
    return !contains(*in.view, q.from.solid, in.worldFromObject->applyInverse(q.ray.at(q.best)));
  }

  RTCRay embreeRay(const Context& c) const {
    const TraceQuery& q = c.query;
    return embreeRay(Vector3(q.ray.origin) - centre_ + c.offset, q.ray.direction, q.tnear, q.limit);
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

  /// An upper bound of what the transform makes of lengths: the Frobenius norm of its linear part.
  static double norm(const Transform& t) {
    double square = 0;
    for (const auto& row : t.rows())
      for (std::size_t k = 0; k < 3; ++k)
        square += row[k] * row[k];
    return std::sqrt(square);
  }
  /// An upper bound of the diameter of an instance's solids in the world.
  static double worldDiameter(const TracedInstance& i) {
    double largest = 0;
    for (const SolidRecord& s : i.rounding->view().solids)
      largest = std::max(largest, double(s.boundRadius));
    return 2 * largest * norm(i.worldFromObject);
  }

  TraceHit roundedHit(const TraceQuery& q) const {
    const RoundedEnd end = q.hitEnd();
    const Normal3 n = owned_[q.instance].worldFromObject(Normal3(end.normal));
    return {end.t,
            q.ray.at(end.t),
            normalize(Vector3(n)),
            end.feature,
            q.instance,
            q.solid(),
            q.triangle,
            q.u,
            q.v,
            q.hitMaybeInSliver(),
            q.hitMaybeInSolid()};
  }

  /// World, unit, outward by the winding of the file (kept under mirroring).
  Vector3 triangleNormal(std::uint32_t instance, std::uint32_t triangle) const {
    const TracedInstance& in = owned_[instance];
    const TriangleMesh& mesh = in.mesh->mesh();
    const auto& t = mesh.triangles[triangle];
    const Point3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    return normalize(Vector3(in.worldFromObject(Normal3(cross(b - a, c - a)))));
  }

  TraceHit sharpHit(const TraceQuery& q) const {
    const TracedInstance& in = owned_[q.instance];
    const TriangleMesh& mesh = in.mesh->mesh();
    const Point3 a = in.worldFromObject(mesh.positions[mesh.triangles[q.triangle][0]]);
    const Vector3 n = triangleNormal(q.instance, q.triangle);
    // Embree's t is a float32: put the hit on the triangle's plane where the ray is not along it.
    const double slope = dot(n, q.ray.direction);
    double exact = dot(n, a - q.ray.origin) / slope;
    if (!(std::abs(exact - q.best) <= 1e-4 * std::abs(q.best)) || !(exact > 0)) exact = q.best;
    return {exact,
            q.ray.at(exact),
            n,
            Feature::Flat,
            q.instance,
            kNone,
            q.triangle,
            q.u,
            q.v,
            q.hitMaybeInSliver(),
            q.hitMaybeInSolid()};
  }

  std::vector<TracedInstance> owned_;
  std::vector<RayInstance> instances_; ///< point into owned_ and flats_
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

} // namespace chamfer
