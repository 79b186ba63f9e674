// Small meshes to put into the folder of a test that loads scenes.
#pragma once

#include "server/render/path/render.h"
#include "tests/support/temporary_folder.h"

#include <filesystem>
#include <string>

namespace chamfer::test {

/// OBJ of an axis-aligned box, quads turned outward.
std::string boxObj(const Point3& lower, const Point3& upper);
/// OBJ of the unit cube about the origin.
std::string cubeObj();

/// Loads a scene file of this content; every test mesh is there: cube.obj, box2.obj (side 2), floor.obj (a 20
/// x 20 x 1 slab with its top at z = -0.5).
std::shared_ptr<const Scene> loadText(const TemporaryFolder& folder, const std::string& json);
void writeMeshes(const TemporaryFolder& folder);

} // namespace chamfer::test
