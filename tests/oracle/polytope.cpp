#include "tests/oracle/polytope.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace chamfer::oracle {
namespace {

constexpr std::uint32_t kFrame = 0xffffffffu; // an edge of the square that the cutting starts from

/// A corner of a polygon and the plane that made the edge from here to the next corner.
struct Corner {
  Vec3 point;
  std::uint32_t edge;
};
using Polygon = std::vector<Corner>;

Polygon squareIn(const Plane& plane, Real reach) {
  Vec3 axis = Vec3::Zero();
  Eigen::Index least = 0;
  plane.normal.cwiseAbs().minCoeff(&least);
  axis[least] = 1;
  const Vec3 u = plane.normal.cross(axis).normalized() * (2 * reach);
  const Vec3 v = plane.normal.cross(u);
  const Vec3 centre = plane.normal * plane.offset;
  return {
      {centre + u + v, kFrame}, {centre - u + v, kFrame}, {centre - u - v, kFrame}, {centre + u - v, kFrame}};
}

struct Ball {
  Vec3 centre;
  Real radius;
};

Ball ballAround(const Polygon& polygon) {
  Ball ball{Vec3::Zero(), 0};
  for (const Corner& c : polygon)
    ball.centre += c.point;
  ball.centre /= Real(polygon.size());
  for (const Corner& c : polygon)
    ball.radius = std::max(ball.radius, (c.point - ball.centre).norm());
  return ball;
}

/// Sutherland and Hodgman's step: keeps what lies in `plane`'s half-space, and names the new edge after it.
void clip(Polygon& polygon, const Plane& plane, std::uint32_t name, Polygon& scratch) {
  scratch.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Corner& here = polygon[i];
    const Corner& next = polygon[i + 1 < polygon.size() ? i + 1 : 0];
    const Real s = plane.normal.dot(here.point) - plane.offset;
    const Real e = plane.normal.dot(next.point) - plane.offset;
    if (s <= 0) scratch.push_back(here);
    if ((s <= 0) == (e <= 0)) continue;
    const Vec3 crossing = here.point + (next.point - here.point) * (s / (s - e));
    scratch.push_back({crossing, s <= 0 ? name : here.edge});
  }
  polygon.swap(scratch);
}

/// Planes that pass the polygon within `noise` do not cut it: where many meet in a point they would only chop
/// up rounding errors.
Polygon facePolygon(std::span<const Plane> planes, std::uint32_t face, Real reach, Real noise,
                    Polygon& scratch) {
  Polygon polygon = squareIn(planes[face], reach);
  Ball ball = ballAround(polygon);
  for (std::uint32_t other = 0; other < planes.size() && !polygon.empty(); ++other) {
    if (other == face) continue;
    const Plane& plane = planes[other];
    if (plane.normal.dot(ball.centre) + ball.radius * (1 + 1e-9L) <= plane.offset) continue;
    const auto inside = [&](const Corner& c) { return plane.normal.dot(c.point) <= plane.offset + noise; };
    if (std::all_of(polygon.begin(), polygon.end(), inside)) continue;
    clip(polygon, plane, other, scratch);
    if (!polygon.empty()) ball = ballAround(polygon);
  }
  return polygon;
}

/// For each point the index of the point that stands for its cluster.
std::vector<std::uint32_t> clusters(const std::vector<Vec3>& points, Real distance) {
  std::vector<std::uint32_t> order(points.size()), parent(points.size());
  std::iota(order.begin(), order.end(), 0u);
  std::iota(parent.begin(), parent.end(), 0u);
  std::sort(order.begin(), order.end(), [&](auto i, auto j) { return points[i].x() < points[j].x(); });
  const auto root = [&](std::uint32_t i) {
    while (parent[i] != i)
      i = parent[i] = parent[parent[i]];
    return i;
  };
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const Vec3 gap = points[order[j]] - points[order[i]];
      if (gap.x() > distance) break;
      if (gap.norm() <= distance) parent[root(order[j])] = root(order[i]);
    }
  }
  for (std::uint32_t i = 0; i < parent.size(); ++i)
    parent[i] = root(i);
  return parent;
}

