#include "server/http/routes/preview_glb.h"

#include "common/error.h"
#include "server/render/scene/scene_data.h"

#include <nlohmann/json.hpp>
#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <sstream>

namespace chamfer::http {
namespace {

/// JSON of one node and of what belongs to one mesh, generously.
constexpr std::size_t kNodeBytes = 512, kMeshBytes = 2048, kMaterialBytes = 512;

/// Axes of an instance that are this far from square make a shear, which a node cannot have: a relative
/// tolerance, that of float32.
constexpr double kSquare = 1e-6;

const SceneMesh& meshOf(const Scene& scene, std::size_t instance) {
  return scene.meshes[scene.data->instanceSource[instance].mesh];
}

bool sheared(const Transform& t) {
  const Vector3 x = t(Vector3(1, 0, 0)), y = t(Vector3(0, 1, 0)), z = t(Vector3(0, 0, 1));
  const auto square = [](const Vector3& a, const Vector3& b) {
    return std::abs(dot(a, b)) <= kSquare * length(a) * length(b);
  };
  return !square(x, y) || !square(y, z) || !square(z, x);
}

/// What positions of a mesh far from its origin are relative to, so that float32 keeps its shape. Zero for
/// the others, whose numbers then stay the file's.
Point3 localOrigin(const TriangleMesh& mesh, const Transform* world) {
  constexpr double kFar = 16; // in diagonals
  Bounds3 bounds;
  for (const Point3& p : mesh.positions)
    bounds.extend(world ? (*world)(p) : p);
  if (bounds.empty()) return {};
  const Point3 centre = bounds.centre();
  const double off = std::max({std::abs(centre.x), std::abs(centre.y), std::abs(centre.z)});
  return off > kFar * bounds.diagonal() ? centre : Point3();
}

std::size_t geometryBytes(const TriangleMesh& mesh) {
  return mesh.positions.size() * 3 * sizeof(float) + mesh.triangles.size() * 3 * sizeof(std::uint32_t);
}

void checkSize(const Scene& scene, std::size_t maxBytes) {
  std::size_t bytes = scene.data->materials.size() * kMaterialBytes + scene.instances.size() * kNodeBytes;
  for (const SceneMesh& mesh : scene.meshes)
    bytes += geometryBytes(*mesh.mesh) + kMeshBytes;
  for (std::size_t i = 0; i < scene.instances.size(); ++i)
    if (sheared(scene.instances[i].worldFromObject))
      bytes += geometryBytes(*meshOf(scene, i).mesh) + kMeshBytes;
  if (bytes > maxBytes)
    throw Error(ErrorKind::OutOfRange, "the preview would have " + std::to_string(bytes) +
                                           " bytes, more than the " + std::to_string(maxBytes) +
                                           " that are made; ask for a small tile instead");
}

class Writer {
public:
  explicit Writer(const Scene& scene) : scene_(scene) {}

  std::string write() {
    model_.asset.version = "2.0";
    model_.asset.generator = "chamferd";
    for (const Material& material : scene_.data->materials)
      addMaterial(material);
    addRoot();
    for (std::size_t i = 0; i < scene_.instances.size(); ++i)
      addInstance(i);
    model_.scenes.resize(1);
    model_.scenes[0].nodes = {0};
    model_.defaultScene = 0;
    if (!bytes_.empty()) model_.buffers.emplace_back().data = std::move(bytes_);
    std::ostringstream out;
    if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&model_, out, false, true))
      throw Error(ErrorKind::Internal, "tinygltf wrote no file");
    return std::move(out).str();
  }

private:
  /// One group of a mesh's triangles with a material of its own; indices.
  struct Part {
    std::size_t begin, count;
    std::uint32_t material;
  };
  struct Geometry {
    Point3 origin; ///< of the positions, in the mesh's frame or the world's
    int positions, indexView;
    std::vector<Part> parts;
    std::size_t indexCount;
  };

