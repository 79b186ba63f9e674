// From a mesh to its components, each a closed, consistently outward-oriented manifold surface, or a named
// fault. Order of steps and tolerances: connected components by index first; faces paired by geometry around
// edges that more than two share; welding by position only inside what is open; then faces that are given
// twice dropped, and triangles split at vertices that lie on their edges; triangles that name a vertex twice
// dropped; orientation turned outward; closed, manifold and genus 0 checked; solids that are given twice
// dropped. All lengths relative to each component's own diagonal.
#pragma once

#include "preprocess/mesh.h"

#include <optional>
#include <string>

namespace chamfer {

struct InputTolerances {
  double weld =
      1e-7; ///< positions nearer than this share of the component's diagonal are one (open parts only)
  double planarity = 1e-6; ///< a vertex this share of the diagonal off a facet's plane still lies in it
  double convexity = 1e-4; ///< depth below the component's own hull that still counts as convex
};

enum class FaultKind : std::uint8_t {
  Open,
  NonManifold,
  Misoriented,
  InsideOut,
  Flat,
  NotFinite,
  Concave,
  SelfIntersecting,
  TooFew,
  Genus
};
const char* faultWord(FaultKind kind); ///< e.g. "open", "non-manifold"

/// Why a component is not a convex solid: the reason, the place and the measured size of the fault.
struct Fault {
  FaultKind kind;
  std::string message; ///< one sentence with place and number, for people
  double measure = 0;  ///< the number: count of open edges, depth relative to the diagonal, ...
  Point3 place;        ///< mesh coordinates
  std::uint32_t triangle = 0xffffffffu; ///< mesh triangle nearest to the fault
};

/// One connected component. Vertices are compact and welded; every triangle is the file's, turned outward, or
/// a part of one that was split where vertices lie on its edges. Triangles without area but with three
/// vertices are kept: they may be what closes the surface.
struct Component {
  std::vector<Point3> positions;                       ///< mesh coordinates
  std::vector<std::array<std::uint32_t, 3>> triangles; ///< outward (counter-clockwise seen from outside)
  /// The mesh's triangle of each, ascending; the parts of a split one name the same.
  std::vector<std::uint32_t> meshTriangle;
  /// [3 * triangle + k]: 3 * neighbour + its edge across edge k -> k+1. Complete unless there is a fault;
  /// then kNone (0xffffffff) where an edge has no or no single partner.
  std::vector<std::uint32_t> opposite;
  std::vector<std::uint32_t>
      degenerate; ///< mesh triangles dropped because they name a vertex twice; they have no area
  std::vector<std::array<std::uint32_t, 2>>
      duplicates; ///< {mesh triangle dropped, a kept one in the same facet}, ascending
  Bounds3 bounds;
  bool turned = false;               ///< was inside out
  std::uint32_t turnedTriangles = 0; ///< turned to face outwards: all of them when it was inside out
  std::optional<Fault> fault;
};

struct ComponentCounts {
  std::size_t weldedVertices = 0, degenerateTriangles = 0, turned = 0, unusedVertices = 0,
              duplicateTriangles = 0, duplicateSolids = 0;
  std::size_t splitEdges = 0;      ///< half-edges split at vertices that lie on them
  std::size_t turnedTriangles = 0; ///< of components that were neither right nor wholly inside out
};

struct Components {
  std::vector<Component> list; ///< in order of their lowest mesh triangle
  ComponentCounts counts;
  std::vector<std::string> warnings; ///< what was put right that might have been meant otherwise
};

/// Uses `threads` threads (0: all). Never throws for what the mesh is like: faults are in the components.
Components splitComponents(const TriangleMesh& mesh, const InputTolerances& tolerances, unsigned threads = 0);

} // namespace chamfer
