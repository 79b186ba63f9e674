// Ray queries of a scene: Embree over the unmodified meshes, with the rounding applied to every candidate
// hit. The only place that knows Embree (tracer.cpp). Immutable after construction; any number of threads may
// query it.
#pragma once

#include "common/ray_query.h"
#include "common/sidecar.h"
#include "common/transform.h"
#include "preprocess/mesh.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace chamfer {

/// A mesh with its bounding volume hierarchy; shared by all instances, scenes and roundings of it.
class TracedMesh;
/// `cancelled` is asked often, from any thread; true: Error(Cancelled).
std::shared_ptr<const TracedMesh> makeTracedMesh(std::shared_ptr<const TriangleMesh> mesh,
                                                 const std::function<bool()>& cancelled = {});
/// Of the hierarchy, without the mesh.
std::size_t memoryBytes(const TracedMesh& mesh);

/// A triangle that a probe met; the mesh's frame.
struct MeshHit {
  double t; ///< in units of the direction's length
  std::uint32_t triangle;
};
/// All triangles of the mesh that `ray` (mesh's frame) meets with t in (0, tfar), in no order. Returns how
/// many there are; as many of them as fit are stored in `hits`.
std::size_t allHits(const TracedMesh& mesh, const Ray& ray, double tfar, std::span<MeshHit> hits);

/// One placed object. `rounding` null: the mesh is sharp.
struct TracedInstance {
  std::shared_ptr<const TracedMesh> mesh;
  std::shared_ptr<const Rounding> rounding;
  Transform worldFromObject;
};

/// Where a path is, so that a surface is never hit again from where the path leaves it. For a convex rounded
/// solid the answer is exact without any offset: its id and the side on which the path goes on.
struct RayOrigin {
  std::uint32_t instance = kNone; ///< kNone: a free point (camera, a batch ray)
  std::uint32_t solid = kNone;    ///< kNone: a sharp triangle
  std::uint32_t triangle = kNone;
  bool inside = false; ///< the path goes on inside the solid (transmission): only its far end can be hit
  /// The origin may lie in the sliver of another solid, behind that solid's mesh and before its rounded
  /// surface. False spares the search for it. A camera's rays may say false of both this and the next where
  /// Tracer::insideSolid says so of the eye.
  bool maybeInSliver = true;
  /// The origin may lie inside the mesh of a rounded solid, other than the one the path is at. False spares
  /// looking at back-facing triangles.
  bool maybeInSolid = true;
  /// The path leaves a rounding, so it begins in that solid's own sliver.
  bool onRounding = false;
  Vector3 normal{}; ///< of the surface there: world, unit, outward
};

struct TraceHit {
  double t;               ///< in units of the direction's length
  Point3 position;        ///< world
  Vector3 normal;         ///< world, unit, outward: of the rounded surface (of the triangle where sharp)
  Feature feature;        ///< Flat where sharp
  std::uint32_t instance; ///< index in the tracer's instances
  std::uint32_t solid;    ///< in the instance's mesh; kNone where sharp
  std::uint32_t triangle; ///< mesh triangle that was met
  float u, v;             ///< barycentric coordinates of the mesh's hit on it
  /// The hit may lie in the sliver of another solid (only where solids interpenetrate).
  bool maybeInSliver = false;
  bool maybeInSolid = false; ///< the hit may lie inside the mesh of another solid
  bool rounded() const { return feature != Feature::Flat; }
  /// The origin for a ray that leaves this hit along `direction`.
  RayOrigin leave(const Vector3& direction) const {
    const bool inside = dot(direction, normal) < 0;
    return {instance, solid, triangle, inside, maybeInSliver, maybeInSolid || inside, rounded(), normal};
  }
};

class Tracer {
public:
  virtual ~Tracer() = default;
  /// First hit with t in (tnear, tfar), or nothing.
  virtual std::optional<TraceHit> intersect(const Ray& ray, const RayOrigin& from = {}, double tnear = 0,
                                            double tfar = INFINITY) const = 0;
  /// Is anything hit with t in (tnear, tfar)? `blocker`: where not null, set to the feature of what was
  /// found, which need not be the nearest.
  virtual bool occluded(const Ray& ray, const RayOrigin& from = {}, double tnear = 0, double tfar = INFINITY,
                        Feature* blocker = nullptr) const = 0;
  /// Is the point inside the unmodified mesh of a rounded solid (in its rounded solid or its sliver)?
  virtual bool insideSolid(const Point3& point) const = 0;
  virtual const Bounds3& bounds() const = 0;   ///< world, of the unmodified meshes
  virtual std::size_t memoryBytes() const = 0; ///< Embree structures and roundings, each counted once
};

/// Builds the top level over the instances (mesh hierarchies are shared, not rebuilt).
std::shared_ptr<const Tracer> makeTracer(std::vector<TracedInstance> instances);

} // namespace chamfer
