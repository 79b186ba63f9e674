#include "preprocess/components/solids.h"

#include "preprocess/components/component_builder.h"
#include "preprocess/components/disjoint_sets.h"
#include "preprocess/components/grouping.h"
#include "preprocess/components/nesting.h"
#include "preprocess/components/repair.h"
#include "preprocess/components/repeats.h"
#include "preprocess/worker_arena.h"

#include <algorithm>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

namespace chamfer {
namespace {

std::size_t countUnused(const TriangleMesh& mesh) {
  std::vector<char> used(mesh.positions.size());
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t)
      used[v] = 1;
  return std::size_t(std::count(used.begin(), used.end(), 0));
}

void countTurns(Components& result) {
  std::size_t mixed = 0, first = 0;
  for (std::size_t i = 0; i < result.list.size(); ++i) {
    const Component& c = result.list[i];
    result.counts.turned += c.turned;
    if (c.turned || c.turnedTriangles == 0) continue;
    if (mixed++ == 0) first = i;
    result.counts.turnedTriangles += c.turnedTriangles;
  }
  if (mixed > 0)
    result.warnings.push_back(
        "the faces of " + std::to_string(mixed) + " component(s) were oriented both ways; " +
        std::to_string(result.counts.turnedTriangles) +
        " triangles were turned to agree with the rest, first in component " + std::to_string(first + 1));
}

} // namespace

const char* faultWord(FaultKind kind) {
  switch (kind) {
  case FaultKind::Open:
    return "open";
  case FaultKind::NonManifold:
    return "non-manifold";
  case FaultKind::Misoriented:
    return "misoriented";
  case FaultKind::InsideOut:
    return "inside-out";
  case FaultKind::Flat:
    return "flat";
  case FaultKind::NotFinite:
    return "not-finite";
  case FaultKind::Concave:
    return "concave";
  case FaultKind::SelfIntersecting:
    return "self-intersecting";
  case FaultKind::TooFew:
    return "too-few-triangles";
  case FaultKind::Genus:
    return "genus";
  }
  return "unknown";
}

Components splitComponents(const TriangleMesh& mesh, const InputTolerances& tolerances, unsigned threads) {
  Components result;
  WorkerArena arena(threads);
  const ForEach forEach = [&](std::size_t count, const std::function<void(std::size_t)>& body) {
    arena.execute([&] {
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 64), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i)
          body(i);
      });
    });
  };

  DisjointSets sets(mesh.positions.size());
  for (const auto& t : mesh.triangles)
    sets.join(sets.join(t[0], t[1]), t[2]);
  const Lists groups = listsBy(mesh.triangles.size(), mesh.positions.size(),
                               [&](std::uint32_t i) { return sets.find(mesh.triangles[i][0]); });
  const std::size_t count = groups.size();
  result.counts.unusedVertices = countUnused(mesh);
  std::vector<ByIndex> byIndex(count, ByIndex::Open);
  if (!mesh.soup) { // whose indices say nothing
    result.list.resize(count);
    std::vector<std::uint32_t> localOf(mesh.positions.size(), kNone);
    tbb::enumerable_thread_specific<ComponentBuilder> builders(
        [&] { return ComponentBuilder(mesh, tolerances); });
    forEach(count, [&](std::size_t i) {
      byIndex[i] = builders.local().buildByIndex(groups[i], localOf, result.list[i]);
    });
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i)
      if (byIndex[i] == ByIndex::Closed) {
        result.counts.degenerateTriangles += result.list[i].degenerate.size();
        if (kept != i) result.list[kept] = std::move(result.list[i]);
        ++kept;
      }
    result.list.resize(kept);
  }
  if (result.list.size() < count) {
    std::vector<std::uint32_t> crowded, open;
    for (std::size_t i = 0; i < count; ++i) {
      if (byIndex[i] == ByIndex::Closed) continue;
      auto& to = byIndex[i] == ByIndex::Crowded ? crowded : open;
      to.insert(to.end(), groups[i].begin(), groups[i].end());
    }
    repairComponents(mesh, tolerances, crowded, open, forEach, result);
    std::sort(result.list.begin(), result.list.end(), [](const Component& a, const Component& b) {
      return a.meshTriangle.front() < b.meshTriangle.front();
    });
  }
  dropRepeats(mesh, tolerances.planarity, result);
  findCavities(result.list);
  countTurns(result);
  return result;
}

} // namespace chamfer
