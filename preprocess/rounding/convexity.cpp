#include "preprocess/rounding/convexity.h"

#include "preprocess/core/linear_program.h"

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

std::vector<Plane> planesOf(const Surface& s) {
  std::vector<Plane> planes;
  for (const auto& t : s.triangles) {
    const Vector3 a = s.positions[t[0]], b = s.positions[t[1]], c = s.positions[t[2]];
    const Vector3 area = cross(b - a, c - a);
    const double twice = length(area);
    // A hull triangle with no area to speak of bounds nothing that its neighbours do not.
    const double longest = std::max({lengthSquared(b - a), lengthSquared(c - b), lengthSquared(a - c)});
    if (!(twice > 1e-12 * longest)) continue;
    const Vector3 n = area / twice;
    planes.push_back({n, std::max({dot(n, a), dot(n, b), dot(n, c)})});
  }
  return planes;
}

struct Depth {
  double depth;
  Vector3 place;
};

Depth depthOfTriangle(std::span<const Plane> planes, const Vector3& a, const Vector3& u, const Vector3& v,
                      double scale) {
  const auto row = [&](std::size_t i) -> LpRow<3> {
    if (i == planes.size()) return {{-1, 0, 0}, 0};
    if (i == planes.size() + 1) return {{0, -1, 0}, 0};
    if (i == planes.size() + 2) return {{1, 1, 0}, 1};
    const Plane& q = planes[i];
    return {{dot(q.normal, u) / scale, dot(q.normal, v) / scale, 1}, (q.offset - dot(q.normal, a)) / scale};
  };
  const auto z = maximizeLast<3>(planes.size() + 3, row, 4.0);
  return z ? Depth{(*z)[2] * scale, a + u * (*z)[0] + v * (*z)[1]} : Depth{0, a};
}

double volume6(const Surface& s) {
  double sum = 0;
  for (const auto& t : s.triangles)
    sum += dot(s.positions[t[0]], cross(s.positions[t[1]], s.positions[t[2]]));
  return sum;
}

/// The hull with the points' own numbers kept in order, its triangles sorted: CGAL's order differs from run
/// to run.
Surface toSurface(const Hull& hull, const std::vector<Point>& points) {
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
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> edges;
  for (std::uint32_t e = 0; e < 3 * s.triangles.size(); ++e)
    edges.emplace(std::pair(s.triangles[e / 3][e % 3], s.triangles[e / 3][(e % 3 + 1) % 3]), e);
  s.opposite.resize(3 * s.triangles.size());
  for (const auto& [edge, e] : edges)
    s.opposite[e] = edges.at({edge.second, edge.first});
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

/// Do all three vertices lie on the plane of one facet, within the tolerance that makes a facet one?
bool onAFacet(const Polytope& polytope, const Surface& surface, const std::array<std::uint32_t, 3>& t,
              double planarity) {
  const Vector3 &a = surface.positions[t[0]], &b = surface.positions[t[1]], &c = surface.positions[t[2]];
  for (const Plane& p : polytope.facets)
    if (p.offset - std::min({dot(p.normal, a), dot(p.normal, b), dot(p.normal, c)}) <= planarity) return true;
  return false;
}

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

std::optional<HullResult> hullOf(const Surface& surface, double planarity) {
  std::vector<Point> points;
  points.reserve(surface.positions.size());
  for (const Vector3& p : surface.positions)
    points.emplace_back(p.x, p.y, p.z);
  Hull hull;
  CGAL::convex_hull_3(points.begin(), points.end(), hull);
  if (hull.number_of_faces() < 4 || !CGAL::is_closed(hull)) return std::nullopt;
  HullResult result{toSurface(hull, points), {}, {}};
  result.facets = findFacets(result.hull, planarity);
  const double hullVolume = volume6(result.hull);
  if (!(hullVolume > 0)) return std::nullopt;
  result.verdict.coverage = volume6(surface) / hullVolume;

  const std::vector<Plane> planes = planesOf(result.hull);
  const FacetsAround around(surface, result.hull, result.facets);
  Bounds3 bounds;
  for (const Vector3& p : surface.positions)
    bounds.extend(Point3(p));
  const double scale = bounds.diagonal();
  HullVerdict& verdict = result.verdict;
  const auto consider = [&](const Depth& d, std::size_t t) {
    if (d.depth > verdict.depth) {
      verdict.depth = d.depth;
      verdict.place = d.place;
      verdict.triangle = std::uint32_t(t);
    }
  };
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto& v = surface.triangles[t];
    if (around.common(v) || onAFacet(result.facets, surface, v, planarity)) continue;
    const Vector3 a = surface.positions[v[0]], b = surface.positions[v[1]], c = surface.positions[v[2]];
    // The depth is concave along an edge and over a face, so the face's maximum covers its edges and corners.
    consider(depthOfTriangle(planes, a, b - a, c - a, scale), t);
  }
  return result;
}

std::vector<std::uint32_t> facetsOnHull(const Surface& surface, const Surface& hull, const Polytope& facets) {
  const FacetsAround around(surface, hull, facets);
  std::vector<std::uint32_t> result(surface.triangles.size(), 0);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (const auto common = around.common(surface.triangles[t])) {
      result[t] = *common;
      continue;
    }
    double best = INFINITY;
    for (std::uint32_t f = 0; f < facets.facets.size(); ++f) {
      const Plane& q = facets.facets[f];
      double deepest = 0;
      for (const std::uint32_t v : surface.triangles[t])
        deepest = std::max(deepest, q.offset - dot(q.normal, surface.positions[v]));
      if (deepest < best) {
        best = deepest;
        result[t] = f;
      }
    }
  }
  return result;
}

} // namespace chamfer
