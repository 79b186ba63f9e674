#include "preprocess/components/orient.h"

#include <utility>

namespace chamfer {
namespace {

constexpr std::uint8_t kUnseen = 2;

/// Where a half-edge is after its triangle was turned: (a, b, c) became (a, c, b).
std::uint32_t turnedHalfEdge(std::uint32_t h) { return h - h % 3 + (2 - h % 3); }

} // namespace

Consistency findConsistentTurns(const HalfEdges& surface, std::vector<std::uint8_t>& turn,
                                std::vector<std::uint32_t>& stack) {
  Consistency result;
  turn.assign(surface.triangles.size(), kUnseen);
  stack.assign(1, 0);
  turn[0] = 0;
  while (!stack.empty()) {
    const std::uint32_t t = stack.back();
    stack.pop_back();
    ++result.reached;
    result.turned += turn[t];
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      const std::uint32_t o = surface.opposite[h];
      if (o == kNone) continue;
      const std::uint8_t wanted = std::uint8_t(turn[t] ^ (surface.start(h) == surface.start(o)));
      if (turn[o / 3] == kUnseen) {
        turn[o / 3] = wanted;
        stack.push_back(o / 3);
      } else if (turn[o / 3] != wanted)
        result.orientable = false;
    }
  }
  return result;
}

void turnTriangles(std::span<const std::uint8_t> turn, std::span<Triangle> triangles,
                   std::vector<std::uint32_t>& opposite) {
  const auto moved = [&](std::uint32_t h) { return h != kNone && turn[h / 3] == 1 ? turnedHalfEdge(h) : h; };
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    if (turn[t] == 1) {
      std::swap(triangles[t][1], triangles[t][2]);
      std::swap(opposite[3 * t], opposite[3 * t + 2]);
    }
  for (std::uint32_t& o : opposite)
    o = moved(o);
}

void turnAll(std::span<Triangle> triangles, std::vector<std::uint32_t>& opposite) {
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    std::swap(triangles[t][1], triangles[t][2]);
    std::swap(opposite[3 * t], opposite[3 * t + 2]);
  }
  for (std::uint32_t& o : opposite)
    if (o != kNone) o = turnedHalfEdge(o);
}

Extent measure(std::span<const Triangle> triangles, std::span<const Point3> positions,
               const Bounds3& bounds) {
  const Point3 centre = bounds.centre();
  const double scale = 1 / bounds.diagonal();
  Extent extent;
  for (const Triangle& t : triangles) {
    const Vector3 a = (positions[t[0]] - centre) * scale, b = (positions[t[1]] - centre) * scale,
                  c = (positions[t[2]] - centre) * scale;
    const Vector3 twiceArea = cross(b - a, c - a);
    extent.volume += dot(a, twiceArea);
    extent.area += length(twiceArea);
  }
  extent.volume /= 6;
  extent.area /= 2;
  return extent;
}

} // namespace chamfer
