// Ray queries of a scene: Embree over the unmodified meshes, with the rounding applied to every candidate
// hit. The only place that knows Embree (tracer.cpp). Immutable after construction; any number of threads may
// query it.
#pragma once

#include "common/ray_query.h"
#include "common/sidecar.h"
#include "common/transform.h"
#include "preprocess/mesh.h"
#include "server/render/tracing/path_state.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace chamfer {

/// A mesh with its bounding volume hierarchy; shared by all instances, scenes and roundings of it.
class TracedMesh;
/// `cancelled` is asked often, from any thread; true: Error(Cancelled).
std::shared_ptr<const TracedMesh> makeTracedMesh(std::shared_ptr<const TriangleMesh> mesh,
                                                 const std::function<bool()>& cancelled = {});
/// Of the hierarchy, without the mesh.
std::size_t memoryBytes(const TracedMesh& mesh);
/// The instruction set that rays are traced with, as Embree names it: the same on every machine, so that the
/// bits are.
std::string_view rayInstructionSet();

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
  /// Light may go through some of its triangles. Then sharp closed components count as solids, and what
  /// coincides with them is found. Of an opaque one, solids that sink into each other are one room to a path
  /// inside them: walls within are not there (but whatever stands wholly inside one is).
  bool transmits = false;
};

struct TraceHit {
  double t;               ///< in units of the direction's length
  Point3 position;        ///< world
  Vector3 normal;         ///< world, unit, outward: of the rounded surface (of the triangle where sharp)
  Feature feature;        ///< Flat where sharp
  std::uint32_t instance; ///< index in the tracer's instances
  std::uint32_t solid;    ///< as PathState::Place's
  std::uint32_t triangle; ///< mesh triangle that was met
  float u, v;             ///< barycentric coordinates of the mesh's hit on it
  bool rounded() const { return feature != Feature::Flat; }
};

/// What a path needs of the place where it arrives, to go on from there.
struct Arrival {
  PathState state; ///< for rays from the hit in any direction
  /// Other surfaces that coincide with the hit's, where light goes through one of them or the path is inside
  /// a solid: solids that touch, with nothing between them.
  boost::container::small_vector<TraceHit, 1> touching;
};

/// One of several rays that are traced together: as Tracer::intersect() has its arguments.
struct RayTask {
  const Ray* ray;
  const PathState* from;
  double tnear, tfar;
  TraceHit* hit;    ///< set where something is hit
  Arrival* arrival; ///< may be null
  bool found = false;
};
/// As Tracer::occluded() has its arguments.
struct ShadowTask {
  Ray ray;
  const PathState* from;
  double tfar;
  bool blocked = false;
  Feature blocker = Feature::Flat;
};

class Tracer {
public:
  virtual ~Tracer() = default;
  /// Answers each as by itself, whatever the others are. `alike`: neighbours in the list mostly go the same
  /// way.
  virtual void intersect(std::span<RayTask> tasks, bool alike) const = 0;
  /// As many in one call as there are; neighbours mostly go the same way.
  virtual void occluded(std::span<ShadowTask> tasks) const = 0;
  /// First hit with t in (tnear, tfar), or nothing. `from`: of the point at tnear. `arrival`, if not null, is
  /// replaced where something is hit; it may be the one that holds `from`.
  virtual std::optional<TraceHit> intersect(const Ray& ray, const PathState& from = {}, double tnear = 0,
                                            double tfar = INFINITY, Arrival* arrival = nullptr) const = 0;
  /// Is anything hit with t in (tnear, tfar)? `blocker`: where not null, set to the feature of what was
  /// found, which need not be the nearest.
  virtual bool occluded(const Ray& ray, const PathState& from = {}, double tnear = 0, double tfar = INFINITY,
                        Feature* blocker = nullptr) const = 0;
  /// The solids that a free point is in: of rounded ones all, of sharp ones those that light goes through.
  virtual PathState stateAt(const Point3& point) const = 0;
  /// Has every point within `radius` of `point` the same state as it, surely?
  virtual bool sameStateAround(const Point3& point, double radius) const = 0;
  /// Is the solid a hole in another one of its mesh: a closed sharp component that is wound inside out?
  virtual bool isCavity(std::uint32_t instance, std::uint32_t solid) const = 0;
  /// Half the diagonal of a solid in the world, or an upper bound of it.
  virtual double worldRadius(std::uint32_t instance, std::uint32_t solid) const = 0;
  virtual const Bounds3& bounds() const = 0;   ///< world, of the unmodified meshes
  virtual std::size_t memoryBytes() const = 0; ///< Embree structures and roundings, each counted once
};

/// The largest coordinate that a scene may have, in the world and in every mesh's frame: Embree takes none
/// much larger.
inline constexpr double kLargestCoordinate = 1e15;
/// Checks that every mesh, and the whole scene as every mesh's frame has it, stays within kLargestCoordinate.
/// Throws Error(OutOfRange) that names the first instance which does not, as `nameOf(its index)` says.
void checkCoordinates(std::span<const TracedInstance> instances,
                      const std::function<std::string(std::size_t)>& nameOf);

/// Builds the top level over the instances (mesh hierarchies are shared, not rebuilt). Throws
/// Error(OutOfRange) that names an instance which reaches beyond kLargestCoordinate.
std::shared_ptr<const Tracer> makeTracer(std::vector<TracedInstance> instances);

} // namespace chamfer
