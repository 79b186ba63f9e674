// The planes around a convex solid, to ask which of them a point or a triangle inside is nearest to.
#pragma once

#include "preprocess/core/polytope.h"

namespace chamfer {

/// Hierarchy over directions: a node bounds its planes' normals by a cone, and their offsets about a point
/// near their facets. Asking costs O(log n) near the surface of a solid whose facets are spread, and is exact
/// anywhere.
class PlaneTree {
public:
  /// `places`: for each plane a point of its facet, or near it; they decide the speed alone. Planes stay the
  /// caller's.
  PlaneTree(std::span<const Plane> planes, std::span<const Vector3> places);

  struct Nearest {
    std::uint32_t plane; ///< the lowest number among equals
    double depth;        ///< a length, not below 0
  };
  /// The plane below which the deepest of `points` lies least deep.
  Nearest nearest(std::span<const Vector3> points) const;

private:
  struct Node {
    Vector3 axis; ///< unit; all normals lie within the angle of it
    double cosine, sine;
    Vector3 place;
    double offset; ///< least offset of the planes about `place`
  };
  void build(std::size_t node, std::size_t first, std::size_t last);
  double leastDepth(const Node& node, const Vector3& point) const;
  void visit(std::size_t node, std::size_t first, std::size_t last, std::span<const Vector3> points,
             Nearest& best) const;
  double bound(std::size_t node, std::span<const Vector3> points) const;

  std::span<const Plane> planes_;
  std::span<const Vector3> places_; ///< while building
  double slack_ = 0;                ///< of bounds, for rounding
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_; ///< a node, its first half's subtree, its second half's
};

} // namespace chamfer
