#include "server/render/tracing/closed_solids.h"

#include "common/rounding.h"
#include "preprocess/components/solids.h"

#include <algorithm>

namespace chamfer {
namespace {

Vector3 areaVector(const Point3& a, const Point3& b, const Point3& c) { return cross(b - a, c - a); }

bool holds(const Bounds3& outer, const Bounds3& inner) {
  for (std::size_t k = 0; k < 3; ++k)
    if (!(outer.lower[k] < inner.lower[k] && inner.upper[k] < outer.upper[k])) return false;
  return true;
}

} // namespace

ClosedSolids closedSolids(const TriangleMesh& mesh) {
  ClosedSolids result;
  result.ofTriangle.assign(mesh.triangles.size(), kNone);
  for (const Component& component : splitComponents(mesh, {}).list) {
    // A component inside another that is wound the other way is left as it is, and called inside out.
    const bool insideOut = component.fault && component.fault->kind == FaultKind::InsideOut;
    if (component.fault && !insideOut && component.fault->kind != FaultKind::Genus) continue;
    const auto solid = std::uint32_t(result.solids.size());
    result.solids.push_back({component.bounds, component.turned || insideOut});
    for (std::size_t i = 0; i < component.meshTriangle.size(); ++i) {
      const std::uint32_t t = component.meshTriangle[i];
      const auto& outward = component.triangles[i];
      const auto& written = mesh.triangles[t];
      const Vector3 a = areaVector(component.positions[outward[0]], component.positions[outward[1]],
                                   component.positions[outward[2]]),
                    b = areaVector(mesh.positions[written[0]], mesh.positions[written[1]],
                                   mesh.positions[written[2]]);
      result.ofTriangle[t] = solid | ((dot(a, b) < 0) != insideOut ? ClosedSolids::kTurned : 0u);
    }
  }
  for (ClosedSolids::Solid& s : result.solids)
    s.cavity = s.cavity && std::any_of(result.solids.begin(), result.solids.end(),
                                       [&](const auto& other) { return holds(other.bounds, s.bounds); });
  return result;
}

} // namespace chamfer
