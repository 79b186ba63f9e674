// What the renderer needs of a scene beside its geometry: materials, textures, lights, and a studio's own
// objects.
#pragma once

#include "server/render/light/environment.h"
#include "server/render/light/light_sources.h"
#include "server/render/material/material.h"
#include "server/render/scene/scene.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace chamfer {

/// Which material each triangle of a mesh has when its instance names none.
struct MeshMaterials {
  std::vector<std::uint32_t> ofTriangle; ///< into SceneData::materials; empty: kDefaultMaterial everywhere
  bool transmits = false;                ///< light goes through some of them
};

/// What an instance is and what it is made of.
struct InstanceSource {
  std::uint32_t mesh;     ///< into Scene::meshes, followed by SceneData::extraMeshes
  std::uint32_t material; ///< into SceneData::materials; kNone: the mesh's own
};

struct SceneData {
  static constexpr std::uint32_t kDefaultMaterial = 0;

  std::vector<Material> materials; ///< at least one: a neutral grey
  std::vector<Texture> textures;
  std::vector<MeshMaterials> meshMaterials;   ///< by mesh, extra meshes last
  std::vector<InstanceSource> instanceSource; ///< by instance, extra instances last
  std::vector<SceneMesh> extraMeshes;         ///< a studio's ground, the quads of area lights: always sharp
  std::vector<TracedInstance> extraInstances;
  std::shared_ptr<const Environment> environment; ///< null: black
  std::vector<DistantLight> distantLights;
  std::vector<PointLight> pointLights;
};

} // namespace chamfer
