#include "preprocess/rounding/plane_tree.h"

#include <algorithm>
#include <numeric>

namespace chamfer {
namespace {

constexpr std::size_t kLeaf = 4;

} // namespace

PlaneTree::PlaneTree(std::span<const Plane> planes, std::span<const Vector3> places)
    : planes_(planes), places_(places), order_(planes.size()), nodes_(2 * planes.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  for (std::size_t i = 0; i < planes.size(); ++i)
    slack_ = std::max(slack_, 1e-14 * (std::abs(planes[i].offset) + length(places[i])));
  if (!planes.empty()) build(0, 0, planes.size());
  places_ = {};
}

void PlaneTree::build(std::size_t node, std::size_t first, std::size_t last) {
  Bounds3 normals;
  Vector3 sum;
  for (std::size_t i = first; i < last; ++i) {
    normals.extend(Point3(planes_[order_[i]].normal));
    sum += planes_[order_[i]].normal;
  }
  const std::size_t middle = (first + last) / 2;
  if (last - first > kLeaf) {
    const Vector3 size = normals.upper - normals.lower;
    const std::size_t k = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    std::nth_element(order_.begin() + std::ptrdiff_t(first), order_.begin() + std::ptrdiff_t(middle),
                     order_.begin() + std::ptrdiff_t(last), [&](std::uint32_t a, std::uint32_t b) {
                       const double p = planes_[a].normal[k], q = planes_[b].normal[k];
                       return p != q ? p < q : a < b;
                     });
    build(node + 1, first, middle);
    build(node + 2 * (middle - first), middle, last);
  }
  Node& n = nodes_[node];
  n.axis = length(sum) > 1e-9 ? normalize(sum) : Vector3(0, 0, 1);
  n.place = places_[order_[middle]];
  n.cosine = 1;
  n.offset = INFINITY;
  for (std::size_t i = first; i < last; ++i) {
    const Plane& p = planes_[order_[i]];
    n.cosine = std::min(n.cosine, dot(p.normal, n.axis));
    n.offset = std::min(n.offset, p.offset - dot(p.normal, n.place));
  }
  n.cosine = std::max(-1.0, n.cosine - 1e-15);
  n.sine = std::sqrt(std::max(0.0, 1 - n.cosine * n.cosine));
}

/// Not above the depth of the point below any plane of the node.
double PlaneTree::leastDepth(const Node& node, const Vector3& point) const {
  const Vector3 to = point - node.place;
  const double along = dot(to, node.axis), size = length(to);
  const double across = std::sqrt(std::max(0.0, size * size - along * along));
  // The largest n . to over the cone of normals.
  const double most = along >= size * node.cosine ? size : along * node.cosine + across * node.sine;
  return node.offset - most - slack_ - 1e-14 * size;
}

double PlaneTree::bound(std::size_t node, std::span<const Vector3> points) const {
  double most = 0;
  for (const Vector3& p : points)
    most = std::max(most, leastDepth(nodes_[node], p));
  return most;
}

void PlaneTree::visit(std::size_t node, std::size_t first, std::size_t last, std::span<const Vector3> points,
                      Nearest& best) const {
  if (last - first <= kLeaf) {
    for (std::size_t i = first; i < last; ++i) {
      const Plane& q = planes_[order_[i]];
      double deepest = 0;
      for (const Vector3& p : points)
        deepest = std::max(deepest, q.offset - dot(q.normal, p));
      if (deepest < best.depth || (deepest == best.depth && order_[i] < best.plane))
        best = {order_[i], deepest};
    }
    return;
  }
  const std::size_t middle = (first + last) / 2;
  const std::size_t one = node + 1, other = node + 2 * (middle - first);
  const double boundOne = bound(one, points), boundOther = bound(other, points);
  const auto visitOne = [&] {
    if (boundOne <= best.depth) visit(one, first, middle, points, best);
  };
  if (boundOne <= boundOther) visitOne();
  if (boundOther <= best.depth) visit(other, middle, last, points, best);
  if (boundOne > boundOther) visitOne();
}

PlaneTree::Nearest PlaneTree::nearest(std::span<const Vector3> points) const {
  Nearest best{0xffffffffu, INFINITY};
  if (!planes_.empty()) visit(0, 0, planes_.size(), points, best);
  return best;
}

} // namespace chamfer
