#include "preprocess/components/disjoint_sets.h"
#include "preprocess/core/core.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>

#include <algorithm>
#include <map>

namespace chamfer {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using DualPoint = Kernel::Point_3;
using Hull = CGAL::Surface_mesh<DualPoint>;

/// Quadruple precision: the three dual points of a sliver triangle differ in their last digits only.
using Quad = __float128;

/// The vertex of E whose dual plane passes through three dual points.
std::optional<Vector3> vertexOf(const DualPoint& a, const DualPoint& b, const DualPoint& c) {
  const Quad ux = Quad(b.x()) - a.x(), uy = Quad(b.y()) - a.y(), uz = Quad(b.z()) - a.z();
  const Quad vx = Quad(c.x()) - a.x(), vy = Quad(c.y()) - a.y(), vz = Quad(c.z()) - a.z();
  const Quad nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
  const Quad offset = nx * a.x() + ny * a.y() + nz * a.z();
  if (offset == 0) return std::nullopt;
  const Vector3 v{double(nx / offset), double(ny / offset), double(nz / offset)};
  if (!isFinite(v)) return std::nullopt;
  return v;
}

/// E before merging: a vertex per hull triangle, the cycle of triangles around each facet's dual point. The
/// hull comes in an order that differs from run to run, and so does this.
struct RawCore {
  std::vector<std::optional<DualPoint>> dual; ///< by facet
  std::vector<Vector3> vertices;
  std::vector<std::array<std::uint32_t, 3>> facets; ///< of each vertex, ascending
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  std::vector<std::vector<std::uint32_t>> cycles; ///< by facet; empty where it has no face
};

std::optional<RawCore> dualHull(std::span<const Plane> planes, double radius) {
  RawCore raw;
  std::vector<DualPoint> points;
  std::map<DualPoint, std::uint32_t> facetOf; // of two equal planes one keeps the face
  points.reserve(planes.size());
  for (std::uint32_t f = 0; f < planes.size(); ++f) {
    const Plane& p = planes[f];
    const double clearance = p.offset - radius;
    if (!(clearance > 0)) return std::nullopt;
    const Vector3 d = p.normal / clearance;
    if (!isFinite(d)) return std::nullopt;
    points.emplace_back(d.x, d.y, d.z);
    raw.dual.push_back(points.back());
    facetOf.emplace(points.back(), f);
  }
  Hull hull;
  CGAL::convex_hull_3(points.begin(), points.end(), hull);
  if (hull.number_of_faces() < 4 || !CGAL::is_closed(hull)) return std::nullopt;

  std::vector<std::uint32_t> vertexOfFace(hull.num_faces());
  for (const auto face : hull.faces()) {
    const auto h = hull.halfedge(face);
    std::array<std::uint32_t, 3> facets{facetOf.at(hull.point(hull.source(h))),
                                        facetOf.at(hull.point(hull.target(h))),
                                        facetOf.at(hull.point(hull.target(hull.next(h))))};
    std::sort(facets.begin(), facets.end());
    const auto v = vertexOf(points[facets[0]], points[facets[1]], points[facets[2]]);
    if (!v) return std::nullopt;
    vertexOfFace[std::size_t(face)] = std::uint32_t(raw.vertices.size());
    raw.vertices.push_back(*v);
    raw.facets.push_back(facets);
  }
  for (const auto edge : hull.edges()) {
    const auto h = hull.halfedge(edge);
    raw.edges.emplace_back(vertexOfFace[std::size_t(hull.face(h))],
                           vertexOfFace[std::size_t(hull.face(hull.opposite(h)))]);
  }
  raw.cycles.resize(planes.size());
  for (const auto v : hull.vertices()) {
    auto& cycle = raw.cycles[facetOf.at(hull.point(v))];
    // Counter-clockwise seen from outside, for the dual as for the primal.
    const auto first = hull.halfedge(v); // its target is v
    auto h = first;
    do {
      cycle.push_back(vertexOfFace[std::size_t(hull.face(h))]);
      h = hull.prev(hull.opposite(h));
    } while (h != first);
  }
  return raw;
}

/// Removes repetitions and spikes (a, b, a) from a closed cycle; empty when fewer than three corners stay.
void tidy(std::vector<std::uint32_t>& cycle) {
  for (bool changed = true; changed && cycle.size() >= 3;) {
    changed = false;
    for (std::size_t i = 0; i < cycle.size() && cycle.size() >= 3; ++i) {
      const std::size_t j = (i + 1) % cycle.size(), k = (i + 2) % cycle.size();
      if (cycle[i] == cycle[j]) {
        cycle.erase(cycle.begin() + std::ptrdiff_t(j));
        changed = true;
        break;
      }
      if (cycle[i] == cycle[k]) {
        cycle.erase(cycle.begin() + std::ptrdiff_t(std::max(j, k)));
        cycle.erase(cycle.begin() + std::ptrdiff_t(std::min(j, k)));
        changed = true;
        break;
      }
    }
  }
  if (cycle.size() < 3) cycle.clear();
}

/// Every directed edge once, its reverse once, and Euler's formula: the loops are the surface of a polytope.
bool closedSphere(const Core& core) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> directed;
  std::size_t faces = 0;
  for (std::size_t f = 0; f < core.loops.size(); ++f) {
    const auto loop = core.loops[f];
    faces += !loop.empty();
    for (std::size_t i = 0; i < loop.size(); ++i)
      directed.emplace_back(loop[i], loop[(i + 1) % loop.size()]);
  }
  std::sort(directed.begin(), directed.end());
  if (std::adjacent_find(directed.begin(), directed.end()) != directed.end()) return false;
  for (const auto& [a, b] : directed)
    if (!std::binary_search(directed.begin(), directed.end(), std::pair(b, a))) return false;
  return core.vertices.size() >= 4 && faces >= 4 && core.vertices.size() + faces == directed.size() / 2 + 2;
}

