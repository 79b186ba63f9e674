#include "tests/oracle/exact_hull.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <set>

namespace chamfer::oracle {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Hull = CGAL::Surface_mesh<Kernel::Point_3>;

struct Facet {
  std::vector<Vec3> corners;
  Vec3 normal; ///< as long as the facet is large
};

/// For each triangle of the hull the least one that is exactly coplanar with it and connected to it.
std::vector<std::uint32_t> exactlyFlatParts(const Hull& hull) {
  std::vector<std::uint32_t> part(hull.number_of_faces());
  std::iota(part.begin(), part.end(), 0u);
  const auto root = [&](std::uint32_t f) {
    while (part[f] != f)
      f = part[f] = part[part[f]];
    return f;
  };
  const auto point = [&](auto halfEdge) { return hull.point(hull.target(halfEdge)); };
  for (const auto edge : hull.edges()) {
    const auto h = hull.halfedge(edge), twin = hull.opposite(h);
    if (!CGAL::coplanar(point(twin), point(h), point(hull.next(h)), point(hull.next(twin)))) continue;
    const std::uint32_t a = root(hull.face(h)), b = root(hull.face(twin));
    part[std::max(a, b)] = std::min(a, b);
  }
  for (std::uint32_t f = 0; f < part.size(); ++f)
    part[f] = root(f);
  return part;
}

/// The hull's facets as polygons without corners on straight edges, each from its least corner on. CGAL's own
/// triangles follow its memory's addresses, and so does which of the points within a facet are corners of
/// theirs.
std::vector<std::vector<Kernel::Point_3>> polygonsOf(const Hull& hull) {
  const std::vector<std::uint32_t> part = exactlyFlatParts(hull);
  std::vector<std::vector<Kernel::Point_3>> polygons;
  std::vector<bool> done(part.size());
  for (const auto first : hull.halfedges()) {
    const std::uint32_t own = part[hull.face(first)];
    if (done[own] || part[hull.face(hull.opposite(first))] == own) continue;
    done[own] = true;
    std::vector<Kernel::Point_3> loop;
    auto h = first;
    do {
      loop.push_back(hull.point(hull.target(h)));
      for (h = hull.next(h); part[hull.face(hull.opposite(h))] == own;)
        h = hull.next(hull.opposite(h));
    } while (h != first);
    std::vector<Kernel::Point_3> corners;
    for (std::size_t i = 0; i < loop.size(); ++i)
      if (!CGAL::collinear(loop[(i + loop.size() - 1) % loop.size()], loop[i], loop[(i + 1) % loop.size()]))
        corners.push_back(loop[i]);
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    polygons.push_back(std::move(corners));
  }
  std::sort(polygons.begin(), polygons.end());
  return polygons;
}

} // namespace

ConvexSolid exactHull(std::string name, std::span<const Eigen::Vector3d> points, double samePlane) {
  std::vector<Kernel::Point_3> input;
  Eigen::Vector3d low = points.front(), high = low;
  for (const auto& p : points) {
    input.emplace_back(p.x(), p.y(), p.z());
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  Hull hull;
  CGAL::convex_hull_3(input.begin(), input.end(), hull);
  const std::vector<std::vector<Kernel::Point_3>> polygons = polygonsOf(hull);
  const auto position = [](const Kernel::Point_3& p) { return Vec3(p.x(), p.y(), p.z()); };
  std::set<Kernel::Point_3> corners;
  for (const auto& polygon : polygons)
    corners.insert(polygon.begin(), polygon.end());
  Vec3 centre = Vec3::Zero();
  for (const auto& p : corners)
    centre += position(p) / Real(corners.size());

  std::vector<Facet> facets;
  for (const auto& polygon : polygons) {
    Facet facet;
    for (const auto& p : polygon)
      facet.corners.push_back(position(p) - centre);
    facet.normal = loopNormal(facet.corners);
    facets.push_back(std::move(facet));
  }
  std::stable_sort(facets.begin(), facets.end(), [](const Facet& a, const Facet& b) {
    return a.normal.squaredNorm() > b.normal.squaredNorm();
  });
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