/// The polygons as loops over shared vertices.
Polytope assemble(const std::vector<Polygon>& polygons, Real distance) {
  std::vector<Vec3> points;
  for (const Polygon& polygon : polygons)
    for (const Corner& corner : polygon)
      points.push_back(corner.point);
  const std::vector<std::uint32_t> cluster = clusters(points, distance);

  Polytope result;
  std::vector<std::uint32_t> compact(points.size(), kFrame);
  const auto vertex = [&](std::uint32_t id) {
    if (compact[id] == kFrame) {
      compact[id] = std::uint32_t(result.vertices.size());
      result.vertices.push_back(points[id]);
    }
    return compact[id];
  };
  struct Side {
    std::uint32_t face, beyond; // the polygon's own plane, and the one that cut it here
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, Side> sides;
  std::size_t next = 0, faceCount = 0;
  bool simple = true;
  for (const Polygon& polygon : polygons) {
    std::vector<std::uint32_t> loop, beyond;
    for (const Corner& corner : polygon) {
      const std::uint32_t id = cluster[next++];
      if (!loop.empty() && loop.back() == id) {
        beyond.back() = corner.edge;
        continue;
      }
      loop.push_back(id);
      beyond.push_back(corner.edge);
    }
    while (loop.size() > 1 && loop.front() == loop.back())
      loop.pop_back();
    if (loop.size() < 3) loop.clear();
    const auto face = std::uint32_t(result.faces.size());
    for (std::uint32_t& id : loop)
      id = vertex(id);
    for (std::size_t i = 0; i < loop.size(); ++i)
      simple &= sides.emplace(std::pair(loop[i], loop[(i + 1) % loop.size()]), Side{face, beyond[i]}).second;
    faceCount += !loop.empty();
    result.faces.push_back(std::move(loop));
  }
  for (const auto& [ends, side] : sides) {
    const auto twin = sides.find({ends.second, ends.first});
    const bool paired = twin != sides.end() && twin->second.face != side.face;
    simple &= paired;
    if (!paired)
      result.edges.push_back({ends.first, ends.second, side.face, side.beyond});
    else if (ends.first < ends.second)
      result.edges.push_back({ends.first, ends.second, side.face, twin->second.face});
  }
  result.closed = simple && result.vertices.size() + faceCount == result.edges.size() + 2;
  return result;
}

} // namespace

Polytope intersectHalfSpaces(std::span<const Plane> planes, Real reach, Real weld) {
  std::vector<Polygon> polygons;
  Polygon scratch;
  const auto cut = [&](Real from) {
    polygons.clear();
    bool any = false;
    for (std::uint32_t face = 0; face < planes.size(); ++face) {
      polygons.push_back(facePolygon(planes, face, from, weld * reach / 10, scratch));
      for (const Corner& corner : polygons.back()) {
        any = true;
        if (corner.edge == kFrame) return false;
      }
    }
    if (!any) throw std::runtime_error("half-spaces: the intersection is empty");
    return true;
  };
  Real from = reach;
  while (!cut(from))
    if ((from *= 10) > 1e4L * reach) throw std::runtime_error("half-spaces: the intersection is unbounded");
  Polytope polytope = assemble(polygons, weld * reach);
  for (Real tolerance = weld; !polytope.closed && tolerance < 1e-8L;) {
    Polytope coarser = assemble(polygons, (tolerance *= 10) * reach);
    if (coarser.closed) polytope = std::move(coarser);
  }
  return polytope;
}

Vec3 loopNormal(std::span<const Vec3> loop) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < loop.size(); ++i)
    sum += (loop[i] - loop[0]).cross(loop[i + 1] - loop[0]);
  return sum / 2;
}

} // namespace chamfer::oracle
