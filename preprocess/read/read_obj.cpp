// OBJ: checked by our own scan (read_obj_scan.h says why), then read by tinyobjloader.
#include "common/error.h"
#include "common/rounding.h"
#include "preprocess/read/read_formats.h"
#include "preprocess/read/read_mtl.h"
#include "preprocess/read/read_obj_scan.h"

#include <tiny_obj_loader.h>

#include <optional>
#include <sstream>

namespace chamfer {
namespace {

/// Takes what tinyobjloader reports, statement by statement, and resolves it against the scan.
class Assembler {
public:
  Assembler(ObjScan scan, const MaterialTable& table, std::string_view name)
      : scan_(std::move(scan)), table_(table), name_(name) {}

  TriangleMesh run(std::string text) {
    std::istringstream stream(std::move(text));
    tinyobj::callback_t callbacks;
    callbacks.index_cb = [](void* self, tinyobj::index_t* corners, int count) {
      static_cast<Assembler*>(self)->face({corners, std::size_t(count)});
    };
    callbacks.usemtl_cb = [](void* self, const char* name, int) {
      static_cast<Assembler*>(self)->useMaterial(name);
    };
    std::string warning, error;
    if (!tinyobj::LoadObjWithCallback(stream, callbacks, this, nullptr, &warning, &error))
      malformed({name_}, "tinyobjloader: " + error);
    if (faces_ != scan_.lineOfFace.size())
      throw Error(ErrorKind::Internal, "tinyobjloader saw other faces than the scan of the file");
    mesh_.positions = std::move(scan_.positions);
    mesh_.lineOfFace = std::move(scan_.lineOfFace);
    if (anyUv_)
      mesh_.uvs = std::move(scan_.uvs);
    else
      mesh_.uvTriangles.clear();
    if (!anyMaterial_) mesh_.materialOfTriangle.clear();
    if (strayUvs_ > 0)
      mesh_.warnings.push_back("line " + std::to_string(firstStrayUv_) + ": " + std::to_string(strayUvs_) +
                               " corners from here on name texture coordinates that the file does not have");
    return std::move(mesh_);
  }

private:
  void face(std::span<const tinyobj::index_t> corners) {
    corners_.clear();
    uvs_.clear();
    for (const tinyobj::index_t& corner : corners) {
      corners_.push_back(vertex(corner.vertex_index));
      const auto uv = resolve(corner.texcoord_index, scan_.above[faces_][1], scan_.uvs.size());
      if (corner.texcoord_index != 0 && !uv && strayUvs_++ == 0) firstStrayUv_ = scan_.lineOfFace[faces_];
      uvs_.push_back(uv.value_or(kNone));
      anyUv_ = anyUv_ || uv;
    }
    appendPolygon(mesh_, faces_++, corners_, uvs_);
    mesh_.materialOfTriangle.resize(mesh_.triangles.size(), material_);
    anyMaterial_ = anyMaterial_ || material_ != kNone;
  }

  /// 0-based index from the file's: counted from 1, or back from the face when negative; nothing when out of
  /// range.
  static std::optional<std::uint32_t> resolve(int index, std::uint32_t above, std::size_t count) {
    const std::int64_t resolved = index > 0 ? std::int64_t(index) - 1 : std::int64_t(above) + index;
    if (index == 0 || resolved < 0 || resolved >= std::int64_t(count)) return std::nullopt;
    return std::uint32_t(resolved);
  }

  std::uint32_t vertex(int index) const {
    const std::uint32_t above = scan_.above[faces_][0];
    if (const auto resolved = resolve(index, above, scan_.positions.size())) return *resolved;
    const std::string backwards = index < 0 ? ", " + std::to_string(above) + " of them above this line" : "";
    malformed({name_, scan_.lineOfFace[faces_]},
              "vertex index " + std::to_string(index) + " is out of range: the file has " +
                  std::to_string(scan_.positions.size()) + " vertices" + backwards);
  }

  void useMaterial(std::string_view name) {
    const std::size_t last = name.find_last_not_of(" \t\r");
    const auto found = table_.index.find(name.substr(0, last == std::string_view::npos ? 0 : last + 1));
    material_ = found == table_.index.end() ? kNone : found->second;
  }

  ObjScan scan_;
  const MaterialTable& table_;
  std::string_view name_;
  TriangleMesh mesh_;
  std::vector<std::uint32_t> corners_, uvs_;
  std::uint32_t faces_ = 0, material_ = kNone, firstStrayUv_ = 0;
  std::size_t strayUvs_ = 0;
  bool anyUv_ = false, anyMaterial_ = false;
};

} // namespace

TriangleMesh readObj(std::string text, const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  ObjScan scan = scanObj(text, name);
  std::vector<std::string> warnings = std::move(scan.warnings);
  MaterialTable table;
  for (const std::string& line : scan.libraries)
    readMaterialLibraries(line, path.parent_path(), table);
  TriangleMesh mesh = Assembler(std::move(scan), table, name).run(std::move(text));
  checkSize(mesh, {name});
  mesh.materials = std::move(table.materials);
  mesh.materialFiles = std::move(table.files);
  mesh.warnings.insert(mesh.warnings.end(), warnings.begin(), warnings.end());
  mesh.warnings.insert(mesh.warnings.end(), table.warnings.begin(), table.warnings.end());
  return mesh;
}

} // namespace chamfer
