#include "tests/preprocess/surface_check.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace chamfer {
namespace {

using Corners = std::array<Point3, 3>;

Corners cornersOf(const TriangleMesh& mesh, std::uint32_t triangle) {
  const auto& v = mesh.triangles[triangle];
  return {mesh.positions[v[0]], mesh.positions[v[1]], mesh.positions[v[2]]};
}

/// Largest distance of the part's corners from the border of the triangle it is a part of.
double offBorder(const Corners& part, const Corners& whole) {
  double largest = 0;
  for (const Point3& p : part) {
    double least = INFINITY;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3 edge = whole[(k + 1) % 3] - whole[k], to = p - whole[k];
      const double size = lengthSquared(edge);
      const double along = size > 0 ? std::clamp(dot(to, edge) / size, 0.0, 1.0) : 0;
      least = std::min(least, length(to - edge * along));
    }
    largest = std::max(largest, least);
  }
  return largest;
}

double distanceFromPlane(const Corners& triangle, const Corners& of) {
  const Vector3 area = cross(of[1] - of[0], of[2] - of[0]);
  double largest = 0;
  for (const Point3& p : triangle)
    largest = std::max(largest, length(area) > 0 ? std::abs(dot(area, p - of[0])) / length(area) : 0);
  return largest;
}

/// Largest distance between the corners of two triangles, in the order that makes it smallest.
double moved(const Corners& a, const Corners& b) {
  double best = INFINITY;
  std::array<std::size_t, 3> order{0, 1, 2};
  do {
    double largest = 0;
    for (std::size_t k = 0; k < 3; ++k)
      largest = std::max(largest, length(a[k] - b[order[k]]));
    best = std::min(best, largest);
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

} // namespace

std::string surfaceDefect(const Component& c, const TriangleMesh& mesh) {
  const std::size_t faces = c.triangles.size(), vertices = c.positions.size();
  if (faces < 4) return "has " + std::to_string(faces) + " triangles";
  if (c.meshTriangle.size() != faces || c.opposite.size() != 3 * faces) return "has arrays of the wrong size";
  if (!std::is_sorted(c.meshTriangle.begin(), c.meshTriangle.end())) return "is not in the file's order";
  if (2 * vertices != faces + 4) return "has another Euler characteristic than a ball";
  Bounds3 bounds;
  for (const Point3& p : c.positions)
    bounds.extend(p);
  if (!(bounds.lower == c.bounds.lower && bounds.upper == c.bounds.upper)) return "has wrong bounds";
  std::vector<bool> used(vertices);
  double volume = 0;
  for (std::size_t t = 0; t < faces; ++t) {
    const auto& v = c.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      if (v[k] >= vertices || v[k] == v[(k + 1) % 3]) return "names a wrong vertex";
      used[v[k]] = true;
      const std::uint32_t o = c.opposite[3 * t + k];
      if (o >= 3 * faces || c.opposite[o] != 3 * t + k) return "has a half-edge without its partner";
      if (c.triangles[o / 3][o % 3] != v[(k + 1) % 3] || c.triangles[o / 3][(o % 3 + 1) % 3] != v[k])
        return "has partners that do not run against each other";
    }
    const auto at = [&](std::size_t k) { return c.positions[v[k]] - bounds.centre(); };
    volume += dot(at(0), cross(at(1), at(2)));
    const Corners own{c.positions[v[0]], c.positions[v[1]], c.positions[v[2]]};
    const std::uint32_t m = c.meshTriangle[t];
    const bool part = std::count(c.meshTriangle.begin(), c.meshTriangle.end(), m) > 1;
    const Corners whole = cornersOf(mesh, m);
    if (!((part ? offBorder(own, whole) : moved(own, whole)) <= 1e-6 * bounds.diagonal()))
      return "has a triangle that is not the mesh's";
  }
  if (std::find(used.begin(), used.end(), false) != used.end()) return "has an unused vertex";
  if (!(volume > 0)) return "is inside out";
  std::vector<bool> seen(faces);
  std::vector<std::uint32_t> stack{0};
  std::size_t reached = 0;
  for (seen[0] = true; !stack.empty();) {
    const std::uint32_t t = stack.back();
    stack.pop_back();
    ++reached;
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h)
      if (const std::uint32_t n = c.opposite[h] / 3; !seen[n]) {
        seen[n] = true;
        stack.push_back(n);
      }
  }
  return reached == faces ? "" : "is not connected";
}

std::string partitionDefect(const Components& components, const TriangleMesh& mesh) {
  std::vector<int> times(mesh.triangles.size());
  std::uint32_t last = 0;
  for (std::size_t i = 0; i < components.list.size(); ++i) {
    const Component& c = components.list[i];
    if (c.meshTriangle.empty()) return "component without triangles";
    if (i > 0 && c.meshTriangle.front() <= last) return "components out of order";
    last = c.meshTriangle.front();
    for (std::size_t k = 0; k < c.meshTriangle.size(); ++k)
      times[c.meshTriangle[k]] +=
          k == 0 || c.meshTriangle[k] != c.meshTriangle[k - 1]; // parts of a split one
    for (const std::uint32_t t : c.degenerate)
      ++times[t];
    for (const auto& [dropped, repeated] : c.duplicates) {
      ++times[dropped];
      const Corners one = cornersOf(mesh, dropped), other = cornersOf(mesh, repeated);
      if (!(std::min(moved(one, other), distanceFromPlane(one, other)) <= 2e-6 * c.bounds.diagonal()))
        return "a duplicate that lies elsewhere";
    }
  }
  for (std::size_t t = 0; t < times.size(); ++t) {
    const auto& v = mesh.triangles[t];
    const std::set<std::uint32_t> distinct(v.begin(), v.end());
    if (times[t] > 1 || (times[t] == 0 && distinct.size() == 3 && components.counts.weldedVertices == 0))
      return "triangle " + std::to_string(t) + " is there " + std::to_string(times[t]) + " times";
  }
  return "";
}

} // namespace chamfer
