#include "server/http/routes/scene_json.h"

#include "server/http/routes/problem.h"
#include "server/render/request/render_words.h"
#include "server/render/scene/scene_data.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace chamfer::http {
namespace {

using Json = nlohmann::ordered_json;

template <class Triple>
Json triple(const Triple& t) {
  return Json::array({t.x, t.y, t.z});
}

Json triple(const Color& c) { return Json::array({plainNumber(c.r), plainNumber(c.g), plainNumber(c.b)}); }
Json knownLength(double length) { return length > 0 ? Json(length) : Json(); }
/// Radii in use come from float32 storage, largest ones from double arithmetic.
Json radiusJson(double current, double max) {
  return {{"current", current > 0 ? Json(plainNumber(static_cast<float>(current))) : Json()},
          {"max", knownLength(max)}};
}

/// null: a scene file, which says it of each of its meshes.
Json upAxisJson(const Scene& scene) {
  if (!scene.meshUp) return {};
  const bool y = *scene.meshUp == UpAxis::Y;
  return {{"current", y ? "y" : "z"},
          {"ids",
           {{"y", (y ? scene.id : scene.otherUpId).hex()}, {"z", (y ? scene.otherUpId : scene.id).hex()}}}};
}

std::string dumped(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

std::size_t roundedEdges(const Rounding& rounding) {
  const RoundingView& view = rounding.view();
  std::size_t halfEdges = 0;
  for (const SolidRecord& solid : view.solids.first(view.solidCount()))
    halfEdges += solid.halfEdgeCount;
  return halfEdges / 2;
}

Json meshJson(const SceneMesh& mesh) {
  Json json{
      {"name", mesh.name}, {"triangles", mesh.mesh->triangles.size()}, {"rounded", mesh.rounding != nullptr}};
  json["solids"] = mesh.rounding ? Json(mesh.rounding->view().solidCount()) : Json();
  json["rounded_edges"] = mesh.rounding ? roundedEdges(*mesh.rounding) : 0;
  json["radius"] = radiusJson(mesh.radius, mesh.maxRadius);
  json["rounding_bytes"] = mesh.rounding ? mesh.rounding->bytes() : 0;
  return json;
}

Json textureJson(const SceneData& data, std::uint32_t texture) {
  if (texture == kNoTexture) return {};
  return {{"width", data.textures[texture].width()}, {"height", data.textures[texture].height()}};
}

Json materialJson(const SceneData& data, const Material& material) {
  return {{"name", material.name},
          {"base_color", triple(material.baseColor)},
          {"roughness", plainNumber(material.roughness)},
          {"metallic", plainNumber(material.metallic)},
          {"specular", plainNumber(material.specular)},
          {"transmission", plainNumber(material.transmission)},
          {"ior", plainNumber(material.ior)},
          {"emission", triple(material.emission)},
          {"absorption", triple(material.absorption)},
          {"base_color_texture", textureJson(data, material.baseColorTexture)},
          {"roughness_texture", textureJson(data, material.roughnessTexture)},
          {"normal_texture", textureJson(data, material.normalTexture)}};
}

Json summary(const CatalogueEntry& entry, const std::string& root) {
  const Scene* scene = entry.scene.get();
  Json json{{"name", entry.name}};
  json["id"] = scene ? Json(scene->id.hex()) : Json();
  json["state"] = sceneStateWord(entry.state);
  if (!entry.error.empty()) json["error"] = {{"kind", errorWord(entry.fault)}, {"detail", entry.error}};
  json["triangles"] = scene ? Json(scene->triangles) : Json();
  json["rounded_edges"] = scene ? Json(scene->roundedEdges) : Json();
  json["bounds"] = nullptr;
  json["radius"] = nullptr;
  json["warnings"] = Json::array();
  if (!scene) return json;
  if (!scene->bounds.empty())
    json["bounds"] = {{"min", triple(scene->bounds.lower)}, {"max", triple(scene->bounds.upper)}};
  const RadiusRange radius = radiusRange(*scene);
  json["radius"] = radiusJson(radius.current, radius.max);
  if (!entry.outdated.empty()) json["warnings"].push_back(entry.outdated);
  for (const std::string& warning : scene->warnings)
    json["warnings"].push_back(withoutRoot(warning, root));
  return json;
}

} // namespace

RadiusRange radiusRange(const Scene& scene) {
  RadiusRange range;
  for (const SceneMesh& mesh : scene.meshes) {
    if (mesh.staysSharp) continue;
    range.current = std::max(range.current, mesh.radius);
    if (mesh.maxRadius > 0) range.max = range.max > 0 ? std::min(range.max, mesh.maxRadius) : mesh.maxRadius;
  }
  return range;
}

std::string sceneSummaryJson(const CatalogueEntry& entry, const std::string& root) {
  return dumped(summary(entry, root));
}

std::string sceneDetailJson(const CatalogueEntry& entry, const std::string& root) {
  const Scene& scene = *entry.scene;
  Json json = summary(entry, root);
  json["up_axis"] = upAxisJson(scene);
  json["instances"] = scene.instances.size();
  json["meshes"] = Json::array();
  for (const SceneMesh& mesh : scene.meshes)
    json["meshes"].push_back(meshJson(mesh));
  json["materials"] = Json::array();
  if (scene.data)
    for (const Material& material : scene.data->materials)
      json["materials"].push_back(materialJson(*scene.data, material));
  const Camera& camera = scene.camera;
  json["camera"] = {{"eye", triple(camera.eye)},
                    {"target", triple(camera.target)},
                    {"up", triple(camera.up)},
                    {"vfov_degrees", camera.vfovDegrees},
                    {"aperture_diameter", camera.apertureDiameter},
                    {"focus_distance", camera.focusDistance}};
  json["load"] = {{"seconds", entry.loadSeconds}, {"memory_bytes", entry.bytes}, {"files", Json::array()}};
  for (const std::filesystem::path& file : scene.files)
    json["load"]["files"].push_back(file.lexically_relative(root).generic_string());
  return dumped(json);
}

} // namespace chamfer::http
