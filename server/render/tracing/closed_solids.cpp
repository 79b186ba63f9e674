#include "server/render/tracing/closed_solids.h"

#include "common/rounding.h"
#include "preprocess/components/solids.h"

namespace chamfer {
namespace {

Vector3 areaVector(const Point3& a, const Point3& b, const Point3& c) { return cross(b - a, c - a); }

} // namespace

ClosedSolids closedSolids(const TriangleMesh& mesh) {
  ClosedSolids result;
  result.ofTriangle.assign(mesh.triangles.size(), kNone);
  for (const Component& component : splitComponents(mesh, {}).list) {
    // Called inside out: wound the other way, inside another.
    const bool cavity = component.fault && component.fault->kind == FaultKind::InsideOut;
    if (component.fault && !cavity && component.fault->kind != FaultKind::Genus) continue;
    const auto solid = std::uint32_t(result.solids.size());
    result.solids.push_back({component.bounds, cavity});
    for (std::size_t i = 0; i < component.meshTriangle.size(); ++i) {
      const std::uint32_t t = component.meshTriangle[i];
      const auto& outward = component.triangles[i];
      const auto& written = mesh.triangles[t];
      const Vector3 a = areaVector(component.positions[outward[0]], component.positions[outward[1]],
                                   component.positions[outward[2]]),
                    b = areaVector(mesh.positions[written[0]], mesh.positions[written[1]],
                                   mesh.positions[written[2]]);
      result.ofTriangle[t] = solid | (dot(a, b) < 0 ? ClosedSolids::kTurned : 0u);
    }
  }
  return result;
}

} // namespace chamfer
