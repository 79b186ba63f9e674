// The project's rounding of the oracle's solids, in the oracle's terms.
#pragma once

#include "common/ray_query.h"
#include "preprocess/preprocess.h"
#include "tests/oracle/agreement.h"
#include "tests/oracle/convex_solid.h"

namespace chamfer {

/// Triangle fans over the solids' faces; solid by solid, face by face.
TriangleMesh meshOf(std::span<const oracle::ConvexSolid> solids);

/// Solids as preprocessing rounds them, with one radius for all.
class RoundedSubject {
public:
  RoundedSubject(std::span<const oracle::ConvexSolid> solids, double radius);
  RoundedSubject(const oracle::ConvexSolid& solid, double radius)
      : RoundedSubject(std::span(&solid, 1), radius) {}
  /// Any mesh: `hulls` are its components' convex hulls, in the components' order.
  RoundedSubject(const TriangleMesh& mesh, const PreprocessOptions& options,
                 std::vector<oracle::ConvexSolid> hulls);

  const RoundingView& view() const { return result_.rounding->view(); }
  const PreprocessReport& report() const { return result_.report; }
  /// Index in view().facets of a solid's face.
  std::uint32_t facet(std::size_t solid, std::size_t face) const { return facetOfFace_[solid][face]; }

  /// Where the ray's line enters solid 0, whatever tnear; the walk starts anywhere, by a hash of the ray.
  oracle::Subject entryOfLine() const;
  /// The same through `exit` of the reversed line.
  oracle::Subject exitOfReversedLine() const;
  /// First end beyond tnear over all solids, as a renderer gets it: from the triangles that the ray meets.
  oracle::Subject firstEnd() const;
  /// detect() for a point of a solid's face, mesh coordinates.
  Detection detectAt(std::size_t solid, std::size_t face, const Eigen::Vector3d& point) const;

private:
  Ray inFrame(std::size_t solid, const oracle::Ray& ray) const;
  std::uint32_t anyHalfEdge(std::size_t solid, const oracle::Ray& ray) const;

  PreprocessResult result_;
  std::vector<oracle::ConvexSolid> solids_;
  std::vector<std::vector<oracle::Plane>> planes_; ///< of the faces, relative to centres_
  std::vector<Eigen::Vector3d> centres_;
  std::vector<std::vector<std::uint32_t>> facetOfFace_;
};

} // namespace chamfer