  /// Names come from files: what is not UTF-8 is replaced.
  static std::string utf8(const std::string& text) {
    using Json = nlohmann::json;
    return Json::parse(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace)).get<std::string>();
  }

  void addMaterial(const Material& m) {
    tinygltf::Material& material = model_.materials.emplace_back();
    material.name = utf8(m.name);
    material.doubleSided = true; // a scene's sharp meshes need not be closed
    auto& pbr = material.pbrMetallicRoughness;
    pbr.baseColorFactor = {m.baseColor.r, m.baseColor.g, m.baseColor.b, 1};
    pbr.metallicFactor = m.metallic;
    pbr.roughnessFactor = m.roughness;
    // Radiance has no upper limit, the factor's is 1: its colour remains.
    const double strength = std::max({1.0f, m.emission.r, m.emission.g, m.emission.b});
    material.emissiveFactor = {m.emission.r / strength, m.emission.g / strength, m.emission.b / strength};
  }

  void addRoot() {
    const Vector3& up = scene_.camera.up;
    const Vector3 size(std::abs(up.x), std::abs(up.y), std::abs(up.z));
    Vector3 y(0, 0, up.z < 0 ? -1 : 1), x(1, 0, 0);
    if (size.y >= size.x && size.y >= size.z) y = Vector3(0, up.y < 0 ? -1 : 1, 0);
    if (size.x > size.y && size.x >= size.z) {
      y = Vector3(up.x < 0 ? -1 : 1, 0, 0);
      x = Vector3(0, 0, 1);
    }
    const Vector3 z = cross(x, y);
    tinygltf::Node& root = model_.nodes.emplace_back();
    root.name = utf8(scene_.name);
    root.matrix = {x.x, y.x, z.x, 0, x.y, y.y, z.y, 0, x.z, y.z, z.z, 0, 0, 0, 0, 1}; // columns
  }

  void addInstance(std::size_t i) {
    const Transform& t = scene_.instances[i].worldFromObject;
    const InstanceSource& source = scene_.data->instanceSource[i];
    tinygltf::Node node;
    node.name = "instance " + std::to_string(i);
    if (sheared(t)) {
      const Geometry geometry = addGeometry(source.mesh, &t);
      node.mesh = addMesh(geometry, source);
      if (const Point3& o = geometry.origin; !(o == Point3()))
        node.matrix = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, o.x, o.y, o.z, 1};
    } else {
      node.mesh = sharedMesh(source);
      const Vector3 x = t(Vector3(1, 0, 0)), y = t(Vector3(0, 1, 0)), z = t(Vector3(0, 0, 1));
      const Point3 origin = t(geometries_[source.mesh].origin);
      node.matrix = {x.x, x.y, x.z, 0, y.x, y.y, y.z, 0, z.x, z.y, z.z, 0, origin.x, origin.y, origin.z, 1};
    }
    model_.nodes[0].children.push_back(static_cast<int>(model_.nodes.size()));
    model_.nodes.push_back(std::move(node));
  }

  int sharedMesh(const InstanceSource& source) {
    const auto geometry = geometries_.find(source.mesh);
    if (geometry == geometries_.end()) geometries_[source.mesh] = addGeometry(source.mesh, nullptr);
    const auto [entry, added] = meshes_.try_emplace({source.mesh, source.material}, 0);
    if (added) entry->second = addMesh(geometries_[source.mesh], source);
    return entry->second;
  }

  int addMesh(const Geometry& geometry, const InstanceSource& source) {
    tinygltf::Mesh mesh;
    mesh.name = utf8(scene_.meshes[source.mesh].name);
    const auto add = [&](std::size_t begin, std::size_t count, std::uint32_t material) {
      tinygltf::Accessor indices;
      indices.bufferView = geometry.indexView;
      indices.byteOffset = begin * sizeof(std::uint32_t);
      indices.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
      indices.type = TINYGLTF_TYPE_SCALAR;
      indices.count = count;
      tinygltf::Primitive primitive;
      primitive.attributes["POSITION"] = geometry.positions;
      primitive.indices = static_cast<int>(model_.accessors.size());
      primitive.material = static_cast<int>(material);
      primitive.mode = TINYGLTF_MODE_TRIANGLES;
      model_.accessors.push_back(std::move(indices));
      mesh.primitives.push_back(std::move(primitive));
    };
    if (source.material != kNone)
      add(0, geometry.indexCount, source.material);
    else
      for (const Part& part : geometry.parts)
        add(part.begin, part.count, part.material);
    model_.meshes.push_back(std::move(mesh));
    return static_cast<int>(model_.meshes.size()) - 1;
  }

  /// `world`: put the positions there; nullptr: leave them the mesh's.
  Geometry addGeometry(std::uint32_t meshIndex, const Transform* world) {
    const TriangleMesh& mesh = *scene_.meshes[meshIndex].mesh;
    const auto& materials = scene_.data->meshMaterials[meshIndex].ofTriangle;
    const auto materialOf = [&](std::size_t triangle) {
      return materials.empty() ? SceneData::kDefaultMaterial : materials[triangle];
    };
    Geometry geometry;
    geometry.origin = localOrigin(mesh, world);

    tinygltf::Accessor positions;
    positions.minValues = {INFINITY, INFINITY, INFINITY};
    positions.maxValues = {-INFINITY, -INFINITY, -INFINITY};
    std::vector<float> numbers;
    numbers.reserve(mesh.positions.size() * 3);
    for (const Point3& position : mesh.positions) {
      const Vector3 p = (world ? (*world)(position) : position) - geometry.origin;
      const float point[3] = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
      for (std::size_t c = 0; c < 3; ++c) {
        numbers.push_back(point[c]);
        positions.minValues[c] = std::min(positions.minValues[c], double(point[c]));
        positions.maxValues[c] = std::max(positions.maxValues[c], double(point[c]));
      }
    }
    positions.bufferView = addView(numbers, TINYGLTF_TARGET_ARRAY_BUFFER);
    positions.componentType = TINYGLTF_COMPONENT_TYPE_FLOAT;
    positions.type = TINYGLTF_TYPE_VEC3;
    positions.count = mesh.positions.size();
    geometry.positions = static_cast<int>(model_.accessors.size());
    model_.accessors.push_back(std::move(positions));

    std::vector<std::size_t> order(mesh.triangles.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return materialOf(a) < materialOf(b); });
    std::vector<std::uint32_t> indices;
    indices.reserve(order.size() * 3);
    for (const std::size_t triangle : order) {
      if (geometry.parts.empty() || geometry.parts.back().material != materialOf(triangle))
        geometry.parts.push_back({indices.size(), 0, materialOf(triangle)});
      indices.insert(indices.end(), mesh.triangles[triangle].begin(), mesh.triangles[triangle].end());
      geometry.parts.back().count += 3;
    }
    geometry.indexCount = indices.size();
    geometry.indexView = addView(indices, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
    return geometry;
  }

  template <class Number>
  int addView(const std::vector<Number>& numbers, int target) {
    static_assert(sizeof(Number) == 4); // every view stays aligned
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = bytes_.size();
    view.byteLength = numbers.size() * sizeof(Number);
    view.target = target;
    const auto* begin = reinterpret_cast<const unsigned char*>(numbers.data());
    bytes_.insert(bytes_.end(), begin, begin + view.byteLength);
    model_.bufferViews.push_back(std::move(view));
    return static_cast<int>(model_.bufferViews.size()) - 1;
  }

  const Scene& scene_;
  tinygltf::Model model_;
  std::vector<unsigned char> bytes_;
  std::map<std::uint32_t, Geometry> geometries_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> meshes_;
};

} // namespace

std::string previewGlb(const Scene& scene, std::size_t maxBytes) {
  checkSize(scene, maxBytes);
  return Writer(scene).write();
}

} // namespace chamfer::http
