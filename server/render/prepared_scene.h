// A scene with its rounding chosen: tracers and lights (render.h declares what others may ask of it).
#pragma once

#include "server/render/lights.h"
#include "server/render/render.h"
#include "server/render/scene_data.h"

#include <mutex>

namespace chamfer {

class PreparedScene {
public:
  /// `roundings`: by mesh of the scene, null where the mesh is sharp.
  PreparedScene(std::shared_ptr<const Scene> scene, std::vector<std::shared_ptr<const Rounding>> roundings);

  const Scene& scene() const { return *scene_; }
  const Tracer& tracer() const { return *tracer_; } ///< all instances, extra ones last
  const Lights& lights() const { return *lights_; }
  const Tracer& ownTracer() const; ///< without extra instances; made at first use
  std::size_t memoryBytes() const;
  std::size_t tracedTriangles() const;

private:
  std::vector<TracedInstance> ownInstances() const;
  std::shared_ptr<const Scene> scene_;
  std::vector<std::shared_ptr<const Rounding>> roundings_;
  std::shared_ptr<const Tracer> tracer_;
  std::unique_ptr<const Lights> lights_;
  mutable std::once_flag ownOnce_;
  mutable std::shared_ptr<const Tracer> ownTracer_;
};

} // namespace chamfer
