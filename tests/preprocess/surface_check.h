// What every component without a fault promises, checked from its arrays alone.
#pragma once

#include "preprocess/components/solids.h"

#include <string>

namespace chamfer {

/// Empty when `component` is a closed, connected, outward-oriented surface of genus 0 over compact vertices,
/// made of its mesh's triangles; else what is wrong with it.
std::string surfaceDefect(const Component& component, const TriangleMesh& mesh);

/// Empty when every mesh triangle is in exactly one component (as triangle, degenerate or duplicate), except
/// triangles that name a vertex twice and touch nothing else; components are in order; else what is wrong.
std::string partitionDefect(const Components& components, const TriangleMesh& mesh);

} // namespace chamfer
