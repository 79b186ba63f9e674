// From files to an immutable Scene: description, meshes, materials with their textures, lights, camera, id.
#include "preprocess/read/find_file.h"
#include "server/render/image/image_io.h"
#include "server/render/path/camera.h"
#include "server/render/scene/mesh_library.h"
#include "server/render/scene/scene_data.h"
#include "server/render/scene/scene_description.h"
#include "server/render/scene/scene_files.h"
#include "server/render/scene/studio.h"
#include "server/render/surface/tangent_frame.h"

#include "common/error.h"
#include "common/text.h"

#include <map>

namespace chamfer {
namespace {

namespace fs = std::filesystem;

/// Part of every scene's id: to be changed whenever the same files give other pixels than before.
constexpr char kRendererVersion[] = "chamfer renderer 6";
constexpr char kNoNormals[] = "does not hold tangent-space normals: it looks like a height map";
constexpr std::size_t kMostWarnings = 100;
constexpr std::uintmax_t kLargestSceneFile = 256u << 20;

class SceneLoader {
public:
  SceneLoader(const fs::path& root, const fs::path& base, const std::string& name)
      : root_(root), base_(base), meshes_(root, base) {
    scene_->name = name;
    identity_ = kRendererVersion;
    Material neutral;
    neutral.name = "default";
    neutral.roughness = 0.35f;
    neutral.baseColor = {0.6f, 0.6f, 0.6f};
    data_->materials.push_back(neutral);
  }

  std::shared_ptr<const Scene> fromDescription(const std::string& text, const std::string& file) {
    const SceneDescription d = parseSceneDescription(text, file);
    identity_ += text;
    try {
      std::vector<std::uint32_t> meshes; // into the scene's; kNone: one for each stretch of its instances
      for (const MeshDescription& m : d.meshes)
        at(m.path, [&] { meshes.push_back(m.worldRadius ? kNone : addMesh(m)); });
      const auto materials = std::uint32_t(data_->materials.size());
      for (const MaterialDescription& m : d.materials)
        at(m.path, [&] { addMaterial(m); });
      scene_->instances.reserve(d.instances.size());
      data_->instanceSource.reserve(d.instances.size());
      for (const InstanceDescription& i : d.instances) {
        const MeshDescription& mesh = d.meshes[i.mesh];
        const std::uint32_t material = i.material == kNone ? kNone : materials + i.material;
        const Transform worldFromMesh =
            mesh.up == UpAxis::Z ? i.worldFromObject : i.worldFromObject * uprightFrom(mesh.up);
        if (mesh.worldRadius)
          at(mesh.path, [&] { addStretchedInstance(mesh, i.mesh, material, worldFromMesh); });
        else
          addInstance(meshes[i.mesh], material, worldFromMesh);
      }
      for (std::uint32_t i = 0; i < d.meshes.size(); ++i) // not placed, and yet to be right
        if (d.meshes[i].worldRadius && !stretched_.contains(i))
          at(d.meshes[i].path, [&] { addMesh(d.meshes[i]); });
      checkCoordinates(scene_->instances, [this](std::size_t k) { return nameOfInstance(k); });
      addLights(d);
      checkCoordinates(data_->extraInstances,
                       [](std::size_t k) { return "area light " + std::to_string(k); });
    } catch (const Error& e) {
      throw Error(e.kind(), file + ": " + e.what());
    }
    return finish(d.camera);
  }

  std::shared_ptr<const Scene> fromMesh(const std::string& file, UpAxis up) {
    MeshDescription d;
    d.name = fs::path(file).stem().string();
    d.file = file;
    addMesh(d);
    if (!scene_->meshes[0].rounding)
      scene_->warnings.push_back(
          "there is no sidecar beside the mesh: it stays sharp until a radius is given");
    // Both ways up: what is large is shared.
    const Scene bare = *scene_;
    const SceneData bareData = *data_;
    const std::string content = identity_;
    const auto inStudio = [&](UpAxis axis) {
      scene_ = std::make_shared<Scene>(bare);
      data_ = std::make_shared<SceneData>(bareData);
      identity_ = content + (axis == UpAxis::Y ? "studio, y up" : "studio");
      scene_->meshUp = axis;
      addInstance(0, kNone, uprightFrom(axis));
      checkCoordinates(scene_->instances, [&](std::size_t) { return fileInQuotes(file); });
      addStudio(*data_, scene_->meshes.size(), scene_->bounds);
      finish({});
      return scene_;
    };
    const std::shared_ptr<Scene> other = inStudio(up == UpAxis::Y ? UpAxis::Z : UpAxis::Y),
                                 own = inStudio(up);
    other->otherUpId = own->id;
    own->otherUpId = other->id;
    own->otherUp = other;
    return own;
  }