/// The vertex where more than three facets meet: from the three of them that are farthest from a pencil of
/// planes, taken in ascending order, so that it does not depend on how the hull was triangulated.
std::optional<Vector3> vertexOfMany(const RawCore& raw, std::span<const Plane> planes,
                                    const std::vector<std::uint32_t>& facets) {
  const Vector3 first = planes[facets[0]].normal;
  std::uint32_t second = facets[0], third = facets[0];
  double widest = -1, deepest = -1;
  for (const std::uint32_t f : facets)
    if (const double w = lengthSquared(cross(first, planes[f].normal)); w > widest) {
      widest = w;
      second = f;
    }
  const Vector3 pencil = cross(first, planes[second].normal);
  for (const std::uint32_t f : facets)
    if (const double d = std::abs(dot(pencil, planes[f].normal)); d > deepest) {
      deepest = d;
      third = f;
    }
  std::array<std::uint32_t, 3> triple{facets[0], second, third};
  std::sort(triple.begin(), triple.end());
  return vertexOf(*raw.dual[triple[0]], *raw.dual[triple[1]], *raw.dual[triple[2]]);
}

std::optional<Core> merged(const RawCore& raw, std::span<const Plane> planes, double tolerance) {
  DisjointSets sets(raw.vertices.size());
  for (const auto& [a, b] : raw.edges)
    if (lengthSquared(raw.vertices[a] - raw.vertices[b]) <= tolerance * tolerance) sets.join(a, b);
  // A merged vertex is known by its facets; in their order it gets its number.
  std::map<std::uint32_t, std::vector<std::uint32_t>> facetsOfRoot;
  for (std::uint32_t i = 0; i < raw.vertices.size(); ++i) {
    auto& facets = facetsOfRoot[sets.find(i)];
    facets.insert(facets.end(), raw.facets[i].begin(), raw.facets[i].end());
  }
  std::map<std::vector<std::uint32_t>, std::uint32_t> rootOfFacets;
  for (auto& [root, facets] : facetsOfRoot) {
    std::sort(facets.begin(), facets.end());
    facets.erase(std::unique(facets.begin(), facets.end()), facets.end());
    if (!rootOfFacets.emplace(facets, root).second) return std::nullopt;
  }
  std::vector<std::uint32_t> name(raw.vertices.size());
  Core core;
  for (const auto& [facets, root] : rootOfFacets) {
    name[root] = std::uint32_t(core.vertices.size());
    const auto v = facets.size() == 3 ? std::optional(raw.vertices[root]) : vertexOfMany(raw, planes, facets);
    if (!v) return std::nullopt;
    core.vertices.push_back(*v);
  }
  std::vector<std::uint32_t> cycle;
  std::vector<bool> used(core.vertices.size(), false);
  for (const auto& rawCycle : raw.cycles) {
    cycle.clear();
    for (const std::uint32_t v : rawCycle)
      cycle.push_back(name[sets.find(v)]);
    tidy(cycle);
    if (!cycle.empty()) std::rotate(cycle.begin(), std::min_element(cycle.begin(), cycle.end()), cycle.end());
    for (const std::uint32_t v : cycle)
      used[v] = true;
    core.loops.items.insert(core.loops.items.end(), cycle.begin(), cycle.end());
    core.loops.close();
  }
  if (std::find(used.begin(), used.end(), false) != used.end() || !closedSphere(core)) return std::nullopt;
  return core;
}

} // namespace

std::optional<Core> exactCore(std::span<const Plane> planes, double radius, const MergeTolerance& tolerance,
                              const std::function<void(double)>& share) {
  const auto raw = dualHull(planes, radius);
  if (!raw) return std::nullopt;
  double done = 0.5;
  for (double t = tolerance.preferred; t > tolerance.least; t /= 4) {
    share(done);
    if (auto core = merged(*raw, planes, t)) return core;
    done += 0.5 * (1 - done);
  }
  share(done);
  return merged(*raw, planes, tolerance.least);
}

} // namespace chamfer
