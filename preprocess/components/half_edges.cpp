#include "preprocess/components/half_edges.h"

#include <algorithm>
#include <numbers>

namespace chamfer {
namespace {

/// Radians between faces that count as one plane around an edge: a few steps of float32 coordinates.
constexpr double kSameAngle = 1e-6;

/// std::sort, but quick on the handful of entries that a vertex has.
void sortEntries(std::uint64_t* first, std::uint64_t* last) {
  if (last - first > 32) {
    std::sort(first, last);
    return;
  }
  for (std::uint64_t* i = first + 1; i < last; ++i) {
    const std::uint64_t entry = *i;
    std::uint64_t* j = i;
    for (; j > first && j[-1] > entry; --j)
      *j = j[-1];
    *j = entry;
  }
}

} // namespace

PairingCounts HalfEdgePairer::pair(std::span<const Triangle> triangles, std::size_t vertexCount,
                                   std::vector<std::uint32_t>& opposite) {
  crowded_.clear();
  crowdedEnds_.clear();
  start_.assign(vertexCount + 1, 0);
  entries_.resize(3 * triangles.size());
  opposite.resize(3 * triangles.size());
  for (const Triangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k)
      ++start_[std::min(t[k], t[k == 2 ? 0 : k + 1])];
  std::uint32_t sum = 0; // start_ becomes the ends, which filling from behind turns into the starts
  for (std::uint32_t& s : start_)
    s = sum += s;
  for (std::size_t i = triangles.size(); i-- > 0;)
    for (std::size_t k = 3; k-- > 0;) {
      const std::uint32_t a = triangles[i][k], b = triangles[i][k == 2 ? 0 : k + 1];
      entries_[--start_[std::min(a, b)]] = (std::uint64_t(std::max(a, b)) << 32) | std::uint32_t(3 * i + k);
    }
  PairingCounts counts;
  for (std::uint32_t v = 0; v < vertexCount; ++v) {
    std::uint64_t* const last = entries_.data() + start_[v + 1];
    std::uint64_t* run = entries_.data() + start_[v];
    sortEntries(run, last);
    while (run != last) {
      std::uint64_t* end = run + 1;
      while (end != last && (*end >> 32) == (*run >> 32))
        ++end;
      const auto halfEdge = [](std::uint64_t entry) { return std::uint32_t(entry); };
      if (end - run == 2) {
        const std::uint32_t a = halfEdge(run[0]), b = halfEdge(run[1]);
        opposite[a] = b;
        opposite[b] = a;
        counts.sameDirection += triangles[a / 3][a % 3] == triangles[b / 3][b % 3];
      } else {
        for (std::uint64_t* i = run; i != end; ++i)
          opposite[halfEdge(*i)] = kNone;
        if (end - run == 1)
          ++counts.open;
        else {
          ++counts.crowded;
          for (std::uint64_t* i = run; i != end; ++i)
            crowded_.push_back(halfEdge(*i));
          crowdedEnds_.push_back(std::uint32_t(crowded_.size()));
        }
      }
      run = end;
    }
  }
  return counts;
}

void pairCrowdedEdge(std::span<const std::uint32_t> halfEdges, std::span<const Triangle> triangles,
                     std::span<const Point3> positions, bool insideOut, bool repeatsOnly,
                     std::vector<std::uint32_t>& opposite) {
  struct Side {
    double angle;        ///< about the edge; the first of those that are equal but for rounding
    bool ends;           ///< solid ends at this triangle, in the sense of increasing angle; else it begins
    std::uint32_t place; ///< in halfEdges
  };
  const HalfEdges surface{triangles, opposite};
  const std::uint32_t first = halfEdges.front(), a = std::min(surface.start(first), surface.end(first)),
                      b = std::max(surface.start(first), surface.end(first));
  const Vector3 axis = normalize(positions[b] - positions[a]);
  Vector3 right, up; // a frame across the edge
  std::vector<Side> sides;
  std::size_t ending = 0;
  for (std::uint32_t place = 0; place < halfEdges.size(); ++place) {
    const std::uint32_t h = halfEdges[place];
    const Vector3 to = positions[surface.start(previousHalfEdge(h))] - positions[a];
    const Vector3 across = to - axis * dot(to, axis);
    // A triangle without height has no direction here: rounding decided what is left of it.
    if (!(length(across) > 1e-12 * length(to))) return;
    if (sides.empty()) {
      right = normalize(across);
      up = cross(axis, right);
    }
    // A triangle that runs along a -> b faces towards increasing angle, so its solid ends there.
    const bool ends = (surface.start(h) == a) != insideOut;
    ending += ends;
    const double angle = std::atan2(dot(across, up), dot(across, right));
    sides.push_back(
        {angle < kSameAngle - std::numbers::pi ? angle + 2 * std::numbers::pi : angle, ends, place});
  }
  if (2 * ending != sides.size()) return;
  std::sort(sides.begin(), sides.end(), [](const Side& s, const Side& t) {
    return s.angle != t.angle ? s.angle < t.angle : s.place < t.place;
  });
  // Coincident faces, differently triangulated, differ by rounding.
  std::size_t directions = 1;
  for (std::size_t i = 1; i < sides.size(); ++i) {
    if (sides[i].angle - sides[i - 1].angle <= kSameAngle)
      sides[i].angle = sides[i - 1].angle;
    else
      ++directions;
  }
  if (repeatsOnly && directions > 2) return;
  std::sort(sides.begin(), sides.end(), [](const Side& s, const Side& t) {
    if (s.angle != t.angle) return s.angle < t.angle;
    return s.ends != t.ends ? s.ends : s.place < t.place;
  });
  // Begin where no solid is under way: behind the lowest point of (begun - ended).
  std::ptrdiff_t depth = 0, lowest = 0;
  std::size_t origin = 0;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    depth += sides[i].ends ? -1 : 1;
    if (depth < lowest) {
      lowest = depth;
      origin = i + 1;
    }
  }
  std::rotate(sides.begin(), sides.begin() + std::ptrdiff_t(origin), sides.end());
  // First begun, first ended: where rounding lets touching solids overlap by a hair, they still come apart.
  std::size_t begun = 0;
  for (const Side& side : sides) {
    if (!side.ends) continue;
    while (sides[begun].ends)
      ++begun;
    const std::uint32_t g = halfEdges[side.place], h = halfEdges[sides[begun].place];
    opposite[g] = h;
    opposite[h] = g;
    ++begun;
  }
}

} // namespace chamfer
