// Several rounded solids, each placed by an affine map: the hit is the first end beyond tnear of any solid's
// interval. As one body, a ray from within hits where it first leaves all of them.
#pragma once

#include "tests/oracle/rounded_oracle.h"

#include <memory>

namespace chamfer::oracle {

struct Hit {
  Real t;
  Vec3 normal; ///< world, unit, outward
  Feature feature;
  std::size_t part;
};

/// `Nearest` of one part, lengths as shares of that part's own diagonal, the normal in the world.
struct NearestShare {
  Real offSurface; ///< distance from R's surface: above 0 outside
  Real seamDistance, seamMotion;
  Vec3 normal;
  Feature feature;
};

class UnionOracle {
public:
  UnionOracle() = default;
  explicit UnionOracle(std::shared_ptr<const RoundedOracle> solid) { add(std::move(solid)); }
  /// Under a map that is not a similarity the rounding is mapped with the solid, and normals by the inverse
  /// transpose.
  void add(std::shared_ptr<const RoundedOracle> solid, const Affine& worldFromObject = {});

  /// Ends nearer to each other than `touch` (share of a diagonal) coincide: there one part ends and the next
  /// begins.
  void fuse(Real touch) { touch_ = touch; }

  std::size_t size() const { return parts_.size(); }
  const RoundedOracle& part(std::size_t i) const { return *parts_[i].solid; }

  std::optional<Hit> firstHit(const Ray& ray) const;
  NearestShare nearest(std::size_t part, const Vec3& worldPoint) const;
  /// How near the ray is to having another answer, as a share of the diagonal concerned: the least of the
  /// silhouette margins, the distances of the point at tnear from the surfaces, and the distances between
  /// ends of different parts.
  Real ambiguity(const Ray& ray) const;

private:
  struct Part {
    std::shared_ptr<const RoundedOracle> solid;
    Eigen::Matrix<Real, 3, 3> objectFromWorld; ///< linear part
    Vec3 offset;                               ///< objectFromWorld's translation
  };
  Ray toObject(const Part& part, const Ray& ray) const;
  std::optional<Hit> lastExit(const Ray& ray) const;
  Hit placed(std::size_t part, const End& end) const;

  std::vector<Part> parts_;
  Real touch_ = -1; ///< below 0: the parts are no one body
};

} // namespace chamfer::oracle
