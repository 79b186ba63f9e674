#include "preprocess/components/repeats.h"

#include "preprocess/components/half_edges.h"
#include "preprocess/components/weld.h"

#include <algorithm>
#include <unordered_map>

namespace chamfer {
namespace {

/// A closed component, to ask for the triangle in whose plane another one lies.
class ClosedSurface {
public:
  ClosedSurface(const Component& component, double planarity)
      : c_(component), tolerance_(planarity * component.bounds.diagonal()),
        leaving_(component.positions.size()) {
    vertices_.reserve(c_.positions.size());
    for (std::uint32_t v = 0; v < c_.positions.size(); ++v)
      vertices_.emplace(hashOf(c_.positions[v]), v);
    for (std::uint32_t h = 0; h < c_.opposite.size(); ++h)
      leaving_[c_.triangles[h / 3][h % 3]] = h;
  }

  /// Of this component's triangles; kNone where there is none.
  std::uint32_t under(const std::array<Point3, 3>& corners) const {
    for (const Point3& p : corners)
      if (vertexAt(p) == kNone) return kNone;
    std::uint32_t best = kNone;
    double least = tolerance_;
    const std::uint32_t first = leaving_[vertexAt(corners[0])];
    std::uint32_t h = first;
    do {
      const Triangle& t = c_.triangles[h / 3];
      const Point3& a = c_.positions[t[0]];
      const Vector3 u = c_.positions[t[1]] - a, v = c_.positions[t[2]] - a;
      const Vector3 area = cross(u, v);
      const double twice = length(area);
      // One lower than the tolerance has no plane of its own.
      if (twice > tolerance_ * std::max({length(u), length(v), length(v - u)})) {
        double off = 0;
        for (const Point3& p : corners)
          off = std::max(off, std::abs(dot(area, p - a)) / twice);
        if (off <= least) {
          least = off;
          best = h / 3;
        }
      }
      h = nextHalfEdge(c_.opposite[h]);
    } while (h != first);
    return best;
  }

private:
  std::uint32_t vertexAt(const Point3& p) const {
    for (auto [at, end] = vertices_.equal_range(hashOf(p)); at != end; ++at)
      if (c_.positions[at->second] == p) return at->second;
    return kNone;
  }

  const Component& c_;
  double tolerance_;
  std::vector<std::uint32_t> leaving_; ///< a half-edge from each vertex
  std::unordered_multimap<std::uint64_t, std::uint32_t> vertices_;
};

std::uint64_t hashOf(const Bounds3& b) { return hashOf(b.lower) ^ (3 * hashOf(b.upper)); }

class RepeatFinder {
public:
  RepeatFinder(double planarity, std::vector<Component>& list) : planarity_(planarity), list_(list) {}

  /// By component the one that it repeats, or kNone.
  std::vector<std::uint32_t> run() {
    repeats_.assign(list_.size(), kNone);
    std::unordered_multimap<std::uint64_t, std::uint32_t> byBounds;
    bool loose = false;
    for (std::uint32_t i = 0; i < list_.size(); ++i) {
      if (list_[i].fault) {
        loose = true;
        continue;
      }
      const std::uint64_t key = hashOf(list_[i].bounds);
      for (auto [at, end] = byBounds.equal_range(key); at != end && repeats_[i] == kNone; ++at)
        if (list_[at->second].positions.size() == list_[i].positions.size())
          tryOn(i, at->second, ClosedSurface(list_[at->second], planarity_));
      if (repeats_[i] == kNone) byBounds.emplace(key, i);
    }
    if (loose) findLoose();
    return std::move(repeats_);
  }

private:
  /// Faces that closed nothing, on the solids that have a vertex where they have their first.
  void findLoose() {
    std::unordered_multimap<std::uint64_t, std::uint32_t> wanted;
    for (std::uint32_t i = 0; i < list_.size(); ++i)
      if (list_[i].fault) wanted.emplace(hashOf(list_[i].positions.front()), i);
    for (std::uint32_t solid = 0; solid < list_.size(); ++solid) {
      if (list_[solid].fault || repeats_[solid] != kNone) continue;
      std::optional<ClosedSurface> surface;
      for (const Point3& p : list_[solid].positions)
        for (auto [at, end] = wanted.equal_range(hashOf(p)); at != end; ++at)
          if (repeats_[at->second] == kNone && list_[at->second].positions.front() == p) {
            if (!surface) surface.emplace(list_[solid], planarity_);
            tryOn(at->second, solid, *surface);
          }
    }
  }

