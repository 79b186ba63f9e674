#include "server/render/light/emitters.h"

#include <algorithm>

namespace chamfer {
namespace {

bool mayEmit(const SceneData& data, const InstanceSource& source) {
  return source.material == kNone ? !data.meshMaterials[source.mesh].ofTriangle.empty()
                                  : data.materials[source.material].emits();
}

/// 1 when the mesh closes a volume with all triangles turned outward, -1 when inward, 0 when it is not
/// closed: every edge must be used once in each direction.
int closedTurning(const TriangleMesh& mesh) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> forward, backward;
  double volume = 0;
  for (const auto& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      forward.emplace_back(t[k], t[(k + 1) % 3]);
      backward.emplace_back(t[(k + 1) % 3], t[k]);
    }
    const Vector3 origin(mesh.positions[mesh.triangles[0][0]]); // near the mesh, for the sake of digits
    const Vector3 a = Vector3(mesh.positions[t[0]]) - origin, b = Vector3(mesh.positions[t[1]]) - origin;
    volume += dot(cross(a, b), Vector3(mesh.positions[t[2]]) - origin);
  }
  std::sort(forward.begin(), forward.end());
  std::sort(backward.begin(), backward.end());
  if (forward != backward || std::adjacent_find(forward.begin(), forward.end()) != forward.end()) return 0;
  return volume > 0 ? 1 : volume < 0 ? -1 : 0;
}

/// Which solids can be aimed at through their unrounded surface: the emission must not depend on where a ray
/// meets it. A component that was rounded as its hull has triangles below P's facets, several of which can
/// lie behind each other.
template <class EmissionOf>
std::vector<bool> solidsToAimAt(const TriangleMesh& mesh, const RoundingView& view, EmissionOf&& emissionOf) {
  constexpr double kOffFacet = 1e-3; // of the solid's size
  std::vector<bool> aimedAt(view.solidCount(), true);
  std::vector<std::optional<Color>> emission(view.solidCount());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (view.facetOfTriangle[t] == kNone) continue;
    const FacetRecord& facet = view.facets[view.facetOfTriangle[t]];
    const SolidRecord& solid = view.solids[facet.solid];
    const Point3 origin(solid.origin[0], solid.origin[1], solid.origin[2]);
    if (!emission[facet.solid]) emission[facet.solid] = emissionOf(t);
    bool fits = *emission[facet.solid] == emissionOf(t);
    for (const std::uint32_t corner : mesh.triangles[t]) {
      const double height =
          dot(Vector3(facet.normal), mesh.positions[corner] - origin) - double(facet.offset);
      fits &= std::abs(height) <= kOffFacet * double(solid.boundRadius);
    }
    if (!fits) aimedAt[facet.solid] = false;
  }
  return aimedAt;
}

} // namespace

Emitters::Emitters(const Surfaces& surfaces, const std::vector<TracedInstance>& instances) {
  const SceneData& data = *surfaces.scene().data;
  for (std::uint32_t i = 0; i < instances.size(); ++i)
    if (mayEmit(data, data.instanceSource[i])) addInstance(surfaces, instances[i], i);
}

