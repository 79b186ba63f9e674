#include "preprocess/components/dropped.h"

#include "common/rounding.h"

#include <algorithm>

namespace chamfer {

void assignDropped(const TriangleMesh& mesh, std::span<const std::uint32_t> standsFor,
                   std::size_t firstComponent, Dropped dropped, Components& components) {
  auto& [degenerate, duplicates] = dropped;
  components.counts.degenerateTriangles += degenerate.size();
  if (degenerate.empty() && duplicates.empty()) return;
  std::sort(degenerate.begin(), degenerate.end());
  std::sort(duplicates.begin(), duplicates.end());
  std::vector<Component>& list = components.list;
  std::vector<std::uint32_t> ofVertex(mesh.positions.size(), kNone), ofTriangle(mesh.triangles.size(), kNone);
  for (std::size_t i = firstComponent; i < list.size(); ++i)
    for (const std::uint32_t m : list[i].meshTriangle) {
      ofTriangle[m] = std::uint32_t(i);
      for (const std::uint32_t v : mesh.triangles[m])
        ofVertex[standsFor[v]] = std::uint32_t(i);
    }
  // What stays for a triangle may itself have been dropped for another one later.
  std::vector<std::uint32_t> staysFor(mesh.triangles.size(), kNone);
  for (const auto& [triangle, stays] : duplicates)
    if (ofTriangle[triangle] == kNone) staysFor[triangle] = stays;
  for (std::uint32_t triangle = 0; triangle < staysFor.size(); ++triangle) {
    if (staysFor[triangle] == kNone) continue;
    ++components.counts.duplicateTriangles;
    std::uint32_t stays = staysFor[triangle];
    for (std::size_t steps = duplicates.size(); // parts of two triangles may stay for each other
         steps > 0 && ofTriangle[stays] == kNone && staysFor[stays] != kNone; --steps)
      stays = staysFor[stays];
    const std::uint32_t i = ofTriangle[stays];
    if (i == kNone) { // for one without height
      degenerate.push_back(triangle);
      continue;
    }
    list[i].duplicates.push_back({triangle, stays});
    for (const std::uint32_t v : mesh.triangles[triangle])
      if (std::uint32_t& of = ofVertex[standsFor[v]]; of == kNone) of = i;
  }
  // Some hang on others that are dropped, too.
  for (bool found = true; found;)
    found = std::erase_if(degenerate, [&](std::uint32_t m) {
              const auto& t = mesh.triangles[m];
              const auto known = std::find_if(
                  t.begin(), t.end(), [&](std::uint32_t v) { return ofVertex[standsFor[v]] != kNone; });
              if (known == t.end()) return false;
              const std::uint32_t i = ofVertex[standsFor[*known]];
              list[i].degenerate.push_back(m);
              for (const std::uint32_t v : t)
                ofVertex[standsFor[v]] = i;
              return true;
            }) > 0;
  for (std::size_t i = firstComponent; i < list.size(); ++i)
    std::sort(list[i].degenerate.begin(), list[i].degenerate.end());
}

} // namespace chamfer
