#include "preprocess/core/polytope.h"

#include <algorithm>
#include <numeric>

namespace chamfer {
namespace {

std::uint32_t nextInTriangle(std::uint32_t edge) { return edge % 3 == 2 ? edge - 2 : edge + 1; }

struct TriangleShape {
  Vector3 area;          ///< vector area
  double height;         ///< lowest height
  std::uint32_t longest; ///< edge 0..2
};

TriangleShape shapeOf(const Surface& s, std::size_t t) {
  const auto& v = s.triangles[t];
  const Vector3 a = s.positions[v[0]], b = s.positions[v[1]], c = s.positions[v[2]];
  TriangleShape shape{cross(b - a, c - a) * 0.5, 0, 0};
  const double edges[3] = {lengthSquared(b - a), lengthSquared(c - b), lengthSquared(a - c)};
  shape.longest = std::uint32_t(std::max_element(edges, edges + 3) - edges);
  const double longest = std::sqrt(edges[shape.longest]);
  shape.height = longest > 0 ? 2 * length(shape.area) / longest : 0;
  return shape;
}

class FacetFinder {
public:
  FacetFinder(const Surface& surface, double tolerance) : s_(surface), tolerance_(tolerance) {}

  Polytope run() {
    measure();
    grow();
    joinSlivers();
    fitPlanes();
    traceLoops();
    return std::move(result_);
  }

private:
  void measure() {
    const std::size_t n = s_.triangles.size();
    shapes_.resize(n);
    for (std::size_t t = 0; t < n; ++t)
      shapes_[t] = shapeOf(s_, t);
    order_.resize(n);
    std::iota(order_.begin(), order_.end(), 0u);
    std::vector<double> size(n);
    for (std::size_t t = 0; t < n; ++t)
      size[t] = lengthSquared(shapes_[t].area);
    std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
      return size[a] != size[b] ? size[a] > size[b] : a < b;
    });
    result_.facetOfTriangle.assign(n, kUnset);
  }

  bool sliver(std::size_t t) const { return shapes_[t].height <= 4 * tolerance_; }

  bool inPlane(std::size_t t, const Vector3& n, double d) const {
    for (const std::uint32_t v : s_.triangles[t])
      if (std::abs(dot(n, s_.positions[v]) - d) > tolerance_) return false;
    return sliver(t) || dot(shapes_[t].area, n) > 0;
  }

  void grow() {
    auto& facetOf = result_.facetOfTriangle;
    std::vector<std::uint32_t> stack;
    std::uint32_t count = 0;
    for (const std::uint32_t seed : order_) {
      if (facetOf[seed] != kUnset || sliver(seed)) continue;
      const Vector3 n = normalize(shapes_[seed].area);
      const auto& v = s_.triangles[seed];
      const double d = dot(n, s_.positions[v[0]] + s_.positions[v[1]] + s_.positions[v[2]]) / 3;
      facetOf[seed] = count;
      stack.assign(1, seed);
      while (!stack.empty()) {
        const std::uint32_t t = stack.back();
        stack.pop_back();
        for (std::uint32_t k = 0; k < 3; ++k) {
          const std::uint32_t other = s_.opposite[3 * t + k] / 3;
          if (facetOf[other] != kUnset || !inPlane(other, n, d)) continue;
          facetOf[other] = count;
          stack.push_back(other);
        }
      }
      ++count;
    }
    result_.facets.resize(count);
  }

  void joinSlivers() {
    auto& facetOf = result_.facetOfTriangle;
    // Across the longest edge first; where slivers lean on each other, across any edge, until all have a
    // facet.
    for (bool anyEdge : {false, true})
      for (bool changed = true; changed;) {
        changed = false;
        for (std::uint32_t t = 0; t < facetOf.size(); ++t) {
          if (facetOf[t] != kUnset) continue;
          for (std::uint32_t k = 0; k < 3 && facetOf[t] == kUnset; ++k)
            if (anyEdge || k == shapes_[t].longest) facetOf[t] = facetOf[s_.opposite[3 * t + k] / 3];
          changed = changed || facetOf[t] != kUnset;
        }
      }
  }

  void fitPlanes() {
    auto& facets = result_.facets;
    const auto& facetOf = result_.facetOfTriangle;
    for (Plane& p : facets)
      p = {{0, 0, 0}, -INFINITY};
    for (std::size_t t = 0; t < facetOf.size(); ++t)
      if (facetOf[t] != kUnset && !sliver(t)) facets[facetOf[t]].normal += shapes_[t].area;
    for (Plane& p : facets)
      p.normal = normalize(p.normal);
    for (std::size_t t = 0; t < facetOf.size(); ++t) {
      if (facetOf[t] == kUnset) continue;
      Plane& p = facets[facetOf[t]];
      for (const std::uint32_t v : s_.triangles[t])
        p.offset = std::max(p.offset, dot(p.normal, s_.positions[v]));
    }
  }

  std::uint32_t facetAt(std::uint32_t edge) const { return result_.facetOfTriangle[edge / 3]; }
  bool border(std::uint32_t edge) const { return facetAt(edge) != facetAt(s_.opposite[edge]); }

  /// How many facets meet around the start of a border half-edge, by counting the border half-edges that
  /// leave it.
  std::uint32_t facetsAround(std::uint32_t edge) const {
    std::uint32_t count = 0;
    std::uint32_t e = edge;
    do {
      count += border(e);
      e = nextInTriangle(s_.opposite[e]);
    } while (e != edge);
    return count;
  }

  void traceLoops() {
    const std::uint32_t edges = std::uint32_t(3 * s_.triangles.size());
    std::vector<std::uint32_t> first(result_.facets.size(), kUnset), borders(result_.facets.size(), 0);
    std::vector<std::uint8_t> degree(s_.positions.size(), 0); // facets around a corner, capped
    bool complete = true;
    for (std::uint32_t e = 0; e < edges; ++e) {
      if (facetAt(e) == kUnset) return;
      if (!border(e)) continue;
      ++borders[facetAt(e)];
      const std::uint32_t v = s_.triangles[e / 3][e % 3];
      if (degree[v] == 0) degree[v] = std::uint8_t(std::min(255u, facetsAround(e)));
      if (degree[v] >= 3 && first[facetAt(e)] == kUnset) first[facetAt(e)] = e;
    }
    result_.simple = true;
    for (const std::uint8_t d : degree) {
      result_.cornersOver3 += d > 3;
      if (d > 3) result_.simple = false;
    }
    Lists& loops = result_.loops;
    for (std::size_t f = 0; f < result_.facets.size() && complete; ++f) {
      if (first[f] == kUnset) {
        complete = false;
        break;
      }
      std::uint32_t e = first[f], seen = 0;
      do {
        const std::uint32_t v = s_.triangles[e / 3][e % 3];
        if (degree[v] >= 3) loops.items.push_back(v);
        ++seen;
        e = nextInTriangle(e);
        while (!border(e))
          e = nextInTriangle(s_.opposite[e]);
      } while (e != first[f] && seen <= borders[f]);
      complete = seen == borders[f] && loops.items.size() - loops.start.back() >= 3;
      loops.close();
    }
    if (!complete) {
      loops = {};
      result_.simple = false;
    }
  }

  static constexpr std::uint32_t kUnset = 0xffffffffu;
  const Surface& s_;
  double tolerance_;
  std::vector<TriangleShape> shapes_;
  std::vector<std::uint32_t> order_;
  Polytope result_;
};

} // namespace

Polytope findFacets(const Surface& surface, double tolerance) {
  return FacetFinder(surface, tolerance).run();
}

} // namespace chamfer
