// A scene as binary glTF 2.0, for a raster preview: the unrounded meshes, the instances as nodes, base
// colour, roughness, metalness and emission of the materials; no normals (flat shading, as the specification
// has it), no textures, no lights, no camera. tinygltf is known in preview_glb.cpp only.
#pragma once

#include "server/render/scene/scene.h"

#include <cstddef>
#include <string>

namespace chamfer::http {

/// The scene's own instances, not a studio's ground. Nodes are the instances in their order, below one root
/// node that turns the scene's up (the axis nearest to its camera's) to glTF's, +y; below the root,
/// coordinates are the world's. Positions are float32, lengths are not changed. Throws Error(OutOfRange) when
/// the file would have more than about `maxBytes`; nothing is left out to make it fit.
std::string previewGlb(const Scene& scene, std::size_t maxBytes);

} // namespace chamfer::http
