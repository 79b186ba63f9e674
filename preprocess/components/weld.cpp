#include "preprocess/components/weld.h"

#include "preprocess/components/disjoint_sets.h"

#include <algorithm>
#include <bit>
#include <unordered_map>

namespace chamfer {
namespace {

std::uint64_t mix(std::uint64_t h) { // finaliser of MurmurHash3
  h = (h ^ (h >> 33)) * 0xff51afd7ed558ccdull;
  h = (h ^ (h >> 33)) * 0xc4ceb9fe1a85ec53ull;
  return h ^ (h >> 33);
}

/// A pair of vertices near each other.
struct Near {
  double distance;
  std::uint32_t a, b;
};

/// All pairs of candidates nearer than `reach`, nearest first; fewer when there are absurdly many (a cloud of
/// vertices smaller than the tolerance of a scene): what then stays open is refused as open.
std::vector<Near> findNearPairs(std::span<const Point3> positions, std::span<const std::uint32_t> candidates,
                                double reach, const Point3& origin) {
  using Cell = std::array<std::int64_t, 3>;
  const auto cellOf = [&](const Point3& p) {
    const Vector3 v = (p - origin) / reach;
    return Cell{std::int64_t(std::floor(v.x)), std::int64_t(std::floor(v.y)), std::int64_t(std::floor(v.z))};
  };
  const auto key = [](const Cell& c) {
    return mix(std::uint64_t(c[0]) ^ mix(std::uint64_t(c[1]) ^ mix(std::uint64_t(c[2]))));
  };
  std::vector<Near> pairs;
  std::unordered_multimap<std::uint64_t, std::uint32_t> grid;
  grid.reserve(candidates.size());
  std::size_t budget = 200 * candidates.size();
  for (const std::uint32_t v : candidates) {
    const Cell cell = cellOf(positions[v]);
    for (int i = 0; i < 27; ++i) {
      const Cell around{cell[0] + i % 3 - 1, cell[1] + i / 3 % 3 - 1, cell[2] + i / 9 - 1};
      for (auto [at, end] = grid.equal_range(key(around)); at != end && budget > 0; ++at, --budget) {
        const double distance = length(positions[v] - positions[at->second]);
        if (distance <= reach) pairs.push_back({distance, at->second, v});
      }
    }
    grid.emplace(key(cell), v);
  }
  std::sort(pairs.begin(), pairs.end(), [](const Near& s, const Near& t) {
    if (s.distance != t.distance) return s.distance < t.distance;
    return s.a != t.a ? s.a < t.a : s.b < t.b;
  });
  // Two cells that hash alike offer a pair twice.
  pairs.erase(std::unique(pairs.begin(), pairs.end(),
                          [](const Near& s, const Near& t) { return s.a == t.a && s.b == t.b; }),
              pairs.end());
  return pairs;
}

} // namespace

std::uint64_t hashOf(const Point3& p) {
  // Adding 0 turns -0 into 0.
  const std::uint64_t x = std::bit_cast<std::uint64_t>(p.x + 0.0),
                      y = std::bit_cast<std::uint64_t>(p.y + 0.0),
                      z = std::bit_cast<std::uint64_t>(p.z + 0.0);
  return mix(x ^ mix(y ^ mix(z)));
}

void weldExact(std::span<const Triangle> triangles, std::span<const Point3> positions,
               std::vector<std::uint32_t>& standsFor) {
  std::vector<std::uint32_t> slots(std::bit_ceil(6 * triangles.size() + 2), kNone); // open addressing
  const std::size_t mask = slots.size() - 1;
  for (const Triangle& t : triangles)
    for (const std::uint32_t v : t) {
      std::size_t at = hashOf(positions[v]) & mask;
      while (slots[at] != kNone && !(positions[slots[at]] == positions[v]))
        at = (at + 1) & mask;
      if (slots[at] == kNone) slots[at] = v;
      standsFor[v] = slots[at];
    }
}

void weldNear(std::span<const Triangle> triangles, std::span<const Point3> positions,
              std::span<const std::uint32_t> candidates, double tolerance,
              std::vector<std::uint32_t>& standsFor) {
  if (!(tolerance > 1e-15)) return; // below what doubles resolve: nothing but exact welding is asked for
  DisjointSets pieces(positions.size());
  for (const Triangle& t : triangles) {
    pieces.join(t[0], t[1]);
    pieces.join(t[0], t[2]);
  }
  std::vector<Bounds3> boxes(positions.size()); // of each piece, at its representative
  Bounds3 all;
  for (const Triangle& t : triangles)
    for (const std::uint32_t v : t) {
      boxes[pieces.find(v)].extend(positions[v]);
      all.extend(positions[v]);
    }
  const double reach = tolerance * all.diagonal();
  if (!(reach > 0) || !std::isfinite(reach)) return;
  std::vector<Near> pairs = findNearPairs(positions, candidates, reach, all.lower);
  DisjointSets joined(positions.size());
  // A pair that is too far apart for the pieces it joins now may be near enough once these have grown.
  for (bool grown = true; grown;) {
    grown = false;
    std::vector<Near> apart;
    for (const Near& pair : pairs) {
      const std::uint32_t a = pieces.find(pair.a), b = pieces.find(pair.b);
      Bounds3 both = boxes[a];
      both.extend(boxes[b]);
      if (pair.distance > tolerance * both.diagonal()) {
        apart.push_back(pair);
        continue;
      }
      joined.join(pair.a, pair.b);
      boxes[pieces.join(a, b)] = both;
      grown = grown || a != b;
    }
    pairs.swap(apart);
  }
  for (std::uint32_t& v : standsFor)
    v = joined.find(v);
}

} // namespace chamfer