  /// Makes `i` a repeat of the solid when it is one.
  void tryOn(std::uint32_t i, std::uint32_t solid, const ClosedSurface& surface) {
    std::vector<std::array<std::uint32_t, 2>> duplicates;
    for (std::size_t t = 0; t < list_[i].triangles.size(); ++t) {
      const auto& v = list_[i].triangles[t];
      const auto& p = list_[i].positions;
      const std::uint32_t under = surface.under({p[v[0]], p[v[1]], p[v[2]]});
      if (under == kNone) return;
      duplicates.push_back({list_[i].meshTriangle[t], list_[solid].meshTriangle[under]});
    }
    repeats_[i] = solid;
    auto& all = list_[solid].duplicates;
    all.insert(all.end(), duplicates.begin(), duplicates.end());
    for (const auto& [dropped, stays] : list_[i].duplicates) { // of the one that goes
      const auto of = std::lower_bound(duplicates.begin(), duplicates.end(), std::array{stays, 0u});
      all.push_back({dropped, (*of)[1]});
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end(), [](const auto& a, const auto& b) { return a[0] == b[0]; }),
              all.end());
    auto& degenerate = list_[solid].degenerate;
    degenerate.insert(degenerate.end(), list_[i].degenerate.begin(), list_[i].degenerate.end());
    std::sort(degenerate.begin(), degenerate.end());
  }

  double planarity_;
  std::vector<Component>& list_;
  std::vector<std::uint32_t> repeats_;
};

} // namespace

void dropRepeats(const TriangleMesh& mesh, double planarity, Components& components) {
  std::vector<Component>& list = components.list;
  const std::vector<std::uint32_t> repeats = RepeatFinder(planarity, list).run();
  std::vector<std::uint32_t> again; // triangles of repeated solids
  std::size_t kept = 0, solids = 0;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (repeats[i] == kNone) {
      if (kept != i) list[kept] = std::move(list[i]);
      ++kept;
      continue;
    }
    components.counts.duplicateTriangles += list[i].meshTriangle.size();
    if (list[i].fault) continue; // loose faces
    ++solids;
    again.insert(again.end(), list[i].meshTriangle.begin(), list[i].meshTriangle.end());
  }
  list.resize(kept);
  std::sort(again.begin(), again.end());
  components.counts.duplicateSolids = solids;
  if (solids > 0)
    components.warnings.push_back(
        (solids == 1 ? "a solid is" : std::to_string(solids) + " solids are") +
        std::string(
            " there a second time in the same place, with the same vertices (its faces given once for each "
            "side, or a copy); one of each was kept, the first that was dropped begins with ") +
        placeOfTriangle(mesh, again.front()));
  std::size_t triangles = 0;
  std::uint32_t first = kNone;
  for (const Component& c : list)
    for (const auto& [dropped, stays] : c.duplicates) {
      if (std::binary_search(again.begin(), again.end(), dropped)) continue;
      ++triangles;
      first = std::min(first, dropped);
    }
  if (triangles > 0)
    components.warnings.push_back("faces are given twice: " + std::to_string(triangles) +
                                  (triangles == 1 ? " triangle was" : " triangles were") +
                                  " dropped, the first in " + placeOfTriangle(mesh, first));
}

} // namespace chamfer
