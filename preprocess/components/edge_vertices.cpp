#include "preprocess/components/edge_vertices.h"

#include "preprocess/components/disjoint_sets.h"

#include <algorithm>

namespace chamfer {
namespace {

/// Balanced hierarchy of points, to ask which lie along a segment.
class PointTree {
public:
  PointTree(std::span<const Point3> positions, std::vector<std::uint32_t> points)
      : positions_(positions), points_(std::move(points)), boxes_(2 * points_.size()) {
    if (!points_.empty()) build(0, 0, points_.size());
  }

  /// Calls found(point) for all points whose leaf the segment's neighbourhood touches: those within `reach`
  /// of the segment and a few more.
  template <class Found>
  void along(const Point3& from, const Vector3& to, double reach, Found found) const {
    if (!points_.empty()) visit(0, 0, points_.size(), from, to, reach, found);
  }

private:
  static constexpr std::size_t kLeaf = 4;

  void build(std::size_t node, std::size_t first, std::size_t last) {
    Bounds3& box = boxes_[node];
    for (std::size_t i = first; i < last; ++i)
      box.extend(positions_[points_[i]]);
    if (last - first <= kLeaf) return;
    const Vector3 size = box.upper - box.lower;
    const std::size_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::size_t middle = (first + last) / 2;
    std::nth_element(points_.begin() + std::ptrdiff_t(first), points_.begin() + std::ptrdiff_t(middle),
                     points_.begin() + std::ptrdiff_t(last), [&](std::uint32_t a, std::uint32_t b) {
                       return positions_[a][axis] < positions_[b][axis];
                     });
    build(node + 1, first, middle);
    build(node + 2 * (middle - first), middle, last);
  }

  template <class Found>
  void visit(std::size_t node, std::size_t first, std::size_t last, const Point3& from, const Vector3& to,
             double reach, Found& found) const {
    double enter = 0, leave = 1; // where the segment is within the widened box
    for (std::size_t k = 0; k < 3; ++k) {
      double a = boxes_[node].lower[k] - reach - from[k], b = boxes_[node].upper[k] + reach - from[k];
      if (to[k] == 0) {
        if (a > 0 || b < 0) return;
        continue;
      }
      a /= to[k];
      b /= to[k];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    if (!(enter <= leave)) return;
    if (last - first <= kLeaf) {
      for (std::size_t i = first; i < last; ++i)
        found(points_[i]);
      return;
    }
    const std::size_t middle = (first + last) / 2;
    visit(node + 1, first, middle, from, to, reach, found);
    visit(node + 2 * (middle - first), middle, last, from, to, reach, found);
  }

  std::span<const Point3> positions_;
  std::vector<std::uint32_t> points_;
  std::vector<Bounds3> boxes_; ///< a node, its first half's subtree, its second half's
};

/// The vertices on each edge of a triangle, in its direction.
using Chains = std::array<std::vector<std::uint32_t>, 3>;

/// Appends the parts of a triangle: a fan from the corner that faces the first edge with vertices on it,
/// whose outer parts inherit the other edges.
void appendParts(const Triangle& t, const Chains& chains, std::vector<Triangle>& parts) {
  std::size_t k = 0;
  while (k < 3 && chains[k].empty())
    ++k;
  if (k == 3) {
    parts.push_back(t);
    return;
  }
  const std::uint32_t apex = t[(k + 2) % 3];
  std::uint32_t from = t[k];
  for (std::size_t i = 0; i <= chains[k].size(); ++i) {
    const bool first = i == 0, last = i == chains[k].size();
    const std::uint32_t to = last ? t[(k + 1) % 3] : chains[k][i];
    appendParts({from, to, apex},
                {{{},
                  last ? chains[(k + 1) % 3] : std::vector<std::uint32_t>{},
                  first ? chains[(k + 2) % 3] : std::vector<std::uint32_t>{}}},
                parts);
    from = to;
  }
}

/// Below this not even a vertex in the very middle would be found on its edge.
constexpr double kLeastTolerance = 1e-14;

/// What hangs together in vertices, and how large it is.
class Pieces {
public:
  Pieces(std::span<const Point3> positions, std::span<const Triangle> triangles)
      : sets_(positions.size()), boxes_(positions.size()) {
    for (const Triangle& t : triangles)
      sets_.join(sets_.join(t[0], t[1]), t[2]);
    for (const Triangle& t : triangles)
      for (const std::uint32_t v : t) {
        boxes_[sets_.find(v)].extend(positions[v]);
        all_.extend(positions[v]);
      }
  }
  std::uint32_t of(std::uint32_t vertex) { return sets_.find(vertex); }
  /// Of the pieces of two vertices, taken together.
  double diagonal(std::uint32_t v, std::uint32_t w) {
    Bounds3 both = boxes_[of(v)];
    if (of(v) != of(w)) both.extend(boxes_[of(w)]);
    return both.diagonal();
  }
  double diagonal() const { return all_.diagonal(); }

private:
  DisjointSets sets_;
  std::vector<Bounds3> boxes_; ///< of each piece, at its representative
  Bounds3 all_;
};

class Splitter {
public:
  Splitter(std::span<const Point3> positions, std::span<const Triangle> triangles, double tolerance,
           std::vector<std::uint32_t> vertices)
      : positions_(positions), tolerance_(tolerance), pieces_(positions, triangles),
        reach_(tolerance * pieces_.diagonal()), tree_(positions, std::move(vertices)) {}

