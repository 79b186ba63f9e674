#include "preprocess/solids.h"

#include "preprocess/component_builder.h"
#include "preprocess/disjoint_sets.h"
#include "preprocess/nesting.h"
#include "preprocess/polytope.h"
#include "preprocess/repair.h"

#include <algorithm>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace chamfer {
namespace {

struct IndexGroups {
  Lists triangles; ///< of each group, ascending; groups in order of their first triangle
  std::size_t unusedVertices = 0;
};

IndexGroups groupByIndex(const TriangleMesh& mesh) {
  DisjointSets sets(mesh.positions.size());
  for (const auto& t : mesh.triangles)
    sets.join(sets.join(t[0], t[1]), t[2]);
  IndexGroups groups;
  std::vector<std::uint32_t> groupOfSet(mesh.positions.size(), kNone), groupOf(mesh.triangles.size());
  std::vector<std::uint32_t>& start = groups.triangles.start;
  start.clear();
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    std::uint32_t& group = groupOfSet[sets.find(mesh.triangles[i][0])];
    if (group == kNone) {
      group = std::uint32_t(start.size());
      start.push_back(0);
    }
    groupOf[i] = group;
    ++start[group];
  }
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v)
    groups.unusedVertices += groupOfSet[sets.find(v)] == kNone;
  start.push_back(0);
  std::uint32_t sum = 0;
  for (std::uint32_t& s : start)
    s = sum += s;
  groups.triangles.items.resize(mesh.triangles.size());
  for (std::size_t i = mesh.triangles.size(); i-- > 0;)
    groups.triangles.items[--start[groupOf[i]]] = std::uint32_t(i);
  return groups;
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
  tbb::task_arena arena(threads ? int(threads) : tbb::task_arena::automatic);
  const ForEach forEach = [&](std::size_t count, const std::function<void(std::size_t)>& body) {
    arena.execute([&] {
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 64), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i)
          body(i);
      });
    });
  };

  const IndexGroups groups = groupByIndex(mesh);
  const std::size_t count = groups.triangles.size();
  result.counts.unusedVertices = groups.unusedVertices;
  std::vector<ByIndex> byIndex(count, ByIndex::Open);
  if (!mesh.soup) { // whose indices say nothing
    result.list.resize(count);
    std::vector<std::uint32_t> localOf(mesh.positions.size(), kNone);
    tbb::enumerable_thread_specific<ComponentBuilder> builders(
        [&] { return ComponentBuilder(mesh, tolerances); });
    forEach(count, [&](std::size_t i) {
      byIndex[i] = builders.local().buildByIndex(groups.triangles[i], localOf, result.list[i]);
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
      to.insert(to.end(), groups.triangles[i].begin(), groups.triangles[i].end());
    }
    repairComponents(mesh, tolerances, crowded, open, forEach, result);
    std::sort(result.list.begin(), result.list.end(), [](const Component& a, const Component& b) {
      return a.meshTriangle.front() < b.meshTriangle.front();
    });
  }
  findCavities(result.list);
  countTurns(result);
  return result;
}

} // namespace chamfer
