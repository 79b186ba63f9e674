#include "preprocess/rounding/convexity.h"

#include "preprocess/components/half_edges.h"
#include "preprocess/core/linear_program.h"
#include "preprocess/rounding/plane_tree.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>

#include <algorithm>
#include <map>

namespace chamfer {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Hull = CGAL::Surface_mesh<Point>;

constexpr std::size_t kStride = 4096; ///< triangles between reports of progress

/// The planes of a hull's triangles, each with a point of its triangle.
struct TrianglePlanes {
  std::vector<Plane> planes;
  std::vector<Vector3> places;
};

TrianglePlanes planesOf(const Surface& s) {
  TrianglePlanes result;
  for (const auto& t : s.triangles) {
    const Vector3 a = s.positions[t[0]], b = s.positions[t[1]], c = s.positions[t[2]];
    const Vector3 area = cross(b - a, c - a);
    const double twice = length(area);
    // A hull triangle with no area to speak of bounds nothing that its neighbours do not.
    const double longest = std::max({lengthSquared(b - a), lengthSquared(c - b), lengthSquared(a - c)});
    if (!(twice > 1e-12 * longest)) continue;
    const Vector3 n = area / twice;
    result.planes.push_back({n, std::max({dot(n, a), dot(n, b), dot(n, c)})});
    result.places.push_back((a + b + c) / 3);
  }
  return result;
}

/// For each facet a point of one of its triangles.
std::vector<Vector3> placesOf(const Surface& s, const Polytope& polytope) {
  std::vector<Vector3> places(polytope.facets.size());
  for (std::size_t t = 0; t < s.triangles.size(); ++t)
    if (const std::uint32_t f = polytope.facetOfTriangle[t]; f < places.size()) {
      const auto& v = s.triangles[t];
      places[f] = (s.positions[v[0]] + s.positions[v[1]] + s.positions[v[2]]) / 3;
    }
  return places;
}

std::array<Vector3, 3> cornersOf(const Surface& s, std::size_t triangle) {
  const auto& v = s.triangles[triangle];
  return {s.positions[v[0]], s.positions[v[1]], s.positions[v[2]]};
}

struct Depth {
  double depth;
  Vector3 place;
};

/// The deepest point of a triangle below a hull: a linear program over the planes that matter, which are
/// found one after the other as the nearest to the point that is the deepest without them.
Depth depthOfTriangle(const PlaneTree& tree, std::span<const Plane> planes,
                      const std::array<Vector3, 3>& corners, double scale) {
  const Vector3 a = corners[0], u = corners[1] - a, v = corners[2] - a;
  std::vector<std::uint32_t> near;
  const auto row = [&](std::size_t i) -> LpRow<3> {
    if (i == near.size()) return {{-1, 0, 0}, 0};
    if (i == near.size() + 1) return {{0, -1, 0}, 0};
    if (i == near.size() + 2) return {{1, 1, 0}, 1};
    const Plane& q = planes[near[i]];
    return {{dot(q.normal, u) / scale, dot(q.normal, v) / scale, 1}, (q.offset - dot(q.normal, a)) / scale};
  };
  for (const Vector3& corner : corners)
    near.push_back(tree.nearest(std::span(&corner, 1)).plane);
  for (;;) {
    const auto z = maximizeLast<3>(near.size() + 3, row, 4.0);
    if (!z) return {0, a};
    const Depth deepest{(*z)[2] * scale, a + u * (*z)[0] + v * (*z)[1]};
    const PlaneTree::Nearest nearest = tree.nearest(std::span(&deepest.place, 1));
    if (deepest.depth - nearest.depth <= 4e-14 * scale ||
        std::find(near.begin(), near.end(), nearest.plane) != near.end())
      return deepest;
    near.push_back(nearest.plane);
  }
}

double volume6(const Surface& s) {
  double sum = 0;
  for (const auto& t : s.triangles)
    sum += dot(s.positions[t[0]], cross(s.positions[t[1]], s.positions[t[2]]));
  return sum;
}

/// The hull with the points' own numbers kept in order, its triangles sorted: CGAL's order differs from run
/// to run.
Surface toSurface(const Hull& hull, const std::vector<Point>& points, std::vector<std::uint32_t>& vertexOf) {
  std::map<Point, std::uint32_t> firstOf;
  for (std::uint32_t i = 0; i < points.size(); ++i)
    firstOf.emplace(points[i], i);
  std::vector<std::pair<std::uint32_t, Hull::Vertex_index>> order;
  for (const auto v : hull.vertices())
    order.emplace_back(firstOf.at(hull.point(v)), v);
  std::sort(order.begin(), order.end());
  Surface s;
  std::vector<std::uint32_t> name(hull.num_vertices());
  for (const auto& [point, v] : order) {
    name[std::size_t(v)] = std::uint32_t(s.positions.size());
    vertexOf.push_back(point);
    const Point& p = points[point];
    s.positions.push_back({p.x(), p.y(), p.z()});
  }
  for (const auto f : hull.faces()) {
    std::array<std::uint32_t, 3> t{};
    auto h = hull.halfedge(f);
    for (auto& corner : t) {
      corner = name[std::size_t(hull.source(h))];
      h = hull.next(h);
    }
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    s.triangles.push_back(t);
  }
  std::sort(s.triangles.begin(), s.triangles.end());
  HalfEdgePairer().pair(s.triangles, s.positions.size(), s.opposite);
  return s;
}

/// The hull's facets around each of a surface's vertices, ascending; empty for vertices inside the hull.
class FacetsAround {
public:
  FacetsAround(const Surface& surface, const Surface& hull, const Polytope& facets) {
    std::map<std::array<double, 3>, std::uint32_t> index;
    for (std::uint32_t v = 0; v < hull.positions.size(); ++v)
      index.emplace(key(hull.positions[v]), v);
    std::vector<std::vector<std::uint32_t>> around(hull.positions.size());
    for (std::size_t t = 0; t < hull.triangles.size(); ++t)
      for (const std::uint32_t v : hull.triangles[t])
        around[v].push_back(facets.facetOfTriangle[t]);
    for (auto& list : around) {
      std::sort(list.begin(), list.end());
      list.erase(std::unique(list.begin(), list.end()), list.end());
    }
    around_.resize(surface.positions.size());
    for (std::size_t v = 0; v < around_.size(); ++v)
      if (const auto found = index.find(key(surface.positions[v])); found != index.end())
        around_[v] = around[found->second];
  }
  /// A facet that all three vertices are corners of, or none.
  std::optional<std::uint32_t> common(const std::array<std::uint32_t, 3>& t) const {
    for (const std::uint32_t f : around_[t[0]])
      if (std::binary_search(around_[t[1]].begin(), around_[t[1]].end(), f) &&
          std::binary_search(around_[t[2]].begin(), around_[t[2]].end(), f))
        return f;
    return std::nullopt;
  }

private:
  static std::array<double, 3> key(const Vector3& p) { return {p.x, p.y, p.z}; }
  std::vector<std::vector<std::uint32_t>> around_;
};

} // namespace

