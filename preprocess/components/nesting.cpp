#include "preprocess/components/nesting.h"

#include "common/text.h"

#include <algorithm>
#include <numbers>

namespace chamfer {
namespace {

bool contains(const Bounds3& outer, const Bounds3& inner) {
  for (std::size_t i = 0; i < 3; ++i)
    if (inner.lower[i] < outer.lower[i] || inner.upper[i] > outer.upper[i]) return false;
  return true;
}

/// Times that the surface winds around `p`: 1 inside, 0 outside (solid angles after van Oosterom and Strackee
/// 1983).
double windingNumber(const Component& surface, const Point3& p) {
  double angle = 0;
  for (const auto& t : surface.triangles) {
    const Vector3 a = surface.positions[t[0]] - p, b = surface.positions[t[1]] - p,
                  c = surface.positions[t[2]] - p;
    const double la = length(a), lb = length(b), lc = length(c);
    angle +=
        2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return angle / (4 * std::numbers::pi);
}

/// Balanced hierarchy over boxes, to ask which of them contain another box.
class BoxTree {
public:
  BoxTree(const std::vector<Component>& components, std::vector<std::uint32_t> members)
      : components_(components), members_(std::move(members)), nodes_(2 * members_.size()) {
    build(0, 0, members_.size(), 0);
  }

  /// The first member whose box contains `box` and which `accept`s, or kNone.
  template <class Accept>
  std::uint32_t find(const Bounds3& box, Accept accept) const {
    return find(0, 0, members_.size(), box, accept);
  }

private:
  void build(std::size_t node, std::size_t first, std::size_t last, std::size_t axis) {
    for (std::size_t i = first; i < last; ++i)
      nodes_[node].extend(components_[members_[i]].bounds);
    if (last - first < 2) return;
    const std::size_t middle = (first + last) / 2;
    std::nth_element(members_.begin() + std::ptrdiff_t(first), members_.begin() + std::ptrdiff_t(middle),
                     members_.begin() + std::ptrdiff_t(last), [&](std::uint32_t a, std::uint32_t b) {
                       return components_[a].bounds.centre()[axis] < components_[b].bounds.centre()[axis];
                     });
    build(node + 1, first, middle, (axis + 1) % 3);
    build(node + 2 * (middle - first), middle, last, (axis + 1) % 3);
  }

  template <class Accept>
  std::uint32_t find(std::size_t node, std::size_t first, std::size_t last, const Bounds3& box,
                     Accept accept) const {
    if (!contains(nodes_[node], box)) return 0xffffffffu;
    if (last - first == 1) return accept(members_[first]) ? members_[first] : 0xffffffffu;
    const std::size_t middle = (first + last) / 2;
    const std::uint32_t found = find(node + 1, first, middle, box, accept);
    return found != 0xffffffffu ? found : find(node + 2 * (middle - first), middle, last, box, accept);
  }

  const std::vector<Component>& components_;
  std::vector<std::uint32_t> members_;
  std::vector<Bounds3> nodes_; ///< a node, its first half's subtree, its second half's
};

} // namespace

void findCavities(std::vector<Component>& components) {
  std::vector<std::uint32_t> inwards, outwards;
  for (std::uint32_t i = 0; i < components.size(); ++i)
    if (!components[i].fault) (components[i].turned ? inwards : outwards).push_back(i);
  if (inwards.empty() || outwards.empty()) return;
  const BoxTree tree(components, std::move(outwards));
  for (const std::uint32_t i : inwards) {
    Component& inner = components[i];
    const Point3 place = inner.positions.front();
    const std::uint32_t outer =
        tree.find(inner.bounds, [&](std::uint32_t o) { return windingNumber(components[o], place) > 0.5; });
    if (outer == 0xffffffffu) continue;
    const std::string text = "it faces inwards and lies inside component " + std::to_string(outer + 1) +
                             ": a cavity, and a solid with a cavity is not convex; it was seen at " +
                             pointText(place.x, place.y, place.z);
    inner.fault = Fault{FaultKind::InsideOut, text, 1, place, inner.meshTriangle.front()};
  }
}

} // namespace chamfer