void Emitters::addInstance(const Surfaces& surfaces, const TracedInstance& instance, std::uint32_t index) {
  const TriangleMesh& mesh = surfaces.tracedMesh(surfaces.scene().data->instanceSource[index].mesh);
  const auto emissionOf = [&](std::size_t t) {
    const Material* material = surfaces.materialOfAll(index, std::uint32_t(t));
    return material ? material->emission : Color();
  };
  const RoundingView* view = instance.rounding ? &instance.rounding->view() : nullptr;
  const auto facetOf = [&](std::size_t t) { return view ? view->facetOfTriangle[t] : kNone; };
  std::vector<bool> aimedAt;
  if (view) {
    aimedAt = solidsToAimAt(mesh, *view, emissionOf);
    rounded_.emplace(
        index, RoundedEmitter{view, instance.worldFromObject, instance.worldFromObject.inverse(), aimedAt});
  }
  const Transform& world = instance.worldFromObject;
  const double turning = view ? 0 : closedTurning(mesh) * world.determinant();
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Color emission = emissionOf(t);
    if (emission.isBlack()) continue;
    const auto& corners = mesh.triangles[t];
    const Point3 a = world(mesh.positions[corners[0]]);
    EmissiveTriangle e{a,
                       world(mesh.positions[corners[1]]) - a,
                       world(mesh.positions[corners[2]]) - a,
                       emission,
                       index,
                       t,
                       kNone};
    if (lengthSquared(cross(e.edge1, e.edge2)) == 0) continue; // nothing to aim at
    if (turning != 0) {
      e.oneSided = true;
      if (turning < 0) std::swap(e.edge1, e.edge2);
    }
    if (const std::uint32_t facet = facetOf(t); facet != kNone) {
      e.oneSided = true;
      e.solid = view->facets[facet].solid;
      if (!aimedAt[e.solid]) continue;
      const Normal3 outward = world(Normal3(view->facets[facet].normal));
      if (dot(outward, cross(e.edge1, e.edge2)) < 0) std::swap(e.edge1, e.edge2);
    }
    triangles_.push_back(e);
  }
}

std::uint32_t Emitters::find(std::uint32_t instance, std::uint32_t triangle) const {
  const auto key = std::pair(instance, triangle);
  const auto found = std::lower_bound(
      triangles_.begin(), triangles_.end(), key,
      [](const EmissiveTriangle& e, const auto& k) { return std::pair(e.instance, e.triangle) < k; });
  if (found == triangles_.end() || std::pair(found->instance, found->triangle) != key) return kNone;
  return std::uint32_t(found - triangles_.begin());
}

Emitters::Ball Emitters::ball(std::uint32_t instance, std::uint32_t solid) const {
  const RoundedEmitter& r = rounded_.at(instance);
  const SolidRecord& record = r.view->solids[solid];
  const auto& m = r.worldFromObject.rows();
  double stretch = 0; // Frobenius norm: no direction grows by more
  for (const auto& row : m)
    stretch += row[0] * row[0] + row[1] * row[1] + row[2] * row[2];
  return {r.worldFromObject(Point3(record.origin[0], record.origin[1], record.origin[2])),
          double(record.boundRadius) * std::sqrt(stretch)};
}

std::optional<Emitters::Entry> Emitters::entry(std::uint32_t instance, std::uint32_t solid,
                                               const Ray& ray) const {
  const auto found = rounded_.find(instance);
  if (found == rounded_.end() || !found->second.aimedAt[solid]) return {};
  const RoundingView& view = *found->second.view;
  const SolidRecord& record = view.solids[solid];
  const Ray local = found->second.objectFromWorld(ray);
  const Vector3 origin = local.origin - Point3(record.origin[0], record.origin[1], record.origin[2]);
  double in = 0, out = INFINITY;
  const FacetRecord* front = nullptr;
  for (std::uint32_t f = record.firstFacet; f < view.solids[solid + 1].firstFacet; ++f) {
    const FacetRecord& facet = view.facets[f];
    const Vector3 n(facet.normal);
    const double slope = dot(n, local.direction), height = double(facet.offset) - dot(n, origin);
    if (slope < 0 && height / slope > in) {
      in = height / slope;
      front = &facet;
    } else if (slope > 0) {
      out = std::min(out, height / slope);
    } else if (slope == 0 && height < 0) {
      return {};
    }
  }
  if (!front || in > out) return {};
  const Vector3 n(found->second.worldFromObject(Normal3(front->normal)));
  return Entry{in,
               std::abs(dot(n, ray.direction)) / std::sqrt(lengthSquared(n) * lengthSquared(ray.direction))};
}

} // namespace chamfer
