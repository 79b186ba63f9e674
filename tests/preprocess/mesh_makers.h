// Small meshes built in memory, and the check of what they split into.
#pragma once

#include "preprocess/components/solids.h"
#include "tests/preprocess/surface_check.h"

#include <gtest/gtest.h>
#include <random>

namespace chamfer {

using Corners = std::array<std::uint32_t, 3>;

inline void appendTriangle(TriangleMesh& mesh, const Corners& corners) {
  mesh.faceOfTriangle.push_back(std::uint32_t(mesh.triangles.size()));
  mesh.triangles.push_back(corners);
}

/// Twelve triangles over eight new vertices, facing outwards or inwards.
inline void appendBox(TriangleMesh& mesh, const Point3& lower, const Point3& upper, bool inwards = false) {
  const auto base = std::uint32_t(mesh.positions.size());
  for (int i = 0; i < 8; ++i)
    mesh.positions.push_back(
        {i & 1 ? upper.x : lower.x, i & 2 ? upper.y : lower.y, i & 4 ? upper.z : lower.z});
  constexpr std::uint32_t kSides[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                          {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& s : kSides)
    for (const auto& [b, c] : {std::pair{1, 2}, std::pair{2, 3}}) {
      const std::uint32_t v1 = base + s[b], v2 = base + s[c];
      appendTriangle(mesh, inwards ? Corners{base + s[0], v2, v1} : Corners{base + s[0], v1, v2});
    }
}

inline TriangleMesh box(bool inwards = false) {
  TriangleMesh mesh;
  appendBox(mesh, {0, 0, 0}, {1, 1, 1}, inwards);
  return mesh;
}

/// Three vertices of its own for every triangle; `noise` moves each coordinate by at most that much.
inline TriangleMesh unwelded(const TriangleMesh& mesh, bool soup, double noise = 0) {
  std::mt19937 random(7);
  const auto jitter = [&] { return noise * (2 * double(random()) / double(std::mt19937::max()) - 1); };
  TriangleMesh out;
  out.soup = soup;
  for (const Corners& t : mesh.triangles) {
    const auto base = std::uint32_t(out.positions.size());
    for (const std::uint32_t v : t) {
      const Point3& p = mesh.positions[v];
      out.positions.push_back({p.x + jitter(), p.y + jitter(), p.z + jitter()});
    }
    appendTriangle(out, {base, base + 1, base + 2});
  }
  return out;
}

inline Components split(const TriangleMesh& mesh) { return splitComponents(mesh, {}); }

inline void expectSound(const Components& components, const TriangleMesh& mesh, std::size_t count) {
  EXPECT_EQ(components.list.size(), count);
  for (const Component& c : components.list) {
    EXPECT_FALSE(c.fault) << c.fault->message;
    EXPECT_EQ(surfaceDefect(c, mesh), "");
  }
  EXPECT_EQ(partitionDefect(components, mesh), "");
}

} // namespace chamfer
