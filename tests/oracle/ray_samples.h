// Seeded rays that look for trouble with one rounded solid.
#pragma once

#include "tests/oracle/random.h"
#include "tests/oracle/rounded_oracle.h"

#include <array>
#include <cstddef>

namespace chamfer::oracle {

enum class RayKind : std::uint8_t {
  Distant,      ///< from 1 to 4 diagonals away, anywhere near the solid
  Far10,        ///< at R's surface, from 10 diagonals away
  Far100,       ///< at R's surface, from 100 diagonals away
  Edge,         ///< near an edge of P, within some radii
  GrazingEdge,  ///< the same, nearly along the facets
  Corner,       ///< near a vertex of P
  Tangent,      ///< along R's surface, 1e-7 to 1e-2 diagonals above or below it
  Inside,       ///< starts inside P
  Sliver,       ///< starts inside P and outside R
  AxisParallel, ///< exactly along a coordinate axis, facet normal or edge, from points of a coarse grid
  AlongEdge,    ///< along an edge of P, in the sliver or beside it
  Seam,         ///< at borders between flats, cylinders and spheres
};
inline constexpr std::array kRayKinds{RayKind::Distant,      RayKind::Far10,       RayKind::Far100,
                                      RayKind::Edge,         RayKind::GrazingEdge, RayKind::Corner,
                                      RayKind::Tangent,      RayKind::Inside,      RayKind::Sliver,
                                      RayKind::AxisParallel, RayKind::AlongEdge,   RayKind::Seam};
const char* rayKindWord(RayKind kind);

/// Point of R's surface with its outward normal.
struct SurfacePoint {
  Eigen::Vector3d position, normal;
};

class RaySampler {
public:
  /// Keeps references to both.
  RaySampler(const ConvexSolid& solid, const RoundedOracle& oracle, std::uint64_t seed);

  Ray sample(RayKind kind);
  std::vector<Ray> sample(RayKind kind, std::size_t count);
  /// Every kind in turn.
  std::vector<Ray> mixed(std::size_t count);

  SurfacePoint onFlat(); ///< on a sphere when every flat has vanished
  SurfacePoint onCylinder();
  SurfacePoint onSphere();
  SurfacePoint onSurface(); ///< one of the three
  SurfacePoint onSeam();
  /// Point of facet `facet` of P, anywhere in it.
  Eigen::Vector3d onFacet(std::uint32_t facet);

private:
  Eigen::Vector3d world(const Vec3& local) const;
  Eigen::Vector3d inHemisphere(const Eigen::Vector3d& normal);
  Eigen::Vector3d onEdgeOfSolid(Eigen::Vector3d& along);
  Ray towards(const Eigen::Vector3d& target, const Eigen::Vector3d& from, double distance);
  Ray grid();
  Ray alongEdge();
  SurfacePoint onEdgeOfCore(bool atBorder);

  const ConvexSolid& solid_;
  const RoundedOracle& oracle_;
  Random random_;
  double diagonal_, radius_;
  std::vector<std::vector<std::uint32_t>> facetsAtVertex_; // of the core
  std::vector<std::uint32_t> flats_;
  Eigen::Vector3d lower_, upper_;
};

/// `base` rays, times the environment variable CHAMFER_RAYS for long runs.
std::size_t rayBudget(std::size_t base);

} // namespace chamfer::oracle
