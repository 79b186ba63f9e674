#include "preprocess/components/diagonals.h"

#include "common/text.h"
#include "preprocess/components/disjoint_sets.h"
#include "preprocess/components/half_edges.h"
#include "preprocess/components/solids.h"
#include "preprocess/components/weld.h"

#include <algorithm>
#include <map>
#include <numeric>

namespace chamfer {
namespace {

/// A polygon, from the fan that its reader made of it.
struct Polygon {
  std::uint32_t first = 0, count = 0;      ///< triangles of the mesh
  std::vector<std::uint32_t> corners, uvs; ///< uvs empty where the mesh has none
  double warp = 0, size = 0;               ///< mesh units
};

/// Twice the vector area of the loop.
Vector3 areaOf(const TriangleMesh& mesh, const Polygon& p) {
  Vector3 area;
  for (std::size_t i = 1; i + 1 < p.corners.size(); ++i) {
    const Point3& origin = mesh.positions[p.corners[0]];
    area += cross(mesh.positions[p.corners[i]] - origin, mesh.positions[p.corners[i + 1]] - origin);
  }
  return area;
}

/// The polygon that begins with triangle `first`; no corners where its triangles are no fan.
Polygon polygonAt(const TriangleMesh& mesh, std::uint32_t first) {
  Polygon p{first, 1, {}, {}, 0, 0};
  const auto& faces = mesh.faceOfTriangle;
  while (first + p.count < faces.size() && faces[first + p.count] == faces[first])
    ++p.count;
  const Triangle& start = mesh.triangles[first];
  p.corners.assign(start.begin(), start.end());
  for (std::uint32_t t = first + 1; t < first + p.count; ++t) {
    const Triangle& next = mesh.triangles[t];
    if (next[0] != p.corners.front() || next[1] != p.corners.back()) {
      p.corners.clear();
      return p;
    }
    p.corners.push_back(next[2]);
  }
  if (!mesh.uvTriangles.empty()) {
    p.uvs = {mesh.uvTriangles[first][0], mesh.uvTriangles[first][1]};
    for (std::uint32_t t = first; t < first + p.count; ++t)
      p.uvs.push_back(mesh.uvTriangles[t][2]);
  }
  const Point3 origin = mesh.positions[p.corners[0]];
  Vector3 mean;
  Bounds3 box;
  for (const std::uint32_t v : p.corners) {
    mean += (mesh.positions[v] - origin) / double(p.corners.size());
    box.extend(mesh.positions[v]);
  }
  p.size = box.diagonal();
  const Vector3 area = areaOf(mesh, p);
  if (!(length(area) > 0)) return p;
  const Vector3 normal = normalize(area);
  for (const std::uint32_t v : p.corners)
    p.warp = std::max(p.warp, std::abs(dot(normal, mesh.positions[v] - origin - mean)));
  return p;
}

/// Half the distance between a quadrilateral's diagonals: with more than this the fan may lie deeper below
/// its hull than the default tolerance lets pass.
double leastWarp(double diagonal) { return 0.5 * InputTolerances{}.convexity * diagonal; }

/// Triangulates a polygon, given by its corners' places, so that seen along `outward` no diagonal lies below
/// the one that crosses it. Begins with the fan and exchanges diagonals; a corner that is not convex keeps
/// what it has.
std::vector<Triangle> bulging(const std::vector<Vector3>& corners, const Vector3& outward) {
  const auto count = std::uint32_t(corners.size());
  const auto turn = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    return dot(outward, cross(corners[b] - corners[a], corners[c] - corners[a]));
  };
  std::vector<Triangle> triangles;
  std::map<std::array<std::uint32_t, 2>, std::uint32_t> left; // by directed edge: the third corner
  const auto put = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    left[{a, b}] = c;
    left[{b, c}] = a;
    left[{c, a}] = b;
  };
  std::vector<std::array<std::uint32_t, 2>> open; // diagonals to look at
  for (std::uint32_t i = 1; i + 1 < count; ++i) {
    put(0, i, i + 1);
    if (i > 1) open.push_back({0, i});
  }
  for (std::size_t steps = 100 * corners.size() + 1000; !open.empty() && steps > 0; --steps) {
    const auto [a, c] = open.back();
    open.pop_back();
    const auto one = left.find({a, c}), other = left.find({c, a});
    if (one == left.end() || other == left.end()) continue;
    const std::uint32_t d = one->second, b = other->second; // around: a b c d
    // Above the plane of (a, b, c), where that is seen from outside.
    const Vector3 normal = cross(corners[b] - corners[a], corners[c] - corners[a]);
    const double above = dot(normal, corners[d] - corners[a]);
    const double size = lengthSquared(corners[c] - corners[a]) + lengthSquared(corners[d] - corners[b]);
    if (!(above > 1e-12 * size * std::sqrt(size)) || !(turn(a, b, d) > 0) || !(turn(b, c, d) > 0)) continue;
    left.erase(one);
    left.erase(other);
    put(a, b, d);
    put(b, c, d);
    for (const auto& edge : {std::array{a, b}, std::array{b, c}, std::array{c, d}, std::array{d, a}})
      open.push_back(edge);
  }
  for (auto edge = left.begin(); edge != left.end(); ++edge) {
    const auto [a, b] = edge->first;
    if (a < b && a < edge->second) triangles.push_back({a, b, edge->second});
  }
  return triangles;
}

