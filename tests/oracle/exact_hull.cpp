#include "tests/oracle/exact_hull.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>
#include <Eigen/Geometry>
#include <algorithm>

namespace chamfer::oracle {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

struct Facet {
  std::vector<Vec3> corners;
  Vec3 normal; ///< as long as the facet is large
};

} // namespace

ConvexSolid exactHull(std::string name, std::span<const Eigen::Vector3d> points, double samePlane) {
  std::vector<Kernel::Point_3> input;
  Vec3 centre = Vec3::Zero();
  Eigen::Vector3d low = points.front(), high = low;
  for (const auto& p : points) {
    input.emplace_back(p.x(), p.y(), p.z());
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  CGAL::Surface_mesh<Kernel::Point_3> hull;
  CGAL::convex_hull_3(input.begin(), input.end(), hull);
  const auto position = [&](auto v) { return Vec3(hull.point(v).x(), hull.point(v).y(), hull.point(v).z()); };
  for (const auto v : hull.vertices())
    centre += position(v) / Real(hull.number_of_vertices());

  std::vector<Facet> facets;
  for (const auto f : hull.faces()) {
    Facet facet;
    for (const auto v : hull.vertices_around_face(hull.halfedge(f)))
      facet.corners.push_back(position(v) - centre);
    facet.normal = loopNormal(facet.corners);
    facets.push_back(std::move(facet));
  }
  std::sort(facets.begin(), facets.end(),
            [](const Facet& a, const Facet& b) { return a.normal.squaredNorm() > b.normal.squaredNorm(); });
  const double diagonal = (high - low).norm();
  std::vector<Plane> planes;
  for (const Facet& facet : facets) {
    const auto holds = [&](const Plane& plane) {
      return plane.normal.dot(facet.normal) > 0 &&
             std::all_of(facet.corners.begin(), facet.corners.end(), [&](const Vec3& p) {
               return std::abs(plane.normal.dot(p) - plane.offset) <= samePlane * diagonal;
             });
    };
    if (std::any_of(planes.begin(), planes.end(), holds)) continue;
    const Vec3 normal = facet.normal.normalized();
    Real offset = 0;
    for (const Vec3& p : facet.corners)
      offset = std::max(offset, normal.dot(p));
    planes.push_back({normal, offset});
  }
  ConvexSolid solid = solidFromPlanes(std::move(name), planes, diagonal);
  for (Eigen::Vector3d& v : solid.vertices)
    v = (v.cast<Real>() + centre).cast<double>();
  return solid;
}

} // namespace chamfer::oracle
