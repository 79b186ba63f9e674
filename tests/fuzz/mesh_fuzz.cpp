// Mesh files: any bytes are refused as malformed, or are a mesh whose indices are in range, whose numbers are
// finite, and which reads back as itself when it is written as OBJ; and what is said of them is printable.
// The first byte chooses the format. An OBJ may carry its material library behind a line "#MTL".
#include "common/error.h"
#include "common/rounding.h"
#include "preprocess/read/read_formats.h"
#include "tests/fuzz/require.h"
#include "tests/support/obj_text.h"

#include <cmath>
#include <fstream>

namespace {

namespace fs = std::filesystem;
using chamfer::TriangleMesh;

/// An empty folder for the run, in which an OBJ looks for its materials.
const fs::path& folder() {
  struct Folder {
    Folder() {
      std::string pattern = (fs::temp_directory_path() / "chamfer-fuzz-XXXXXX").string();
      REQUIRE(::mkdtemp(pattern.data()));
      path = pattern;
    }
    ~Folder() { fs::remove_all(path); }
    fs::path path;
  };
  static const Folder folder;
  return folder.path;
}

TriangleMesh readObj(std::string_view text) {
  constexpr std::string_view kMark = "\n#MTL\n";
  if (const std::size_t mark = text.find(kMark); mark != std::string_view::npos) {
    std::ofstream(folder() / "a.mtl", std::ios::binary) << text.substr(mark + kMark.size());
    text = text.substr(0, mark);
  }
  return chamfer::readObj(std::string(text), folder() / "fuzz.obj");
}

TriangleMesh read(unsigned format, std::string_view bytes) {
  switch (format % 4) {
  case 0:
    return readObj(bytes);
  case 1:
    return chamfer::readStl(bytes, "fuzz.stl");
  case 2:
    return chamfer::readPly(bytes, "fuzz.ply");
  default:
    return chamfer::readOff(bytes, "fuzz.off");
  }
}

bool isPrintable(const std::string& message) {
  return chamfer::printable(message, message.size()) == message;
}

void check(const TriangleMesh& mesh) {
  for (const chamfer::Point3& p : mesh.positions)
    REQUIRE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle)
      REQUIRE(corner < mesh.positions.size());
  REQUIRE(mesh.faceOfTriangle.size() == mesh.triangles.size());
  for (const std::uint32_t face : mesh.faceOfTriangle)
    REQUIRE(mesh.lineOfFace.empty() || face < mesh.lineOfFace.size());
  for (const auto& uv : mesh.uvs)
    REQUIRE(std::isfinite(uv[0]) && std::isfinite(uv[1]));
  REQUIRE(mesh.uvs.empty() == mesh.uvTriangles.empty());
  REQUIRE(mesh.uvTriangles.empty() || mesh.uvTriangles.size() == mesh.triangles.size());
  for (const auto& triangle : mesh.uvTriangles)
    for (const std::uint32_t corner : triangle)
      REQUIRE(corner == chamfer::kNone || corner < mesh.uvs.size());
  REQUIRE(mesh.materialOfTriangle.empty() || mesh.materialOfTriangle.size() == mesh.triangles.size());
  for (const std::uint32_t material : mesh.materialOfTriangle)
    REQUIRE(material == chamfer::kNone || material < mesh.materials.size());
  for (const chamfer::MeshMaterial& m : mesh.materials) {
    for (std::size_t i = 0; i < 3; ++i)
      REQUIRE(m.baseColor[i] >= 0 && m.baseColor[i] <= 1 && m.emission[i] >= 0 &&
              std::isfinite(m.emission[i]));
    for (const double share : {m.roughness, m.metallic, m.transmission})
      REQUIRE(share >= 0 && share <= 1);
    REQUIRE(m.ior >= 1 && m.ior <= 4);
    for (const chamfer::MeshTexture* t : {&m.baseColorTexture, &m.roughnessTexture, &m.normalTexture})
      for (const double number : {t->scale[0], t->scale[1], t->offset[0], t->offset[1], t->strength})
        REQUIRE(std::isfinite(number));
  }
  REQUIRE(mesh.warnings.size() <= chamfer::ReadWarnings::kMost + 1);
  for (const std::string& warning : mesh.warnings)
    REQUIRE(isPrintable(warning));
  REQUIRE(sameShape(chamfer::readObj(chamfer::objText(mesh), folder() / "again.obj"), mesh));
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  try {
    check(read(data[0], {reinterpret_cast<const char*>(data) + 1, size - 1}));
  } catch (const chamfer::Error& error) {
    REQUIRE(error.kind() == chamfer::ErrorKind::Malformed);
    REQUIRE(isPrintable(error.what()));
  }
  return 0;
}
