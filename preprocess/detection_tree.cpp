#include "preprocess/detection_tree.h"

#include <algorithm>
#include <cmath>

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
  double lowest(const Line& l) const {
    return l.at(l.u > 0 ? lower[0] : upper[0], l.v > 0 ? lower[1] : upper[1]);
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
    depthLimit_ = 4 + 2 * int(std::ceil(std::log2(double(loop.size()))));
  }

  DetectionTree run() {
    tree_.nodes.emplace_back();
    fill(0, root_, lines_, 0);
    return std::move(tree_);
  }

private:
  void fill(std::uint32_t node, const Rectangle& part, const std::vector<Line>& candidates, int depth) {
    double surely = 0;
    for (const Line& l : candidates)
      surely = std::max(surely, part.lowest(l));
    std::vector<Line> kept;
    for (const Line& l : candidates)
      if (part.highest(l) >= surely - slack_) kept.push_back(l);
    if (kept.size() <= 4 || depth == depthLimit_) {
      tree_.nodes[node].count = std::uint32_t(kept.size());
      tree_.nodes[node].bits = std::uint32_t(tree_.leaves.size()) << 2 | 3u;
      for (const Line& l : kept)
        tree_.leaves.push_back(l.halfEdge);
      return;
    }
    const int k = part.upper[0] - part.lower[0] >= part.upper[1] - part.lower[1] ? 0 : 1;
    const float split = float(0.5 * (part.lower[k] + part.upper[k]));
    const auto children = std::uint32_t(tree_.nodes.size());
    tree_.nodes.resize(tree_.nodes.size() + 2);
    tree_.nodes[node].split = split;
    tree_.nodes[node].bits = children << 2 | std::uint32_t(axes_[k]);
    Rectangle below = part, above = part;
    below.upper[k] = above.lower[k] = double(split);
    fill(children, below, kept, depth + 1);
    fill(children + 1, above, kept, depth + 1);
  }

  std::size_t axes_[2];
  std::vector<Line> lines_;
  Rectangle root_;
  double slack_;
  int depthLimit_;
  DetectionTree tree_;
};

} // namespace

DetectionTree buildDetectionTree(const Plane& facet, std::span<const Vector3> vertices,
                                 std::span<const std::uint32_t> loop, std::uint32_t firstHalfEdge,
                                 const Bounds3& domain) {
  return TreeBuilder(facet, vertices, loop, firstHalfEdge, domain).run();
}

} // namespace chamfer
