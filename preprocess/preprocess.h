// The whole of preprocessing: a mesh in, its rounding and a report out. chamferprep is a thin main over this,
// and the server calls it for another radius. Progress and cancellation through the callback.
#pragma once

#include "common/sidecar.h"
#include "preprocess/components/solids.h"

#include <functional>
#include <memory>

namespace chamfer {

/// An absolute radius in mesh units, or a share of each solid's bounding box diagonal ("2%").
struct Radius {
  double value = 0;
  bool relative = false; ///< value is a share of the diagonal (0.02 for 2%)
};
/// Parses "0.1" or "2%". Throws Error(Usage) unless it is a finite number above 0.
Radius parseRadius(std::string_view text);

struct PreprocessOptions {
  Radius radius;
  InputTolerances tolerances;
  OnNonConvex onNonConvex = OnNonConvex::Error;
  /// With OnNonConvex::Hull: components that are rounded as their hulls keep their own triangles, for a mesh
  /// that is already what is traced.
  bool keepTriangles = false;
  double clamp = 0; ///< above 0: each solid gets the smaller of the radius and this share of its own inradius
  unsigned threads = 0;
  std::function<void(const char* stage, double share)> progress; ///< may throw to cancel
};

/// What a sidecar keeps of options, and the options that it stands for.
RoundingOptions recordOf(const PreprocessOptions& options);
PreprocessOptions optionsOf(const RoundingOptions& record);

struct StageTimes {
  double components = 0, convexity = 0, facets = 0, core = 0, detection = 0, pack = 0; ///< seconds, wall
};

struct PreprocessReport {
  std::size_t solids = 0, facets = 0, roundedEdges = 0, spheres = 0, cornersOver3 = 0, vanishedFacets = 0;
  std::size_t sharpComponents = 0, hulledComponents = 0, clampedSolids = 0, treeNodes = 0;
  double maxRadius = 0;           ///< largest radius that every solid admits (the smallest inradius)
  std::size_t maxRadiusSolid = 0; ///< which solid sets it
  double nonConvexity = 0;        ///< largest accepted depth below a hull, relative to the diagonal
  ComponentCounts counts;
  std::vector<std::string> warnings; ///< the mesh's first; a bounded number
  StageTimes times;
};

struct PreprocessResult {
  std::shared_ptr<const Rounding> rounding;
  /// The mesh that the rounding belongs to where it is not the one given: hulls in the place of the
  /// components that are rounded as their hulls (OnNonConvex::Hull); a function of the mesh and the
  /// tolerances. Else null.
  std::shared_ptr<const TriangleMesh> mesh;
  PreprocessReport report;
};

/// Throws Error(NotConvexSolid) (message names component, place and measure), Error(RadiusTooLarge) (names
/// the solid and its largest radius).
PreprocessResult preprocess(const TriangleMesh& mesh, const PreprocessOptions& options);

} // namespace chamfer
