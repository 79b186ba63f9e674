// Meshes and scenes as Embree 3 holds them. Internal to the tracer: with tracer.cpp the only code that knows
// Embree.
#pragma once

#include "server/render/tracing/closed_solids.h"
#include "server/render/tracing/tracer.h"

#include <cmath>
#include <embree3/rtcore.h>
#include <limits>
#include <mutex>

namespace chamfer {

/// Process-wide handle without state of ours; Embree's devices are thread safe.
RTCDevice embreeDevice();

/// Owns an RTCScene and measures what building it took.
class EmbreeScene {
public:
  EmbreeScene();
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  void attach(RTCGeometry geometry); ///< and lets go of it
  /// As makeTracedMesh() about `cancelled`. Throws Error(Internal).
  void build(const std::function<bool()>& cancelled = {});
  RTCScene get() const { return scene_; }
  std::size_t bytes() const { return bytes_; }

private:
  RTCScene scene_;
  std::size_t bytes_ = 0;
};

class TracedMesh {
public:
  TracedMesh(std::shared_ptr<const TriangleMesh> mesh, const std::function<bool()>& cancelled);
  const TriangleMesh& mesh() const { return *mesh_; }
  const Vector3& centre() const { return centre_; } ///< object coordinates of Embree's origin
  const Bounds3& bounds() const { return bounds_; }
  RTCScene scene() const { return scene_.get(); }
  const ClosedSolids& closed() const; ///< made when first asked for
  std::size_t bytes() const {
    return scene_.bytes() + 12 * (mesh_->positions.size() + mesh_->triangles.size());
  }

private:
  std::shared_ptr<const TriangleMesh> mesh_;
  Bounds3 bounds_;
  Vector3 centre_;
  EmbreeScene scene_;
  mutable std::once_flag closedOnce_;
  mutable ClosedSolids closed_;
};

/// Nearest float32 not below.
inline float above(double t) {
  const float f = float(t);
  return double(f) >= t ? f : std::nextafter(f, std::numeric_limits<float>::infinity());
}

} // namespace chamfer