void retriangulate(TriangleMesh& mesh, const Polygon& p, const std::vector<Triangle>& by) {
  for (std::uint32_t i = 0; i < p.count; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      mesh.triangles[p.first + i][k] = p.corners[by[i][k]];
      if (!p.uvs.empty()) mesh.uvTriangles[p.first + i][k] = p.uvs[by[i][k]];
    }
}

std::vector<Triangle> fanOf(std::size_t corners) {
  std::vector<Triangle> fan;
  for (std::uint32_t i = 1; i + 1 < corners; ++i)
    fan.push_back({0, i, i + 1});
  return fan;
}

/// Does no neighbour rise above a triangle by more than the default tolerance? Slivers, whose planes mean
/// nothing, are not asked.
bool locallyConvex(const Component& c) {
  const double diagonal = c.bounds.diagonal(), tolerance = InputTolerances{}.convexity * diagonal;
  const double sliver = 4 * InputTolerances{}.planarity * diagonal;
  const HalfEdges surface{c.triangles, c.opposite};
  for (std::uint32_t t = 0; t < c.triangles.size(); ++t) {
    const Point3& a = c.positions[c.triangles[t][0]];
    const Vector3 u = c.positions[c.triangles[t][1]] - a, v = c.positions[c.triangles[t][2]] - a;
    const Vector3 area = cross(u, v);
    const double twice = length(area);
    if (!(twice > sliver * std::max({length(u), length(v), length(v - u)}))) continue;
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      const Point3& apex = c.positions[surface.start(previousHalfEdge(c.opposite[h]))];
      if (dot(area, apex - a) > tolerance * twice) return false;
    }
  }
  return true;
}

/// Of each component without fault that has a polygon whose warp matters: all warped ones.
template <class Each>
void forWarped(const Components& components, const std::vector<Polygon>& polygons, std::size_t triangles,
               const Each& each) {
  std::vector<std::uint32_t> polygonOf(triangles, kNone);
  for (std::uint32_t p = 0; p < polygons.size(); ++p)
    for (std::uint32_t t = polygons[p].first; t < polygons[p].first + polygons[p].count; ++t)
      polygonOf[t] = p;
  for (const Component& c : components.list) {
    if (c.fault) continue;
    std::vector<std::uint32_t> here;
    bool any = false;
    for (const std::uint32_t t : c.meshTriangle) {
      const std::uint32_t p = polygonOf[t];
      if (p == kNone || (!here.empty() && here.back() == p)) continue;
      here.push_back(p);
      any = any || polygons[p].warp > leastWarp(c.bounds.diagonal());
    }
    if (any) each(c, here);
  }
}

/// Twice the vector area of each polygon's loop, turned away from the middle of what it hangs together with,
/// by index or by position: outwards on a convex solid, whatever its fans are like.
std::vector<Vector3> awayFromMiddle(const TriangleMesh& mesh, const std::vector<Polygon>& polygons,
                                    bool byPosition) {
  std::vector<std::uint32_t> standsFor(mesh.positions.size());
  std::iota(standsFor.begin(), standsFor.end(), 0u);
  if (byPosition) weldExact(mesh.triangles, mesh.positions, standsFor);
  DisjointSets pieces(mesh.positions.size());
  for (const Triangle& t : mesh.triangles)
    pieces.join(pieces.join(standsFor[t[0]], standsFor[t[1]]), standsFor[t[2]]);
  struct Middle {
    Vector3 sum;
    double count = 0;
  };
  std::vector<Middle> middles(mesh.positions.size());
  std::vector<bool> seen(mesh.positions.size());
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) {
      if (seen[standsFor[v]]) continue;
      seen[standsFor[v]] = true;
      Middle& m = middles[pieces.find(standsFor[v])];
      m.sum += Vector3(mesh.positions[v]);
      ++m.count;
    }
  std::vector<Vector3> outward;
  for (const Polygon& p : polygons) {
    const Vector3 area = areaOf(mesh, p);
    double away = 0;
    for (const std::uint32_t v : p.corners) {
      const Middle& m = middles[pieces.find(standsFor[v])];
      away += dot(area, Vector3(mesh.positions[v]) - m.sum / m.count);
    }
    outward.push_back(away < 0 ? -area : area);
  }
  return outward;
}

