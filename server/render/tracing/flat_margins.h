// The answer for most hits, from the triangle and the hit's barycentric coordinates alone: for every triangle
// of a rounded solid, a smaller triangle inside it that lies on the facet's flat. A hit in there is a hit of
// the rounded solid, and neither the detection cylinders nor anything else of the solid need be read for it.
#pragma once

#include "common/rounding.h"
#include "preprocess/mesh.h"

#include <array>
#include <bit>
#include <vector>

namespace chamfer {

struct TriangleFlat {
  static constexpr int kUnit = 256;           ///< margins are counted in 1 / kUnit
  static constexpr std::uint8_t kNever = 255; ///< as a margin: no point is surely on the flat
  static constexpr float kSteepest =
      64; ///< rays that meet the plane at a sine below 1 / kSteepest do not ask

  std::uint32_t facet = kNone; ///< into RoundingView::facets; kNone: the triangle stays sharp
  /// Least barycentric coordinates of the first, second and third vertex.
  std::array<std::uint8_t, 3> margins{kNever, kNever, kNever};
  /// The answer stays right for places that are off by 2^slack (mesh units) along the triangle, and for
  /// vertices that are off by as much.
  std::int8_t slack = 0;

  /// Is the point surely on the flat? `u`, `v`: barycentric coordinates of the second and third vertex.
  /// `off`: how far the ray that met it there may be off, across itself, and the triangle's vertices,
  /// together, in mesh units; `squaredSine`: of the ray's angle with the triangle.
  bool holds(float u, float v, float off, float squaredSine) const {
    const float scale = kUnit, allowed = std::bit_cast<float>(std::uint32_t(127 + slack) << 23);
    return scale * u >= margins[1] && scale * v >= margins[2] && scale * (1 - u - v) >= margins[0] &&
           squaredSine * (kSteepest * kSteepest) >= 1 && off * off <= squaredSine * (allowed * allowed);
  }
};
static_assert(sizeof(TriangleFlat) == 8);

/// By the mesh's triangle index. Time is linear in the number of triangles; facets with very many sides are
/// left to their detection trees.
std::vector<TriangleFlat> flatMargins(const RoundingView& view, const TriangleMesh& mesh);

} // namespace chamfer
