// A scene file's content, read and checked but nothing loaded: data/SCENES.md describes the format.
#pragma once

#include "common/transform.h"
#include "preprocess/preprocess.h"
#include "server/render/light/environment.h"
#include "server/render/light/light_sources.h"
#include "server/render/material/material.h"
#include "server/render/scene/scene.h"

#include <optional>
#include <string>
#include <vector>

namespace chamfer {

struct MeshDescription {
  std::string name, file;
  std::optional<Radius> radius; ///< nothing: the sidecar's, or sharp where there is none
  bool worldRadius = false;     ///< the radius is in world units
  bool staysSharp = false;      ///< "rounding": false
  /// Nothing: the sidecar's, or the default where there is none.
  std::optional<OnNonConvex> onNonConvex;
  std::optional<double> radiusClamp;
  UpAxis up = UpAxis::Z;
  std::string path; ///< of the entry, for messages
};

struct MaterialDescription {
  Material material;                                             ///< its textures are not set
  std::string baseColorTexture, roughnessTexture, normalTexture; ///< files; empty: none
  std::string path;
};

struct InstanceDescription {
  std::uint32_t mesh = 0;
  std::uint32_t material = kNone; ///< kNone: the mesh's own
  Transform worldFromObject;
};

/// A parallelogram that emits from both sides: corners centre +- u +- v.
struct AreaLightDescription {
  Point3 centre;
  Vector3 u, v;
  Color emission; ///< radiance
};

struct EnvironmentDescription {
  enum class Kind { Constant, Sky, Image } kind = Kind::Sky;
  SkyGradient sky;   ///< Constant: all three alike
  std::string image; ///< file
  float strength = 1;
  double rotationDegrees = 0;
  Vector3 up{0, 0, 1};
  std::string path;
};

struct SceneDescription {
  std::vector<MeshDescription> meshes;
  std::vector<MaterialDescription> materials;
  std::vector<InstanceDescription> instances;
  std::vector<AreaLightDescription> areaLights;
  std::vector<DistantLight> distantLights;
  std::vector<PointLight> pointLights;
  std::optional<EnvironmentDescription> environment;
  std::optional<Camera> camera;
};

/// Throws Error(Malformed) that names `file` and the key's path.
SceneDescription parseSceneDescription(const std::string& text, const std::string& file);

} // namespace chamfer