  /// The vertices on the edge from `a` to `b`, from a on.
  std::vector<std::uint32_t> on(std::uint32_t a, std::uint32_t b) {
    if (a > b) { // the same ones for both half-edges
      std::vector<std::uint32_t> vertices = on(b, a);
      std::reverse(vertices.begin(), vertices.end());
      return vertices;
    }
    struct Place {
      double along;
      std::uint32_t vertex;
    };
    std::vector<Place> places;
    const Point3 from = positions_[a];
    const Vector3 to = positions_[b] - from;
    const double size = lengthSquared(to);
    if (!(size > 0)) return {};
    tree_.along(from, to, reach_, [&](std::uint32_t v) {
      const double along = dot(positions_[v] - from, to) / size;
      const double off = length(positions_[v] - (from + to * along));
      if (v == a || v == b || off > reach_) return;
      const double near = tolerance_ * pieces_.diagonal(a, v);
      if (off <= near && along > 0 && along < 1 && length(positions_[v] - from) > near &&
          length(positions_[v] - positions_[b]) > near)
        places.push_back({along, v});
    });
    std::sort(places.begin(), places.end(), [](const Place& s, const Place& t) {
      return s.along != t.along ? s.along < t.along : s.vertex < t.vertex;
    });
    std::vector<std::uint32_t> vertices;
    for (const Place& p : places)
      vertices.push_back(p.vertex);
    return vertices;
  }

private:
  std::span<const Point3> positions_;
  double tolerance_;
  Pieces pieces_;
  double reach_; ///< not less than any tolerance that applies
  PointTree tree_;
};

} // namespace

std::size_t splitAtEdgeVertices(std::span<const Point3> positions, std::span<const std::uint32_t> opposite,
                                double tolerance, std::vector<Triangle>& triangles,
                                std::vector<std::uint32_t>& meshTriangle) {
  const HalfEdges surface{triangles, opposite};
  std::vector<std::uint32_t> vertices;
  for (std::uint32_t h = 0; h < opposite.size(); ++h)
    if (opposite[h] == kNone) vertices.insert(vertices.end(), {surface.start(h), surface.end(h)});
  if (vertices.empty()) return 0;
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  Splitter splitter(positions, triangles, std::max(tolerance, kLeastTolerance), std::move(vertices));
  std::vector<Triangle> parts;
  std::vector<std::uint32_t> partOf;
  std::size_t split = 0;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    Chains chains;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t h = 3 * t + k;
      chains[k] = splitter.on(surface.start(h), surface.end(h));
      std::erase(chains[k], triangles[t][(k + 2) % 3]); // the third corner of a triangle without height
      split += !chains[k].empty();
    }
    appendParts(triangles[t], chains, parts);
    partOf.resize(parts.size(), meshTriangle[t]);
  }
  if (split == 0) return 0;
  triangles = std::move(parts);
  meshTriangle = std::move(partOf);
  return split;
}

std::vector<bool> findFlatTriangles(std::span<const Point3> positions, std::span<const Triangle> triangles,
                                    double tolerance) {
  Pieces pieces(positions, triangles);
  std::vector<bool> flat(triangles.size()), solid(positions.size()); // by triangle; by piece
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Triangle& t = triangles[i];
    const Vector3 u = positions[t[1]] - positions[t[0]], v = positions[t[2]] - positions[t[0]];
    const double height = length(cross(u, v)) / std::max({length(u), length(v), length(v - u)});
    flat[i] = !(height > std::max(tolerance, kLeastTolerance) * pieces.diagonal(t[0], t[0]));
    if (!flat[i]) solid[pieces.of(t[0])] = true;
  }
  for (std::size_t i = 0; i < triangles.size(); ++i)
    if (!solid[pieces.of(triangles[i][0])]) flat[i] = false;
  return flat;
}

} // namespace chamfer