  /// As resolveBelow(); a file that is not there yet is remembered too.
  fs::path resolve(const fs::path& folder, const std::string& name) {
    try {
      const fs::path file = resolveBelow(root_, folder, name);
      addFile(file);
      return file;
    } catch (const Error& e) {
      if (e.kind() == ErrorKind::NotFound) addFile(folder / name);
      throw;
    }
  }

private:
  void addFile(const fs::path& file) {
    if (std::find(scene_->files.begin(), scene_->files.end(), file) == scene_->files.end())
      scene_->files.push_back(file);
  }

  /// Adds the path of an entry to errors that do not know it.
  template <class F>
  void at(const std::string& path, F&& f) {
    try {
      f();
    } catch (const Error& e) {
      throw Error(e.kind(), path + ": " + e.what());
    }
  }

  /// Returns its place among the scene's meshes. `materialsOf`: a mesh of the same file that is there
  /// already.
  std::uint32_t addMesh(const MeshDescription& d, const Stretch& stretch = {},
                        std::uint32_t materialsOf = kNone) {
    std::vector<std::string> warnings;
    LoadedMesh loaded = meshes_.load(d, warnings, stretch);
    for (const std::string& w : warnings) // copies of one mesh have the same
      if (std::find(scene_->warnings.begin(), scene_->warnings.end(), w) == scene_->warnings.end())
        scene_->warnings.push_back(w);
    addFile(loaded.mesh.file);
    addFile(sidecarOf(loaded.mesh.file));
    for (const fs::path& library : loaded.mesh.mesh->materialFiles)
      addFile(library);
    identity_ += loaded.content.hex();
    Bounds3 bounds;
    for (const auto& triangle : loaded.mesh.mesh->triangles)
      for (const std::uint32_t corner : triangle)
        bounds.extend(loaded.mesh.mesh->positions[corner]);
    meshBounds_.push_back(bounds);
    meshEdges_.push_back(loaded.roundedEdges);
    MeshMaterials materials;
    const TriangleMesh& mesh = *loaded.mesh.mesh;
    if (materialsOf != kNone) {
      materials = data_->meshMaterials[materialsOf];
    } else if (!mesh.materialOfTriangle.empty()) {
      const auto first = std::uint32_t(data_->materials.size());
      const fs::path folder = loaded.mesh.file.parent_path();
      for (const MeshMaterial& m : mesh.materials)
        addMeshMaterial(m, folder);
      for (const std::uint32_t m : mesh.materialOfTriangle)
        materials.ofTriangle.push_back(m == kNone ? SceneData::kDefaultMaterial : first + m);
      for (const std::uint32_t m : materials.ofTriangle)
        materials.transmits = materials.transmits || data_->materials[m].transmission > 0;
    }
    data_->meshMaterials.push_back(std::move(materials));
    scene_->meshes.push_back(std::move(loaded.mesh));
    return std::uint32_t(scene_->meshes.size() - 1);
  }

  /// Of a mesh whose radius is in world units: its instances share a rounding where they stretch it alike.
  void addStretchedInstance(const MeshDescription& d, std::uint32_t description, std::uint32_t material,
                            const Transform& worldFromMesh) {
    const Stretch stretch = stretchOf(worldFromMesh);
    std::map<Stretch, std::uint32_t>& meshes = stretched_[description];
    const auto found = meshes.find(stretch);
    const std::uint32_t mesh = found != meshes.end()
                                   ? found->second
                                   : addMesh(d, stretch, meshes.empty() ? kNone : meshes.begin()->second);
    if (found == meshes.end()) meshes.emplace(stretch, mesh);
    addInstance(mesh, material,
                stretch.isUniform() ? worldFromMesh : worldFromMesh * stretch.transform().inverse());
  }