/// Gives each polygon the triangulation that bulges that way.
void bulge(TriangleMesh& mesh, const Polygon& p, const Vector3& outward) {
  if (p.corners.empty() || !(length(outward) > 0)) return;
  std::vector<Vector3> corners;
  for (const std::uint32_t v : p.corners)
    corners.push_back(mesh.positions[v] - mesh.positions[p.corners[0]]);
  // The corners run clockwise seen from outside where the file's faces look inwards.
  const bool inwards = dot(areaOf(mesh, p), outward) < 0;
  if (inwards) std::reverse(corners.begin(), corners.end());
  std::vector<Triangle> by = bulging(corners, normalize(outward));
  if (by.size() != p.count) return;
  const auto last = std::uint32_t(corners.size() - 1);
  for (Triangle& t : by)
    if (inwards) t = {last - t[2], last - t[1], last - t[0]};
  retriangulate(mesh, p, by);
}

} // namespace

Warp warpOf(const TriangleMesh& mesh, std::size_t triangle) {
  if (triangle >= mesh.faceOfTriangle.size()) return {};
  auto first = std::uint32_t(triangle);
  while (first > 0 && mesh.faceOfTriangle[first - 1] == mesh.faceOfTriangle[triangle])
    --first;
  const Polygon p = polygonAt(mesh, first);
  return {p.warp, std::size_t(p.count) + 2};
}

void chooseDiagonals(TriangleMesh& mesh) {
  std::vector<Polygon> warped;
  bool matters = false;
  for (std::uint32_t t = 0; t < mesh.faceOfTriangle.size();) {
    if (t + 1 == mesh.faceOfTriangle.size() || mesh.faceOfTriangle[t + 1] != mesh.faceOfTriangle[t]) {
      ++t;
      continue;
    }
    Polygon p = polygonAt(mesh, t);
    t += p.count;
    matters = matters || p.warp > leastWarp(p.size); // a component is larger
    if (p.warp > InputTolerances{}.planarity * p.size) warped.push_back(std::move(p));
  }
  if (!matters) return;

  std::vector<bool> chosen(warped.size());
  for (const bool byPosition : {false, true}) {
    const std::vector<Vector3> outward = awayFromMiddle(mesh, warped, byPosition);
    for (std::size_t i = 0; i < warped.size(); ++i)
      if (!chosen[i]) bulge(mesh, warped[i], outward[i]);
    forWarped(splitComponents(mesh, {}), warped, mesh.triangles.size(),
              [&](const Component& c, const std::vector<std::uint32_t>& here) {
                // Where faces look both ways, a polygon may be something else than a side of a solid.
                if (!locallyConvex(c) || (c.turnedTriangles > 0 && !c.turned)) return;
                for (const std::uint32_t i : here)
                  chosen[i] = true;
              });
    if (std::find(chosen.begin(), chosen.end(), false) == chosen.end()) break;
  }
  std::size_t count = 0, most = 0;
  for (std::size_t i = 0; i < warped.size(); ++i) {
    if (!chosen[i]) {
      if (!warped[i].corners.empty()) retriangulate(mesh, warped[i], fanOf(warped[i].corners.size()));
      continue;
    }
    if (count++ == 0 || warped[i].warp > warped[most].warp) most = i;
  }
  if (count > 0)
    mesh.warnings.push_back(
        placeOfTriangle(mesh, warped[most].first) + " is warped: its corners lie up to " +
        numberText(warped[most].warp, 3) + " off one plane" +
        (count > 1 ? " (" + std::to_string(count - 1) + " more faces are warped less)" : "") +
        "; of its triangulations the convex one is taken");
}

} // namespace chamfer
