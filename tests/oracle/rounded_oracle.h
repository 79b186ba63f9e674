// The truth about one rounded solid, by brute force in long double: R = E (+) ball(r), E the solid eroded by
// r. Lines are tested against every flat, every rounding cylinder and every rounding sphere; points against
// every face, edge and vertex of E. Shares no code with the programs.
//
// All methods are const and thread safe. Positions are in the solid's own (mesh) coordinates.
#pragma once

#include "tests/oracle/convex_solid.h"
#include "tests/oracle/inradius.h"
#include "tests/oracle/line_primitives.h"

#include <optional>

namespace chamfer::oracle {

/// Points origin + t * direction; hits count beyond `tnear`. The direction need not be unit; t is in its
/// units.
struct Ray {
  Eigen::Vector3d origin, direction;
  double tnear = 0;
  Vec3 at(Real t) const { return origin.cast<Real>() + t * direction.cast<Real>(); }
};

enum class Feature : std::uint8_t { Flat, Cylinder, Sphere };
const char* featureWord(Feature feature);

/// One end of a line's interval inside R.
struct End {
  Real t;
  Vec3 normal; ///< unit, outward
  Feature feature;
};

struct Interval {
  End in, out;
};

/// What E is like from a point in space.
struct Nearest {
  Real distance;     ///< to E; inside E minus the distance to E's nearest face plane
  Vec3 normal;       ///< unit, from E to the point: R's outward normal there
  Feature feature;   ///< of R, over the nearest feature of E
  Real seamDistance; ///< along R's surface to the nearest border of that feature
  Real seamMotion;   ///< how far that border may move for each unit that E's vertices move
};

struct Measures {
  Real volume, area;
  Real meanCurvature; ///< half the sum of edge length times exterior angle
};

class RoundedOracle {
public:
  /// Facets are the solid's faces, which must be convex and pairwise not coplanar. Throws std::runtime_error
  /// when the radius leaves no core.
  RoundedOracle(const ConvexSolid& solid, double radius);

  double radius() const { return double(radius_); }
  double diagonal() const { return double(diagonal_); } ///< of the solid's bounding box
  const Eigen::Vector3d& centre() const { return centre_; }
  /// E, relative to centre().
  const Polytope& core() const { return core_; }
  /// P's facet planes, relative to centre(), by face.
  const std::vector<Plane>& planes() const { return planes_; }

  /// Where the ray's whole line is inside R; nothing when it misses.
  std::optional<Interval> interval(const Ray& ray) const;
  /// The first end of the interval beyond ray.tnear.
  std::optional<End> firstEndBeyond(const Ray& ray) const;
  /// Distance of the line from E less r: below 0 the line meets R, above it misses; -r where it meets E. A
  /// lower bound only where the line is far outside.
  Real silhouetteMargin(const Ray& ray) const;

  Nearest nearest(const Vec3& point) const;
  bool insideSolid(const Vec3& point) const;
  /// How far the point of facet `facet` is inside the flat; below 0 it is in the chamfer zone; minus infinity
  /// where the flat has vanished.
  Real flatMargin(std::uint32_t facet, const Vec3& point) const;

  /// Throws std::runtime_error where core().closed is false.
  Measures coreMeasures() const;
  Real volume() const; ///< of R, by Steiner's formula
  Real area() const;

private:
  struct Segment {
    Vec3 a, axis;
    Real length;
    std::uint32_t left, right;
  };
  struct Placed {
    Line line;  ///< relative to centre_, its origin the point nearest to it, its direction unit
    Real shift; ///< of that origin along the ray, in lengths
    Real speed; ///< length of the ray's direction
  };
  /// Bounding balls in double, to pass by what is trivially far.
  struct Balls {
    std::vector<double> x, y, z, radius;
    void add(const Vec3& centre, Real radius_);
  };
  struct Best;

  Placed place(const Ray& ray) const;
  void testFlats(const Line& line, Best& best) const;
  void testSpheres(const Line& line, Best& best) const;
  void testCylinders(const Line& line, Best& best) const;
  bool insideFace(std::uint32_t face, const Vec3& point) const;
  Real seamOfFace(std::uint32_t face, const Vec3& foot) const;
  Real seamOfVertex(std::uint32_t vertex, const Vec3& normal) const;
  /// Moved by d, the ends of an edge turn it by up to 2 d / length, and the borders that it decides by r
  /// times that.
  Real seamMotion(Real edgeLength) const { return 1 + 2 * radius_ / edgeLength; }

  Real radius_, diagonal_, bound_ = 0; // bound_: ball about centre_ that holds R
  Eigen::Vector3d centre_;
  std::vector<Plane> planes_;
  Polytope core_;
  std::vector<Segment> segments_;                // core_.edges
  std::vector<std::vector<Vec3>> edgesAtVertex_; // unit directions out of it
  std::vector<Real> shortestAtVertex_;           // length of its shortest edge
  Balls capsules_, balls_;                       // of segments_ and of core_.vertices, with r
};

/// The solid's largest radius: its inball's, by linear programming.
Inball inball(const ConvexSolid& solid);

} // namespace chamfer::oracle