  /// A material of an MTL library. What a scene file would be refused for is taken into its limits here,
  /// since such files come from elsewhere; a texture that cannot be read becomes a warning.
  void addMeshMaterial(const MeshMaterial& m, const fs::path& folder) {
    const auto unit = [](double v) { return float(std::clamp(v, 0.0, 1.0)); };
    Material material;
    material.name = m.name;
    material.baseColor = {unit(m.baseColor[0]), unit(m.baseColor[1]), unit(m.baseColor[2])};
    material.roughness = unit(m.roughness);
    material.metallic = unit(m.metallic);
    material.transmission = unit(m.transmission);
    material.ior = float(std::clamp(m.ior, 1.0, 4.0));
    const auto light = [](double v) { return float(std::clamp(v, 0.0, 1e9)); };
    material.emission = {light(m.emission[0]), light(m.emission[1]), light(m.emission[2])};
    const auto texture = [&](const MeshTexture& t, PixelEncoding encoding) {
      try {
        return t.file.empty() ? kNoTexture : addMeshTexture(t, folder, encoding);
      } catch (const Error& e) {
        scene_->warnings.push_back(t.place + ": material " + inQuotes(m.name) + ": " + e.what());
        return kNoTexture;
      }
    };
    material.baseColorTexture = texture(m.baseColorTexture, PixelEncoding::Automatic);
    material.roughnessTexture = texture(m.roughnessTexture, PixelEncoding::Linear);
    material.normalTexture = texture(m.normalTexture, PixelEncoding::Linear);
    material.normalStrength = float(m.normalTexture.strength);
    if (material.normalTexture != kNoTexture && !holdsNormals(data_->textures[material.normalTexture])) {
      scene_->warnings.push_back(m.normalTexture.place + ": material " + inQuotes(m.name) + ": " +
                                 fileInQuotes(m.normalTexture.file) + " " + kNoNormals + "; it is not used");
      material.normalTexture = kNoTexture;
    }
    data_->materials.push_back(material);
  }

  void addMaterial(const MaterialDescription& d) {
    Material material = d.material;
    if (!d.baseColorTexture.empty())
      material.baseColorTexture = addTexture(base_, d.baseColorTexture, PixelEncoding::Automatic);
    if (!d.roughnessTexture.empty())
      material.roughnessTexture = addTexture(base_, d.roughnessTexture, PixelEncoding::Linear);
    if (!d.normalTexture.empty()) {
      material.normalTexture = addTexture(base_, d.normalTexture, PixelEncoding::Linear);
      if (!holdsNormals(data_->textures[material.normalTexture]))
        throw Error(ErrorKind::Malformed, "normal_texture: " + d.normalTexture + " " + kNoNormals);
    }
    data_->materials.push_back(material);
  }

  std::uint32_t addTexture(const fs::path& folder, const std::string& name, PixelEncoding encoding) {
    return addImage(resolve(folder, name), name, encoding, {});
  }

  /// An image is read once, however often it is placed.
  std::uint32_t addImage(const fs::path& path, const std::string& name, PixelEncoding encoding,
                         const TexturePlacement& placement) {
    const fs::path file = fs::canonical(path);
    addFile(file);
    auto& placements = textures_[{file, encoding}];
    if (const auto known = placements.find(placement); known != placements.end()) return known->second;
    const auto index = std::uint32_t(data_->textures.size());
    data_->textures.push_back(
        (placements.empty() ? readImage(file, encoding, name) : data_->textures[placements.begin()->second])
            .placed(placement));
    return placements[placement] = index;
  }

  /// A texture that a material library names, found as findFile() finds it, with a warning where it is not
  /// where it is said to be. Throws Error(NotFound) and what readTexture() throws.
  std::uint32_t addMeshTexture(const MeshTexture& t, const fs::path& meshFolder, PixelEncoding encoding) {
    const auto found = findFile(t.file, {t.folder, meshFolder}, root_);
    if (const fs::path named = namedPlace(t.file, t.folder, root_); !named.empty()) addFile(named);
    if (!found)
      throw Error(ErrorKind::NotFound,
                  fileInQuotes(t.file) + ": there is no such file below the served folder");
    if (!found->instead.empty())
      scene_->warnings.push_back(t.place + ": " + fileInQuotes(t.file) + " is not there; " +
                                 fileInQuotes(found->instead) + " is used");
    const auto narrow = [](const std::array<double, 2>& v) { return std::array{float(v[0]), float(v[1])}; };
    return addImage(found->file, t.file, encoding, {narrow(t.scale), narrow(t.offset), t.clamp});
  }

  Texture readImage(const fs::path& file, PixelEncoding encoding, const std::string& name) {
    Texture texture = readTexture(file, encoding, name, scene_->warnings);
    identity_ += texture.contentDigest().hex();
    return texture;
  }

