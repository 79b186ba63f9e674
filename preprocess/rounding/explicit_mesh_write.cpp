#include "common/error.h"
#include "preprocess/rounding/explicit_mesh.h"

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/System/omstream.hh>
#include <cstdlib>
#include <string>

namespace chamfer {
namespace {

struct DoubleTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};
using HalfEdgeMesh = OpenMesh::TriMesh_ArrayKernelT<DoubleTraits>;

/// A half-edge mesh of it; refuses what is not manifold, so building one is the check.
HalfEdgeMesh halfEdgeMesh(const ExplicitMesh& mesh) {
  HalfEdgeMesh m;
  m.request_vertex_normals();
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Point3& p = mesh.positions[i];
    const Vector3& n = mesh.normals[i];
    const auto v = m.add_vertex({p.x, p.y, p.z});
    m.set_normal(v, {n.x, n.y, n.z});
  }
  for (const auto& t : mesh.triangles) {
    const auto face = m.add_face(m.vertex_handle(t[0]), m.vertex_handle(t[1]), m.vertex_handle(t[2]));
    if (!face.is_valid()) throw Error(ErrorKind::Internal, "the explicit mesh is not manifold");
  }
  return m;
}

} // namespace

void writeExplicitMesh(const AtomicFile& file, const ExplicitMesh& mesh) {
  const HalfEdgeMesh m = halfEdgeMesh(mesh);
  OpenMesh::IO::Options options = OpenMesh::IO::Options::VertexNormal;
  bool written = false;
  ::omlog().disable(); // the library reports to standard error, success included
  ::omerr().disable();
  try {
    written = OpenMesh::IO::write_mesh(m, file.temporary().string(), options, 17);
  } catch (const std::exception&) {
    written = false; // the library's words would not help
  }
  if (!written)
    throw Error(ErrorKind::CannotWrite, "cannot write the explicit mesh " + file.target().string() +
                                            ": check that its name ends in .obj and that the disk has room");
}

} // namespace chamfer
