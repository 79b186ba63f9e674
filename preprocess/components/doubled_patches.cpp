#include "preprocess/components/doubled_patches.h"

#include "preprocess/components/disjoint_sets.h"
#include "preprocess/components/grouping.h"

#include <algorithm>
#include <map>

namespace chamfer {
namespace {

using Border = std::vector<std::array<std::uint32_t, 2>>; ///< edges by their vertices, ascending

class PatchFinder {
public:
  PatchFinder(std::span<const Triangle> triangles, std::span<const Point3> positions,
              std::span<const std::uint32_t> opposite, double planarity, bool sameWay)
      : surface_{triangles, opposite}, positions_(positions), planarity_(planarity), sameWay_(sameWay),
        pieces_(positions.size()), boxes_(positions.size()) {
    for (const Triangle& t : triangles)
      pieces_.join(pieces_.join(t[0], t[1]), t[2]);
    for (const Triangle& t : triangles)
      for (const std::uint32_t v : t)
        boxes_[pieces_.find(v)].extend(positions[v]);
  }

  std::vector<std::uint32_t> run(std::span<const std::uint32_t> crowded) {
    const std::size_t count = surface_.triangles.size();
    DisjointSets sets(count);
    for (std::uint32_t h = 0; h < surface_.opposite.size(); ++h)
      if (surface_.opposite[h] != kNone) sets.join(h / 3, surface_.opposite[h] / 3);
    const Lists patches = listsBy(count, count, [&](std::uint32_t t) { return sets.find(t); });
    std::vector<bool> atCrowded(count);
    for (const std::uint32_t h : crowded)
      atCrowded[sets.find(h / 3)] = true;
    std::vector<std::uint32_t> staysFor(count, kNone);
    std::multimap<Border, std::uint32_t> seen; // flat patches that stay
    for (std::uint32_t p = 0; p < patches.size(); ++p) {
      const auto patch = patches[p];
      if (!atCrowded[patch.front()]) continue;
      const Border border = borderOf(patch);
      const auto [first, last] = seen.equal_range(border);
      const auto same = std::find_if(first, last, [&](const auto& other) {
        const auto kept = patches[other.second];
        return (patch.size() == 1 && kept.size() == 1) || inOnePlane(kept, patch);
      });
      if (same != last) {
        for (const std::uint32_t t : patch)
          staysFor[t] = largestOf(patches[same->second]);
      } else if (patch.size() == 1 || inOnePlane(patch, patch)) {
        seen.emplace(border, p);
      }
    }
    return staysFor;
  }

private:
  Border borderOf(std::span<const std::uint32_t> patch) const {
    Border border;
    for (const std::uint32_t t : patch)
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h)
        if (surface_.opposite[h] == kNone) {
          border.push_back({surface_.start(h), surface_.end(h)});
          if (!sameWay_ && border.back()[0] > border.back()[1]) std::swap(border.back()[0], border.back()[1]);
        }
    std::sort(border.begin(), border.end());
    return border;
  }

  Vector3 areaOf(std::uint32_t t) const {
    const Triangle& v = surface_.triangles[t];
    return cross(positions_[v[1]] - positions_[v[0]], positions_[v[2]] - positions_[v[0]]);
  }

  std::uint32_t largestOf(std::span<const std::uint32_t> patch) const {
    return *std::max_element(patch.begin(), patch.end(), [&](std::uint32_t s, std::uint32_t t) {
      return lengthSquared(areaOf(s)) < lengthSquared(areaOf(t));
    });
  }

  /// Do both lie in the plane of the first one's largest triangle?
  bool inOnePlane(std::span<const std::uint32_t> first, std::span<const std::uint32_t> second) {
    const std::uint32_t largest = largestOf(first);
    const Vector3 area = areaOf(largest);
    if (!(length(area) > 0)) return false;
    const Vector3 normal = normalize(area);
    const Point3& place = positions_[surface_.triangles[largest][0]];
    const double tolerance = planarity_ * boxes_[pieces_.find(surface_.triangles[first[0]][0])].diagonal();
    for (const auto& patch : {first, second})
      for (const std::uint32_t t : patch)
        for (const std::uint32_t v : surface_.triangles[t])
          if (std::abs(dot(normal, positions_[v] - place)) > tolerance) return false;
    return true;
  }

  HalfEdges surface_;
  std::span<const Point3> positions_;
  double planarity_;
  bool sameWay_;
  DisjointSets pieces_;
  std::vector<Bounds3> boxes_; ///< of each piece, at its representative
};

} // namespace

std::vector<std::uint32_t> findDoubledPatches(std::span<const Triangle> triangles,
                                              std::span<const Point3> positions,
                                              std::span<const std::uint32_t> opposite,
                                              std::span<const std::uint32_t> crowded, double planarity,
                                              bool sameWay) {
  if (crowded.empty()) return std::vector<std::uint32_t>(triangles.size(), kNone);
  return PatchFinder(triangles, positions, opposite, planarity, sameWay).run(crowded);
}

} // namespace chamfer
