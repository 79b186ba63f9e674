#include "preprocess/core.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>

#include <algorithm>
#include <map>
#include <numeric>

namespace chamfer {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using DualPoint = Kernel::Point_3;
using Hull = CGAL::Surface_mesh<DualPoint>;

/// Quadruple precision: the three dual points of a sliver triangle differ in their last digits only.
using Quad = __float128;

/// The vertex of E, relative to the dual's centre, whose dual plane passes through three dual points.
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

class UnionFind {
public:
  explicit UnionFind(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i)
      i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

private:
  std::vector<std::uint32_t> parent_;
};

/// E before merging: a vertex per hull triangle, the cycle of triangles around each facet's dual point.
struct RawCore {
  std::vector<Vector3> vertices;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  std::vector<std::vector<std::uint32_t>> cycles; ///< by facet; empty where it has no face
};

std::optional<RawCore> dualHull(std::span<const Plane> planes, double radius, const Vector3& centre) {
  std::vector<DualPoint> points;
  std::map<DualPoint, std::uint32_t> facetOf; // of two equal planes one keeps the face
  points.reserve(planes.size());
  for (std::uint32_t f = 0; f < planes.size(); ++f) {
    const Plane& p = planes[f];
    const double clearance = p.offset - radius - dot(p.normal, centre);
    if (!(clearance > 0)) return std::nullopt;
    const Vector3 d = p.normal / clearance;
    if (!isFinite(d)) return std::nullopt;
    points.emplace_back(d.x, d.y, d.z);
    facetOf.emplace(points.back(), f);
  }
  Hull hull;
  CGAL::convex_hull_3(points.begin(), points.end(), hull);
  if (hull.number_of_faces() < 4 || !CGAL::is_closed(hull)) return std::nullopt;

  RawCore raw;
  std::vector<std::uint32_t> vertexOfFace(hull.num_faces());
  for (const auto face : hull.faces()) {
    const auto h = hull.halfedge(face);
    const auto v = vertexOf(hull.point(hull.source(h)), hull.point(hull.target(h)),
                            hull.point(hull.target(hull.next(h))));
    if (!v) return std::nullopt;
    vertexOfFace[std::size_t(face)] = std::uint32_t(raw.vertices.size());
    raw.vertices.push_back(centre + *v);
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

std::optional<Core> merged(const RawCore& raw, double tolerance) {
  UnionFind sets(raw.vertices.size());
  for (const auto& [a, b] : raw.edges)
    if (lengthSquared(raw.vertices[a] - raw.vertices[b]) <= tolerance * tolerance) sets.join(a, b);
  std::vector<std::uint32_t> name(raw.vertices.size(), 0xffffffffu);
  std::vector<std::size_t> members;
  Core core;
  for (std::uint32_t i = 0; i < raw.vertices.size(); ++i) {
    const std::uint32_t root = sets.find(i);
    if (name[root] == 0xffffffffu) {
      name[root] = std::uint32_t(core.vertices.size());
      core.vertices.push_back({0, 0, 0});
      members.push_back(0);
    }
    // The mean of the merged vertices: E is convex, so it lies in E.
    core.vertices[name[root]] += raw.vertices[i];
    ++members[name[root]];
  }
  for (std::size_t i = 0; i < core.vertices.size(); ++i)
    core.vertices[i] = core.vertices[i] / double(members[i]);
  std::vector<std::uint32_t> cycle;
  std::vector<bool> used(core.vertices.size(), false);
  for (const auto& rawCycle : raw.cycles) {
    cycle.clear();
    for (const std::uint32_t v : rawCycle)
      cycle.push_back(name[sets.find(v)]);
    tidy(cycle);
    for (const std::uint32_t v : cycle)
      used[v] = true;
    core.loops.items.insert(core.loops.items.end(), cycle.begin(), cycle.end());
    core.loops.close();
  }
  if (std::find(used.begin(), used.end(), false) != used.end() || !closedSphere(core)) return std::nullopt;
  return core;
}

} // namespace

std::optional<Core> exactCore(std::span<const Plane> planes, double radius, const InnerBall& inner,
                              const MergeTolerance& tolerance) {
  const auto raw = dualHull(planes, radius, inner.centre);
  if (!raw) return std::nullopt;
  for (double t = tolerance.preferred; t > tolerance.least; t /= 4)
    if (auto core = merged(*raw, t)) return core;
  return merged(*raw, tolerance.least);
}

} // namespace chamfer
