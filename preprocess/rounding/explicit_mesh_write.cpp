#include "common/error.h"
#include "preprocess/rounding/explicit_mesh.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <charconv>
#include <string>

namespace chamfer {
namespace {

/// A half-edge mesh refuses what is not manifold, so building one is the check.
void requireManifold(const ExplicitMesh& mesh) {
  OpenMesh::TriMesh_ArrayKernelT<> m;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    m.add_vertex({0, 0, 0});
  for (const auto& t : mesh.triangles)
    if (!m.add_face(m.vertex_handle(t[0]), m.vertex_handle(t[1]), m.vertex_handle(t[2])).is_valid())
      throw Error(ErrorKind::Internal, "the explicit mesh is not manifold");
}

/// Lines of an OBJ, handed on in blocks.
class ObjLines {
public:
  explicit ObjLines(AtomicFile& file) : file_(file) {}

  void numbers(const char* word, std::initializer_list<double> values) {
    text_ += word;
    for (const double value : values)
      append(value);
    end();
  }
  void textureCoordinates(const std::array<float, 2>& uv) {
    text_ += "vt";
    append(uv[0]);
    append(uv[1]);
    end();
  }
  /// `uv`: kNone at a corner without.
  void face(const std::array<std::uint32_t, 3>& vertices, const std::array<std::uint32_t, 3>& uv) {
    text_ += 'f';
    for (std::size_t k = 0; k < 3; ++k) {
      const std::string vertex = std::to_string(std::uint64_t(vertices[k]) + 1);
      text_ += ' ' + vertex + '/';
      if (uv[k] != kNone) text_ += std::to_string(std::uint64_t(uv[k]) + 1);
      text_ += '/' + vertex;
    }
    end();
  }
  void flush() {
    file_.write(std::as_bytes(std::span(text_)));
    text_.clear();
  }

private:
  template <class Number>
  void append(Number value) { // the shortest text that gives the same number
    char digits[32];
    text_ += ' ';
    text_.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
  }
  void end() {
    text_ += '\n';
    if (text_.size() > (1u << 20)) flush();
  }

  AtomicFile& file_;
  std::string text_;
};

} // namespace

void writeExplicitMesh(AtomicFile& file, const ExplicitMesh& mesh) {
  requireManifold(mesh);
  ObjLines lines(file);
  for (const Point3& p : mesh.positions)
    lines.numbers("v", {p.x, p.y, p.z});
  for (const auto& uv : mesh.uvs)
    lines.textureCoordinates(uv);
  for (const Vector3& n : mesh.normals)
    lines.numbers("vn", {n.x, n.y, n.z});
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    lines.face(mesh.triangles[t], mesh.uvTriangles.empty() ? std::array<std::uint32_t, 3>{kNone, kNone, kNone}
                                                           : mesh.uvTriangles[t]);
  lines.flush();
}

} // namespace chamfer
