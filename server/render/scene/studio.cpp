#include "server/render/scene/studio.h"

namespace chamfer {

SkyGradient neutralSky() { return {{0.3f, 0.36f, 0.46f}, {0.62f, 0.64f, 0.67f}, {0.26f, 0.25f, 0.24f}}; }

std::shared_ptr<const TriangleMesh> makeQuad(const Point3& centre, const Vector3& u, const Vector3& v) {
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->positions = {centre - u - v, centre + u - v, centre + u + v, centre - u + v};
  mesh->triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh->faceOfTriangle = {0, 0};
  return mesh;
}

void addQuad(SceneData& data, std::size_t sceneMeshes, const std::string& name, const Point3& centre,
             const Vector3& u, const Vector3& v, Material material) {
  SceneMesh quad;
  quad.name = name;
  quad.mesh = makeQuad(centre, u, v);
  quad.traced = makeTracedMesh(quad.mesh);
  quad.staysSharp = true;
  material.name = name;
  data.materials.push_back(std::move(material));
  data.instanceSource.push_back(
      {std::uint32_t(sceneMeshes + data.extraMeshes.size()), std::uint32_t(data.materials.size() - 1)});
  data.extraInstances.push_back({quad.traced, nullptr, {}});
  data.meshMaterials.push_back({});
  data.extraMeshes.push_back(std::move(quad));
}

void addStudio(SceneData& data, std::size_t sceneMeshes, const Bounds3& bounds) {
  const double size = bounds.diagonal() > 0 ? bounds.diagonal() : 1;
  const Point3 centre = bounds.empty() ? Point3() : bounds.centre();
  const Point3 foot{centre.x, centre.y, bounds.empty() ? 0 : bounds.lower.z};

  Material ground;
  ground.baseColor = {0.42f, 0.42f, 0.43f};
  ground.roughness = 0.8f;
  addQuad(data, sceneMeshes, "studio ground", foot, {12 * size, 0, 0}, {0, 12 * size, 0}, ground);

  Material light;
  light.baseColor = {};
  light.specular = 0;
  light.emission = {17, 16.2f, 15};
  const Vector3 towards =
      normalize(Vector3(-0.9, -0.35, 1.05)); // above, to the left of the fitted camera's view
  const Vector3 u = normalize(cross(Vector3(0, 0, 1), towards)), v = cross(towards, u);
  addQuad(data, sceneMeshes, "studio light", centre + towards * (2.2 * size), u * (0.5 * size),
          v * (0.5 * size), light);

  data.environment = std::make_shared<Environment>(Environment::sky(neutralSky(), {0, 0, 1}));
}

} // namespace chamfer
