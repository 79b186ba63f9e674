// The scene file, `*.scene.json`. data/SCENES.md describes every key; scene_document_test.cpp holds it
// against what is read here.
#include "server/render/scene/scene_description.h"

#include "common/error.h"
#include "common/text.h"
#include "server/render/path/camera.h"
#include "server/render/scene/json_reader.h"
#include "server/render/scene/studio.h"

#include <unordered_map>

namespace chamfer {
namespace {

constexpr NumberRange kEmission{0, 1e9};
constexpr std::size_t kMostInstances = 16'000'000;

using NameIndex = std::unordered_map<std::string, std::uint32_t>;

std::string uniqueName(const JsonReader& entry, NameIndex& names) {
  std::string name = entry.at("name").string();
  if (!names.emplace(name, std::uint32_t(names.size())).second)
    entry.at("name").fail("the name " + inQuotes(name) + " is used twice");
  return name;
}

std::uint32_t lookUp(const JsonReader& reader, const NameIndex& names, const char* list) {
  const auto found = names.find(reader.string());
  if (found == names.end())
    reader.fail("no entry of \"" + std::string(list) + "\" has the name " + inQuotes(reader.string()));
  return found->second;
}

MeshDescription readMeshEntry(const JsonReader& j, NameIndex& names) {
  j.requireObject(
      {"name", "file", "radius", "radius_world", "radius_clamp", "rounding", "on_nonconvex", "up_axis"});
  MeshDescription m;
  m.path = j.path();
  m.name = uniqueName(j, names);
  m.file = j.at("file").string();
  j.with("rounding", [&](const JsonReader& r) { m.staysSharp = !r.boolean(); });
  j.with("radius", [&](const JsonReader& r) {
    if (m.staysSharp) r.fail("a mesh with \"rounding\": false has no radius; remove one of the two");
    if (!r.isString()) {
      m.radius = Radius{r.number(kPositive), false};
      return;
    }
    try {
      m.radius = parseRadius(r.string());
    } catch (const Error& e) {
      r.fail(e.what());
    }
  });
  j.with("radius_world", [&](const JsonReader& r) {
    if (m.staysSharp) r.fail("a mesh with \"rounding\": false has no radius; remove one of the two");
    if (m.radius) r.fail("cannot stand beside \"radius\"");
    m.radius = Radius{r.number(kPositive), false};
    m.worldRadius = true;
  });
  j.with("radius_clamp", [&](const JsonReader& r) {
    if (m.staysSharp) r.fail("a mesh with \"rounding\": false has no radius; remove one of the two");
    m.radiusClamp = r.number({0, kMostClamp});
  });
  j.with("up_axis", [&](const JsonReader& r) {
    const std::string word = r.string();
    if (word != "y" && word != "z") r.fail("must be \"y\" or \"z\", is \"" + word + "\"");
    m.up = word == "y" ? UpAxis::Y : UpAxis::Z;
  });
  j.with("on_nonconvex", [&](const JsonReader& r) {
    const std::string word = r.string();
    if (word == "error")
      m.onNonConvex = OnNonConvex::Error;
    else if (word == "sharp")
      m.onNonConvex = OnNonConvex::Sharp;
    else if (word == "hull")
      m.onNonConvex = OnNonConvex::Hull;
    else
      r.fail("must be \"error\", \"sharp\" or \"hull\", is " + inQuotes(word));
  });
  return m;
}

MaterialDescription readMaterial(const JsonReader& j, NameIndex& names) {
  j.requireObject({"name", "base_color", "roughness", "metallic", "specular", "transmission", "ior",
                   "emission", "absorption", "base_color_texture", "roughness_texture", "normal_texture"});
  MaterialDescription d;
  d.path = j.path();
  Material& m = d.material;
  m.name = uniqueName(j, names);
  const auto unit = [&](const char* key, float& out) {
    j.with(key, [&](const JsonReader& r) { out = float(r.number(kUnitRange)); });
  };
  j.with("base_color", [&](const JsonReader& r) { m.baseColor = r.color(kUnitRange); });
  unit("roughness", m.roughness);
  unit("metallic", m.metallic);
  unit("specular", m.specular);
  unit("transmission", m.transmission);
  j.with("ior", [&](const JsonReader& r) { m.ior = float(r.number({1, 4})); });
  j.with("emission", [&](const JsonReader& r) { m.emission = r.color(kEmission); });
  j.with("absorption", [&](const JsonReader& r) { m.absorption = r.color(kEmission); });
  j.with("base_color_texture", [&](const JsonReader& r) { d.baseColorTexture = r.string(); });
  j.with("roughness_texture", [&](const JsonReader& r) { d.roughnessTexture = r.string(); });
  j.with("normal_texture", [&](const JsonReader& r) { d.normalTexture = r.string(); });
  return d;
}

Transform readMatrix(const JsonReader& j) {
  j.requireArray();
  if (j.size() != 16) j.fail("must have 16 numbers, row by row, has " + std::to_string(j.size()));
  std::array<std::array<double, 4>, 3> rows;
  for (std::size_t i = 0; i < 16; ++i) {
    const double v = j.at(i).number();
    if (i < 12)
      rows[i / 4][i % 4] = v;
    else if (v != (i == 15 ? 1 : 0))
      j.at(i).fail("the last row must be 0 0 0 1");
  }
  try {
    return Transform(rows);
  } catch (const Error& e) {
    j.fail(e.what());
  }
}

Transform readRotation(const JsonReader& j) {
  if (!j.isArray()) {
    j.requireObject({"axis", "degrees"});
    return Transform::rotate(j.at("axis").direction(), j.at("degrees").number());
  }
  Transform all;
  j.forEach([&](const JsonReader& r) { all = readRotation(r) * all; });
  return all;
}

Transform readScale(const JsonReader& j) {
  const auto factor = [](const JsonReader& r) {
    const double v = r.number();
    if (!(std::abs(v) >= 1e-100 && std::abs(v) <= 1e100))
      r.fail("a scale of " + r.text() + " has no inverse");
    return v;
  };
  if (j.isNumber()) {
    const double s = factor(j);
    return Transform::scale({s, s, s});
  }
  j.requireArray();
  if (j.size() != 3) j.fail("must be one number or an array of 3, has " + std::to_string(j.size()));
  return Transform::scale({factor(j.at(std::size_t(0))), factor(j.at(1)), factor(j.at(2))});
}

Transform readTransform(const JsonReader& j) {
  if (j.has("matrix")) {
    for (const char* key : {"translate", "rotate", "scale"})
      if (j.has(key)) j.at(key).fail("cannot stand beside \"matrix\"");
    return readMatrix(j.at("matrix"));
  }
  Transform t;
  j.with("scale", [&](const JsonReader& r) { t = readScale(r); });
  j.with("rotate", [&](const JsonReader& r) { t = readRotation(r) * t; });
  j.with("translate", [&](const JsonReader& r) { t = Transform::translate(r.vector()) * t; });
  return t;
}

void readInstance(const JsonReader& j, const NameIndex& meshes, const NameIndex& materials,
                  std::vector<InstanceDescription>& out) {
  j.requireObject({"mesh", "material", "matrix", "translate", "rotate", "scale", "repeat"});
  InstanceDescription d;
  d.mesh = lookUp(j.at("mesh"), meshes, "meshes");
  j.with("material", [&](const JsonReader& r) { d.material = lookUp(r, materials, "materials"); });
  d.worldFromObject = readTransform(j);
  std::vector<Vector3> offsets{{0, 0, 0}};
  j.with("repeat", [&](const JsonReader& list) {
    list.forEach([&](const JsonReader& r) {
      r.requireObject({"count", "step"});
      const std::size_t count = r.at("count").wholeNumber(1, kMostInstances);
      const Vector3 step = r.at("step").vector();
      if (offsets.size() > kMostInstances / count)
        r.fail("makes more than " + std::to_string(kMostInstances) + " instances");
      std::vector<Vector3> all;
      all.reserve(offsets.size() * count);
      for (std::size_t i = 0; i < count; ++i)
        for (const Vector3& o : offsets)
          all.push_back(o + step * double(i));
      offsets = std::move(all);
    });
  });
  if (out.size() + offsets.size() > kMostInstances)
    j.fail("the scene has more than " + std::to_string(kMostInstances) + " instances");
  for (const Vector3& o : offsets) {
    out.push_back(d);
    if (!(o == Vector3{})) out.back().worldFromObject = Transform::translate(o) * d.worldFromObject;
  }
}

void readInfinite(const JsonReader& j, const std::string& type, SceneDescription& scene) {
  if (scene.environment) j.fail("the scene has a sky or environment already; there can be one");
  EnvironmentDescription e;
  e.path = j.path();
  e.sky = neutralSky();
  if (type == "sky") {
    j.requireObject({"type", "zenith", "horizon", "ground", "up"});
    j.with("zenith", [&](const JsonReader& r) { e.sky.zenith = r.color(kEmission); });
    j.with("horizon", [&](const JsonReader& r) { e.sky.horizon = r.color(kEmission); });
    j.with("ground", [&](const JsonReader& r) { e.sky.ground = r.color(kEmission); });
  } else {
    j.requireObject({"type", "color", "image", "strength", "rotation_degrees", "up"});
    if (j.has("color") == j.has("image")) j.fail("must have either \"color\" or \"image\"");
    j.with("strength", [&](const JsonReader& r) { e.strength = float(r.number(kEmission)); });
    j.with("rotation_degrees", [&](const JsonReader& r) { e.rotationDegrees = r.number({-3600, 3600}); });
    j.with("image", [&](const JsonReader& r) {
      e.kind = EnvironmentDescription::Kind::Image;
      e.image = r.string();
    });
    j.with("color", [&](const JsonReader& r) {
      e.kind = EnvironmentDescription::Kind::Constant;
      const Color c = r.color(kEmission) * e.strength;
      e.sky = {c, c, c};
    });
  }
  j.with("up", [&](const JsonReader& r) { e.up = r.direction(); });
  scene.environment = e;
}

void readLight(const JsonReader& j, SceneDescription& scene) {
  if (!j.isObject()) j.fail("must be an object");
  const std::string type = j.at("type").string();
  if (type == "area") {
    j.requireObject({"type", "center", "u", "v", "emission"});
    AreaLightDescription a{j.at("center").point(), j.at("u").direction(), j.at("v").direction(),
                           j.at("emission").color(kEmission)};
    if (!(length(cross(a.u, a.v)) > 1e-9 * length(a.u) * length(a.v)))
      j.at("v").fail("must not be parallel to \"u\"");
    scene.areaLights.push_back(a);
  } else if (type == "point") {
    j.requireObject({"type", "position", "intensity"});
    scene.pointLights.push_back({j.at("position").point(), j.at("intensity").color(kEmission)});
  } else if (type == "directional") {
    j.requireObject({"type", "direction", "irradiance", "angular_diameter_degrees"});
    DistantLight d{-normalize(j.at("direction").direction()), j.at("irradiance").color(kEmission), 0};
    j.with("angular_diameter_degrees", [&](const JsonReader& r) {
      d.angularDiameterDegrees = r.number({0, 20});
    });
    scene.distantLights.push_back(d);
  } else if (type == "sky" || type == "environment") {
    readInfinite(j, type, scene);
  } else {
    j.at("type").fail("must be area, point, directional, sky or environment, is " + inQuotes(type));
  }
}

Camera readCamera(const JsonReader& j) {
  j.requireObject({"eye", "target", "up", "vfov_degrees", "aperture_diameter", "focus_distance"});
  Camera c;
  c.eye = j.at("eye").point();
  c.target = j.at("target").point();
  j.with("up", [&](const JsonReader& r) { c.up = r.direction(); });
  j.with("vfov_degrees", [&](const JsonReader& r) { c.vfovDegrees = r.number(); });
  j.with("aperture_diameter", [&](const JsonReader& r) { c.apertureDiameter = r.number(kNotNegative); });
  j.with("focus_distance", [&](const JsonReader& r) { c.focusDistance = r.number(kPositive); });
  try {
    validateCamera(c);
  } catch (const Error& e) {
    j.fail(e.what());
  }
  return c;
}

} // namespace

SceneDescription parseSceneDescription(const std::string& text, const std::string& file) {
  const nlohmann::json document = parseJson(text, file);
  const JsonReader root(document, file);
  root.requireObject({"meshes", "materials", "instances", "lights", "camera"});
  SceneDescription scene;
  NameIndex meshes, materials;
  root.at("meshes").forEach([&](const JsonReader& j) { scene.meshes.push_back(readMeshEntry(j, meshes)); });
  root.with("materials", [&](const JsonReader& list) {
    list.forEach([&](const JsonReader& j) { scene.materials.push_back(readMaterial(j, materials)); });
  });
  root.at("instances").forEach([&](const JsonReader& j) {
    readInstance(j, meshes, materials, scene.instances);
  });
  if (scene.instances.empty()) root.at("instances").fail("is empty; there is nothing to see");
  root.with("lights",
            [&](const JsonReader& list) { list.forEach([&](const JsonReader& j) { readLight(j, scene); }); });
  root.with("camera", [&](const JsonReader& j) { scene.camera = readCamera(j); });
  return scene;
}

} // namespace chamfer
