// Tangent frames from texture coordinates, for normal textures in tangent space by OpenGL's convention: red
// along growing u, green along growing v, blue along the surface's normal, each 0..1 for -1..1.
#pragma once

#include "common/transform.h"
#include "preprocess/rounding/original_surface.h"
#include "server/render/material/texture.h"

#include <array>
#include <optional>

namespace chamfer {

/// World, orthonormal; right-handed unless the texture is mirrored on the surface.
struct TangentFrame {
  Vector3 tangent, bitangent, normal;
  /// The normal that a texture's colour means here, unit; `normal` where the colour means none. What it leans
  /// along u and v is taken times `strength`.
  Vector3 turned(const Color& texel, const std::array<double, 2>& strength = {1, 1}) const;
};

/// The frame about `normal` (world, unit) at any point of a triangle: the directions in which u and v grow on
/// it, taken into the plane that `normal` is normal to (on a rounding, the rounded surface's tangent plane).
/// Nothing where the triangle has no texture coordinates, they span no area, or that direction is along the
/// normal.
std::optional<TangentFrame> tangentFrame(const TriangleMesh& mesh, std::uint32_t triangle,
                                         const Vector3& normal, const Transform& worldFromObject);

/// Does the image hold normals by the convention above? Their mean points along the surface's normal more
/// than along any other axis; a height map, as many MTL libraries name in map_Bump, is grey.
bool holdsNormals(const Texture& texture);

} // namespace chamfer
