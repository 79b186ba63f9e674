#include "server/render/surface.h"

namespace chamfer {
namespace {

/// Texture coordinates of the hit; false where the mesh has none there.
bool textureCoordinates(const TriangleMesh& mesh, const TraceHit& hit, Float2& uv) {
  if (hit.triangle >= mesh.uvTriangles.size()) return false;
  const auto& corners = mesh.uvTriangles[hit.triangle];
  if (corners[0] == kNone || corners[1] == kNone || corners[2] == kNone) return false;
  const auto &a = mesh.uvs[corners[0]], &b = mesh.uvs[corners[1]], &c = mesh.uvs[corners[2]];
  const float w = 1 - hit.u - hit.v;
  uv = {w * a[0] + hit.u * b[0] + hit.v * c[0], w * a[1] + hit.u * b[1] + hit.v * c[1]};
  return true;
}

} // namespace

SurfaceValues surfaceAt(const Scene& scene, const Material& m, const TraceHit& hit) {
  SurfaceValues s{m.baseColor, m.roughness, m.metallic, m.specular, m.transmission, m.ior};
  if (m.baseColorTexture == kNoTexture && m.roughnessTexture == kNoTexture) return s;
  const SceneData& data = *scene.data;
  const std::uint32_t mesh = data.instanceSource[hit.instance].mesh;
  if (mesh >= scene.meshes.size()) return s; // a studio's own objects have no textures
  Float2 uv;
  if (!textureCoordinates(*scene.meshes[mesh].mesh, hit, uv)) return s;
  if (m.baseColorTexture != kNoTexture) {
    const Color c = data.textures[m.baseColorTexture].at(uv.x, uv.y);
    const auto unit = [](float v) { return std::clamp(v, 0.f, 1.f); };
    s.baseColor *= Color{unit(c.r), unit(c.g), unit(c.b)};
  }
  if (m.roughnessTexture != kNoTexture)
    s.roughness *= std::clamp(data.textures[m.roughnessTexture].at(uv.x, uv.y).g, 0.f, 1.f);
  return s;
}

} // namespace chamfer
