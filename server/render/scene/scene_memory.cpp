// What a scene costs to keep loaded.
#include "server/render/scene/scene_data.h"

#include <set>

namespace chamfer {
namespace {

template <class T>
std::size_t bytesOf(const std::vector<T>& list) {
  return list.capacity() * sizeof(T);
}

std::size_t bytesOf(const TriangleMesh& mesh) {
  return bytesOf(mesh.positions) + bytesOf(mesh.triangles) + bytesOf(mesh.faceOfTriangle) +
         bytesOf(mesh.lineOfFace) + bytesOf(mesh.uvs) + bytesOf(mesh.uvTriangles) +
         bytesOf(mesh.materialOfTriangle) + bytesOf(mesh.materials);
}

/// Of the scene without what is among `seen`, to which it adds.
std::size_t ownBytes(const Scene& scene, std::set<const void*>& seen) {
  const SceneData& data = *scene.data;
  std::size_t bytes = sizeof(Scene) + sizeof(SceneData) + bytesOf(scene.instances) + bytesOf(data.materials) +
                      bytesOf(data.instanceSource) + bytesOf(data.extraInstances);
  for (const auto* meshes : {&scene.meshes, &data.extraMeshes})
    for (const SceneMesh& m : *meshes) {
      if (seen.insert(m.mesh.get()).second) bytes += bytesOf(*m.mesh);
      if (seen.insert(m.traced.get()).second) bytes += memoryBytes(*m.traced);
      if (m.rounding && seen.insert(m.rounding.get()).second) bytes += m.rounding->bytes();
    }
  for (const MeshMaterials& materials : data.meshMaterials)
    bytes += bytesOf(materials.ofTriangle);
  for (const Texture& texture : data.textures)
    if (seen.insert(texture.pixels()).second) bytes += texture.memoryBytes();
  if (data.environment) bytes += data.environment->memoryBytes();
  return bytes;
}

} // namespace

std::size_t memoryBytes(const Scene& scene) {
  std::set<const void*> seen;
  return ownBytes(scene, seen) + (scene.otherUp ? ownBytes(*scene.otherUp, seen) : 0);
}

} // namespace chamfer