  void addInstance(std::uint32_t mesh, std::uint32_t material, const Transform& worldFromObject) {
    const SceneMesh& m = scene_->meshes[mesh];
    scene_->instances.push_back({m.traced, m.rounding, worldFromObject});
    data_->instanceSource.push_back({mesh, material});
    scene_->triangles += m.mesh->triangles.size();
    scene_->roundedEdges += meshEdges_[mesh];
    const Bounds3& b = meshBounds_[mesh];
    if (b.empty()) return;
    for (unsigned corner = 0; corner < 8; ++corner) {
      const Point3 p{corner & 1 ? b.upper.x : b.lower.x, corner & 2 ? b.upper.y : b.lower.y,
                     corner & 4 ? b.upper.z : b.lower.z};
      scene_->bounds.extend(worldFromObject(p));
    }
  }

  /// By the scene's list of instances, which repeats make longer than the file's.
  std::string nameOfInstance(std::size_t k) const {
    return "instance " + std::to_string(k) + " (mesh " +
           inQuotes(scene_->meshes[data_->instanceSource[k].mesh].name) + ")";
  }

  void addLights(const SceneDescription& d) {
    for (std::size_t i = 0; i < d.pointLights.size(); ++i)
      if (!(length(Vector3(d.pointLights[i].position)) <= kLargestCoordinate))
        throw Error(ErrorKind::OutOfRange, "point light " + std::to_string(i) + " is farther than " +
                                               numberText(kLargestCoordinate) +
                                               " from the origin: take a directional light");
    for (std::size_t i = 0; i < d.areaLights.size(); ++i) {
      const AreaLightDescription& a = d.areaLights[i];
      Material material;
      material.baseColor = {};
      material.specular = 0;
      material.emission = a.emission;
      addQuad(*data_, scene_->meshes.size(), "area light " + std::to_string(i), a.centre, a.u, a.v, material);
    }
    data_->distantLights = d.distantLights;
    data_->pointLights = d.pointLights;
    const EnvironmentDescription e = d.environment.value_or(EnvironmentDescription{});
    Environment environment = Environment::sky(d.environment ? e.sky : neutralSky(), e.up);
    if (e.kind == EnvironmentDescription::Kind::Constant) environment = Environment::constant(e.sky.zenith);
    if (e.kind == EnvironmentDescription::Kind::Image)
      at(e.path, [&] {
        const fs::path file = resolve(base_, e.image);
        auto image = std::make_shared<Texture>(readImage(file, PixelEncoding::Automatic, e.image));
        environment = Environment::image(std::move(image), e.strength, e.rotationDegrees, e.up);
      });
    data_->environment = std::make_shared<Environment>(std::move(environment));
  }

  std::shared_ptr<const Scene> finish(const std::optional<Camera>& camera) {
    keepFirst(scene_->warnings, kMostWarnings);
    scene_->camera = camera ? *camera : fitCamera(scene_->bounds);
    scene_->id = digestOf(identity_);
    scene_->data = data_;
    return scene_;
  }

  fs::path root_, base_;
  MeshLibrary meshes_;
  std::shared_ptr<Scene> scene_ = std::make_shared<Scene>();
  std::shared_ptr<SceneData> data_ = std::make_shared<SceneData>();
  std::string identity_; ///< everything that determines the pixels, or its digests
  std::vector<Bounds3> meshBounds_;
  std::vector<std::size_t> meshEdges_;
  std::map<std::pair<fs::path, PixelEncoding>, std::map<TexturePlacement, std::uint32_t>> textures_;
  /// Meshes with a radius in world units, by description: the scene's mesh for each stretch.
  std::map<std::uint32_t, std::map<Stretch, std::uint32_t>> stretched_;
};

} // namespace

Transform uprightFrom(UpAxis up) {
  if (up == UpAxis::Z) return {};
  return Transform(std::array<std::array<double, 4>, 3>{{{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}}});
}

std::shared_ptr<const Scene> loadScene(const fs::path& file, const fs::path& root, const std::string& name,
                                       UpAxis meshUp) {
  const std::string leaf = file.filename().string();
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  const fs::path top = root.empty() ? folder : root;
  SceneLoader loader(top, folder, name);
  if (!leaf.ends_with(".json")) return loader.fromMesh(leaf, meshUp);
  return loader.fromDescription(readFileText(loader.resolve(folder, leaf), kLargestSceneFile), leaf);
}

} // namespace chamfer
