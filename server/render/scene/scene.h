// A scene as loaded from disk: meshes, materials, instances, lights, camera. Immutable; its id is the digest
// of everything that determines its pixels. Which rounding is used is chosen per request (render.h).
#pragma once

#include "common/digest.h"
#include "common/sidecar.h"
#include "common/transform.h"
#include "preprocess/mesh.h"
#include "preprocess/preprocess.h"
#include "server/render/image/color.h"
#include "server/render/tracing/tracer.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace chamfer {

/// Pinhole or thin-lens camera. World units; `up` need not be orthogonal to the view.
struct Camera {
  Point3 eye{0, -5, 0};
  Point3 target{0, 0, 0};
  Vector3 up{0, 0, 1};
  double vfovDegrees = 40;
  double apertureDiameter = 0; ///< 0: pinhole
  double focusDistance = 0;    ///< 0: distance to target
};

struct SceneMesh {
  std::string name;
  std::filesystem::path file;
  std::shared_ptr<const TriangleMesh> mesh;
  std::shared_ptr<const TracedMesh> traced;
  /// Null: sharp until a radius is asked for, or for good.
  std::shared_ptr<const Rounding> rounding;
  bool staysSharp = false; ///< a floor, a light: no radius ever rounds it
  /// How it was rounded, and is to be with another radius; radius 0: it has none.
  RoundingOptions options;
  /// World units of one mesh unit where the scene file gives the radius in world units, else 1: what requests
  /// name, and what follows here, are multiples of it.
  double radiusUnit = 1;
  double radius = 0; ///< the largest radius in `rounding`; 0 when sharp
  /// The radius that it must stay below: the smallest inradius, or where each solid's radius is clamped the
  /// largest. 0 when it stays sharp or cannot be rounded.
  double maxRadius = 0;
};

/// Which axis of a mesh file points up.
enum class UpAxis : std::uint8_t { Y, Z };

struct SceneData; // materials, lights, textures: the renderer's own (scene_data.h)

struct Scene {
  std::string name; ///< path below the served root without extension, '/' between folders
  Digest id;
  std::vector<SceneMesh> meshes;
  std::vector<TracedInstance> instances;       ///< with each mesh's own rounding; the scene's own, no studio
  Camera camera;                               ///< the file's, or one fitted to the bounds
  Bounds3 bounds;                              ///< of the scene's own instances
  std::size_t triangles = 0, roundedEdges = 0; ///< over all instances
  std::vector<std::string> warnings;
  /// Every file that was read or looked for (a sidecar or a texture that is not there, too): when one
  /// changes, the scene may be another.
  std::vector<std::filesystem::path> files;
  std::shared_ptr<const SceneData> data;
  /// Of a bare mesh: the axis of its file that is up here. Nothing: a scene file says it of each mesh.
  std::optional<UpAxis> meshUp;
  /// The same mesh in its studio with its other axis up; it shares all that is large. Null in that one.
  std::shared_ptr<const Scene> otherUp;
  Digest otherUpId; ///< of the scene with the other axis up, in both
};

/// Of everything that the scene holds, `otherUp` with it: meshes with their hierarchies, roundings, textures.
/// Each counted once.
std::size_t memoryBytes(const Scene& scene);

/// Turns what is y-up upright: y to z, z to -y.
Transform uprightFrom(UpAxis up);

/// Loads `*.scene.json`, or a mesh with its sidecar beside it (`MESH.chamfer`), which gets a neutral studio:
/// ground, sky, area light, fitted camera. Throws Error with the key's path or the file's fault;
/// StaleSidecar, DamagedSidecar. `root`: files may be named only below it. `meshUp`: of such a bare mesh; a
/// scene file says it of each of its meshes.
std::shared_ptr<const Scene> loadScene(const std::filesystem::path& file, const std::filesystem::path& root,
                                       const std::string& name, UpAxis meshUp = UpAxis::Z);

} // namespace chamfer
