// Orientation of a surface whose half-edges are paired: the same over all neighbours, and outwards.
#pragma once

#include "preprocess/components/half_edges.h"

namespace chamfer {

struct Consistency {
  std::size_t reached = 0; ///< triangles that hang together with the first
  std::size_t turned = 0;  ///< of them: those that must be turned to agree with the first
  bool orientable = true;  ///< false: one-sided, like a Klein bottle; then nothing can be turned right
};

/// Walks over neighbours from triangle 0. Sets turn[t] for those that must be turned to agree with triangle 0
/// (0 or 1; 2 for those not reached).
Consistency findConsistentTurns(const HalfEdges& surface, std::vector<std::uint8_t>& turn,
                                std::vector<std::uint32_t>& stack);

/// Swaps corners 1 and 2 of every triangle t with turn[t] == 1, and keeps `opposite` right.
void turnTriangles(std::span<const std::uint8_t> turn, std::span<Triangle> triangles,
                   std::vector<std::uint32_t>& opposite);
/// The same for all triangles.
void turnAll(std::span<Triangle> triangles, std::vector<std::uint32_t>& opposite);

struct Extent {
  double volume = 0; ///< enclosed, negative when inside out, in diagonals^3
  double area = 0;   ///< in diagonals^2
};

/// Of a closed surface, relative to the diagonal of `bounds`, so that no scale of the mesh overflows.
Extent measure(std::span<const Triangle> triangles, std::span<const Point3> positions, const Bounds3& bounds);

} // namespace chamfer
