#include "preprocess/rounding/detection_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>

namespace chamfer {
namespace {

/// Depth beyond a tangent line as an affine function of the facet's two long coordinates: u * x + v * y + w.
struct Line {
  double u, v, w;
  std::uint32_t halfEdge;
  double at(double x, double y) const { return u * x + v * y + w; }
};

struct Rectangle {
  double lower[2], upper[2];
  double highest(const Line& l) const {
    return l.at(l.u > 0 ? upper[0] : lower[0], l.v > 0 ? upper[1] : lower[1]);
  }
};

class TreeBuilder {
public:
  TreeBuilder(const Plane& facet, std::span<const Vector3> vertices, std::span<const std::uint32_t> loop,
              std::uint32_t firstHalfEdge, const Bounds3& domain) {
    const Vector3 n = facet.normal;
    std::size_t dominant = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (std::abs(n[k]) > std::abs(n[dominant])) dominant = k;
    axes_[0] = (dominant + 1) % 3;
    axes_[1] = (dominant + 2) % 3;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vector3 a = vertices[loop[i]], b = vertices[loop[(i + 1) % loop.size()]];
      const Vector3 m = normalize(cross(b - a, n));
      // On the plane the dominant coordinate is (d - n_u x - n_v y) / n_dominant.
      const double share = m[dominant] / n[dominant];
      lines_.push_back({m[axes_[0]] - share * n[axes_[0]], m[axes_[1]] - share * n[axes_[1]],
                        share * facet.offset - dot(m, a), firstHalfEdge + std::uint32_t(i)});
    }
    for (int k = 0; k < 2; ++k) {
      root_.lower[k] = domain.lower[axes_[k]];
      root_.upper[k] = domain.upper[axes_[k]];
    }
    slack_ = 1e-6 * domain.diagonal(); // float32 storage of centres and splits
  }

  DetectionTree run() {
    // The fullest leaf is split next, until the tree has an inner node for every two cylinders: what is left
    // unsplit stays a longer leaf, so that the file stays small whatever the shape.
    std::priority_queue<Part, std::vector<Part>, FewerLines> open;
    const std::size_t budget = lines_.size() / 2;
    tree_.emplace_back();
    open.push({0, root_, pruned(root_, lines_), 0});
    std::vector<Part> leaves;
    for (std::size_t splits = 0; !open.empty();) {
      Part part = open.top();
      open.pop();
      if (part.lines.size() <= kLeaf || part.idle == kIdle || splits == budget) {
        leaves.push_back(std::move(part));
        continue;
      }
      ++splits;
      split(part, open);
    }
    for (const Part& leaf : leaves) {
      const auto [first, count] = stretch(leaf.lines);
      tree_[leaf.node].count = count;
      tree_[leaf.node].bits = first << 2 | 3u;
    }
    return std::move(tree_);
  }

private:
  static constexpr std::size_t kLeaf = 6;
  static constexpr int kIdle = 4; ///< splits in a row that took hardly anything away

  struct Part {
    std::uint32_t node;
    Rectangle area;
    std::vector<Line> lines;
    int idle;
  };
  struct FewerLines {
    bool operator()(const Part& a, const Part& b) const {
      return a.lines.size() != b.lines.size() ? a.lines.size() < b.lines.size() : a.node > b.node;
    }
  };

  /// The lines that can be the deepest, and beyond their tangent at all, at some point of the area. A line is
  /// left out when one that is the deepest at a corner or the middle is as deep or deeper at all four
  /// corners, so everywhere.
  std::vector<Line> pruned(const Rectangle& area, const std::vector<Line>& candidates) const {
    const double x[3] = {area.lower[0], area.upper[0], 0.5 * (area.lower[0] + area.upper[0])};
    const double y[3] = {area.lower[1], area.upper[1], 0.5 * (area.lower[1] + area.upper[1])};
    std::array<Line, 5> deepest{};
    for (std::size_t k = 0; k < 5; ++k) {
      const double px = x[k == 4 ? 2 : k & 1], py = y[k == 4 ? 2 : k >> 1];
      double depth = -INFINITY;
      for (const Line& l : candidates)
        if (const double there = l.at(px, py); there > depth) {
          depth = there;
          deepest[k] = l;
        }
    }
    const auto dominated = [&](const Line& l) {
      return std::any_of(deepest.begin(), deepest.end(), [&](const Line& m) {
        if (m.halfEdge == l.halfEdge) return false;
        for (std::size_t k = 0; k < 4; ++k)
          if (m.at(x[k & 1], y[k >> 1]) < l.at(x[k & 1], y[k >> 1])) return false;
        return true;
      });
    };
    std::vector<Line> kept;
    for (const Line& l : candidates)
      if (area.highest(l) >= -slack_ && !dominated(l)) kept.push_back(l);
    return kept;
  }

  /// The shortest stretch of the loop, which is cyclic, that holds the lines: all but the widest gap between
  /// two.
  std::pair<std::uint32_t, std::uint32_t> stretch(const std::vector<Line>& lines) const {
    const std::uint32_t begin = lines_.front().halfEdge, size = std::uint32_t(lines_.size());
    if (lines.empty()) return {begin, 0};
    std::size_t after = 0;
    std::uint32_t widest = 0;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const std::uint32_t next = lines[(i + 1) % lines.size()].halfEdge;
      const std::uint32_t gap = (next + size - lines[i].halfEdge - 1) % size;
      if (gap >= widest) {
        widest = gap;
        after = i;
      }
    }
    return {lines[(after + 1) % lines.size()].halfEdge, size - widest};
  }

  template <class Queue>
  void split(const Part& part, Queue& open) {
    const Rectangle& area = part.area;
    const int k = area.upper[0] - area.lower[0] >= area.upper[1] - area.lower[1] ? 0 : 1;
    const float at = float(0.5 * (area.lower[k] + area.upper[k]));
    const auto children = std::uint32_t(tree_.size());
    tree_.resize(tree_.size() + 2);
    tree_[part.node].split = at;
    tree_[part.node].bits = children << 2 | std::uint32_t(axes_[k]);
    Rectangle below = area, above = area;
    below.upper[k] = above.lower[k] = double(at);
    for (const auto& [node, half] : {std::pair(children, below), std::pair(children + 1, above)}) {
      std::vector<Line> lines = pruned(half, part.lines);
      const bool idle = 10 * lines.size() > 9 * part.lines.size();
      open.push({node, half, std::move(lines), idle ? part.idle + 1 : 0});
    }
  }

  std::size_t axes_[2];
  std::vector<Line> lines_;
  Rectangle root_;
  double slack_;
  DetectionTree tree_;
};

} // namespace

DetectionTree buildDetectionTree(const Plane& facet, std::span<const Vector3> vertices,
                                 std::span<const std::uint32_t> loop, std::uint32_t firstHalfEdge,
                                 const Bounds3& domain) {
  return TreeBuilder(facet, vertices, loop, firstHalfEdge, domain).run();
}

} // namespace chamfer
