// A scene with its rounding chosen: tracers and lights (render.h declares what others may ask of it).
#pragma once

#include "server/render/light/lights.h"
#include "server/render/path/render.h"
#include "server/render/surface/surface.h"

#include <mutex>

namespace chamfer {

class PreparedScene {
public:
  PreparedScene(std::shared_ptr<const Scene> scene, std::vector<MeshForm> forms, unsigned probes);

  const Scene& scene() const { return surfaces_.scene(); }
  const Surfaces& surfaces() const { return surfaces_; }
  const Tracer& tracer() const { return *tracer_; } ///< all instances, extra ones last
  const Lights& lights() const { return *lights_; }
  const Tracer& ownTracer() const; ///< without extra instances; made at first use
  std::size_t memoryBytes() const;
  std::size_t tracedTriangles() const;

private:
  Surfaces surfaces_;
  std::shared_ptr<const Tracer> tracer_;
  std::unique_ptr<const Lights> lights_;
  mutable std::once_flag ownOnce_;
  mutable std::shared_ptr<const Tracer> ownTracer_;
};

} // namespace chamfer
