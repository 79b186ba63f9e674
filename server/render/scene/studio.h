// The neutral studio that a bare mesh is shown in, and the quads that area lights are.
#pragma once

#include "server/render/scene/scene_data.h"

namespace chamfer {

/// The sky of the studio, and of scene files that name none.
SkyGradient neutralSky();

/// A quad as a mesh of two sharp triangles, counter-clockwise seen from the side of cross(u, v).
std::shared_ptr<const TriangleMesh> makeQuad(const Point3& centre, const Vector3& u, const Vector3& v);

/// Adds a quad with its own material to the scene's extra objects.
void addQuad(SceneData& data, std::size_t sceneMeshes, const std::string& name, const Point3& centre,
             const Vector3& u, const Vector3& v, Material material);

/// Adds ground, sky and key light for objects within `bounds`.
void addStudio(SceneData& data, std::size_t sceneMeshes, const Bounds3& bounds);

} // namespace chamfer
