// What a hit is made of.
#pragma once

#include "server/render/bsdf.h"
#include "server/render/scene_data.h"

namespace chamfer {

inline const Material& materialAt(const SceneData& data, const TraceHit& hit) {
  const InstanceSource& source = data.instanceSource[hit.instance];
  if (source.material != kNone) return data.materials[source.material];
  const std::vector<std::uint32_t>& own = data.meshMaterials[source.mesh].ofTriangle;
  return data.materials[own.empty() ? SceneData::kDefaultMaterial : own[hit.triangle]];
}

/// The material's values with its textures looked up at the hit's place on the unrounded mesh.
SurfaceValues surfaceAt(const Scene& scene, const Material& material, const TraceHit& hit);

} // namespace chamfer