bool cheapToCompare(const Surface& surface, const Polytope& polytope) {
  return polytope.facets.size() * surface.positions.size() <= 50'000'000;
}

bool convexByPlanes(const Surface& surface, Polytope& polytope, double tolerance) {
  if (polytope.facets.size() < 4 || !cheapToCompare(surface, polytope)) return false;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto& v = surface.triangles[t];
    if (polytope.facetOfTriangle[t] >= polytope.facets.size()) return false;
    const Vector3 a = surface.positions[v[0]], u = surface.positions[v[1]] - a,
                  w = surface.positions[v[2]] - a;
    const Vector3 area = cross(u, w);
    const double longest = std::max({lengthSquared(u), lengthSquared(w), lengthSquared(w - u)});
    // A sliver lower than the tolerance has no side of its own.
    if (lengthSquared(area) > longest * tolerance * tolerance * 16 &&
        dot(area, polytope.facets[polytope.facetOfTriangle[t]].normal) < 0)
      return false;
  }
  for (Plane& plane : polytope.facets) {
    double farthest = plane.offset;
    for (const Vector3& p : surface.positions)
      farthest = std::max(farthest, dot(plane.normal, p));
    if (farthest > plane.offset + tolerance) return false;
    plane.offset = farthest;
  }
  return true;
}

std::optional<HullResult> hullOf(const Surface& surface, double planarity, const Share& share) {
  std::vector<Point> points;
  points.reserve(surface.positions.size());
  for (const Vector3& p : surface.positions)
    points.emplace_back(p.x, p.y, p.z);
  Hull hull;
  share(0);
  CGAL::convex_hull_3(points.begin(), points.end(), hull);
  share(0.5);
  if (hull.number_of_faces() < 4 || !CGAL::is_closed(hull)) return std::nullopt;
  HullResult result;
  result.hull = toSurface(hull, points, result.vertexOf);
  result.facets = findFacets(result.hull, planarity);
  const double hullVolume = volume6(result.hull);
  if (!(hullVolume > 0)) return std::nullopt;
  result.verdict.coverage = volume6(surface) / hullVolume;

  const auto [planes, places] = planesOf(result.hull);
  const PlaneTree tree(planes, places);
  const FacetsAround around(surface, result.hull, result.facets);
  const std::vector<Vector3> facetPlaces = placesOf(result.hull, result.facets);
  const PlaneTree facetTree(result.facets.facets, facetPlaces);
  Bounds3 bounds;
  for (const Vector3& p : surface.positions)
    bounds.extend(Point3(p));
  const double scale = bounds.diagonal();
  HullVerdict& verdict = result.verdict;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (t % kStride == 0) share(0.5 + 0.5 * double(t) / double(surface.triangles.size()));
    const auto corners = cornersOf(surface, t);
    // On a facet within the tolerance that makes a facet one; or with corners that are all less deep below
    // one plane than what was found already.
    if (around.common(surface.triangles[t]) || facetTree.nearest(corners).depth <= planarity) continue;
    if (verdict.depth > 0 && tree.nearest(corners).depth <= verdict.depth) continue;
    // The depth is concave along an edge and over a face, so the face's maximum covers its edges and corners.
    const Depth d = depthOfTriangle(tree, planes, corners, scale);
    if (d.depth > verdict.depth) {
      verdict.depth = d.depth;
      verdict.place = d.place;
      verdict.triangle = std::uint32_t(t);
    }
  }
  return result;
}

std::vector<std::uint32_t> facetsOnHull(const Surface& surface, const Surface& hull, const Polytope& facets) {
  const FacetsAround around(surface, hull, facets);
  const std::vector<Vector3> places = placesOf(hull, facets);
  const PlaneTree tree(facets.facets, places);
  std::vector<std::uint32_t> result(surface.triangles.size(), 0);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto common = around.common(surface.triangles[t]);
    result[t] = common ? *common : tree.nearest(cornersOf(surface, t)).plane;
  }
  return result;
}

} // namespace chamfer
