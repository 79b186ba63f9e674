// A mesh as OBJ text that reads back as the same mesh, and the question whether it does.
#pragma once

#include "common/rounding.h"
#include "preprocess/mesh.h"

#include <charconv>
#include <string>

namespace chamfer {

/// Positions, texture coordinates and triangles; every number in the fewest digits that give it back.
inline std::string objText(const TriangleMesh& mesh) {
  std::string text;
  const auto number = [&](auto value) {
    char digits[40];
    text.append(1, ' ').append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
  };
  for (const Point3& p : mesh.positions) {
    text += 'v';
    for (const double c : {p.x, p.y, p.z})
      number(c);
    text += '\n';
  }
  for (const auto& uv : mesh.uvs) {
    text += "vt";
    for (const float c : uv)
      number(c);
    text += '\n';
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    text += 'f';
    for (std::size_t k = 0; k < 3; ++k) {
      number(mesh.triangles[t][k] + 1);
      if (!mesh.uvTriangles.empty() && mesh.uvTriangles[t][k] != kNone)
        text += '/' + std::to_string(mesh.uvTriangles[t][k] + 1);
    }
    text += '\n';
  }
  return text;
}

/// The same shape with the same texture coordinates; a mesh without triangles has none of the latter.
inline bool sameShape(const TriangleMesh& a, const TriangleMesh& b) {
  return a.positions == b.positions && a.triangles == b.triangles && a.uvTriangles == b.uvTriangles &&
         a.uvs == b.uvs;
}

} // namespace chamfer
