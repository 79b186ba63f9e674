// What a path is inside of. A solid is a closed surface of one instance: a rounded solid, or a closed
// component of a sharp mesh (closed_solids.h).
#pragma once

#include "common/rounding.h"

#include <boost/container/small_vector.hpp>
#include <cstdint>

namespace chamfer {

/// The solids that a path's point is inside of, in the sliver of, or on the surface of: with them every ray
/// from the point is answered exactly and without any offset. Empty: a free point outside of all solids.
class PathState {
public:
  enum class At : std::uint8_t {
    Inside, ///< in the solid: only its far side can be met
    /// In the unrounded mesh (perhaps) and not in the rounded solid: its near side can be met, and no
    /// triangle need lie before it.
    Sliver,
    Surface ///< on it: a ray inward is inside, a ray outward never meets a convex solid again
  };
  struct Place {
    std::uint32_t instance;
    std::uint32_t solid;                ///< of the instance's mesh; kNone: a triangle of an open surface
    std::uint32_t triangle;             ///< by which the path came to the solid
    std::uint32_t firstFacet, endFacet; ///< of a rounded solid; else kNone
    At at;
    bool facesNormal;        ///< Surface: the solid's outward normal is on the side of `normal`
    bool leavesFlat = false; ///< Surface: a path outward never comes into the solid's sliver again
    bool rounded() const { return firstFacet != kNone; }
  };
  using Places = boost::container::small_vector<Place, 4>;

  Places places;
  Vector3 normal{}; ///< world: of the surface that Surface places are on; any side

  bool empty() const { return places.empty(); }
  /// Does a ray along `direction` begin inside the solid?
  bool inside(const Place& place, const Vector3& direction) const {
    return place.at == At::Inside ||
           (place.at == At::Surface && (dot(direction, normal) < 0) == place.facesNormal);
  }
};

} // namespace chamfer
