#include "preprocess/rounding/round_solid.h"

#include "common/text.h"
#include "preprocess/core/inradius.h"
#include "preprocess/rounding/convexity.h"

#include <algorithm>
#include <chrono>

namespace chamfer {
namespace {

constexpr std::size_t kLargeSolid = 20000; ///< triangles of a solid whose stages are worth reporting

class Stopwatch {
public:
  /// Seconds since the last call or construction.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// Measures are told roughly.
std::string rough(double value) { return numberText(value, 3); }

/// Reports the stage of a solid that takes long by itself.
Share shareOf(const PreprocessOptions& options, const char* stage, const Surface& surface) {
  if (!options.progress || surface.triangles.size() < kLargeSolid) return [](double) {};
  return [&options, stage](double share) { options.progress(stage, share); };
}

/// By fans over the facets' corners, in order: how the hull was triangulated differs from run to run.
void takeHullTriangles(const HullResult& hull, const Polytope& polytope, RoundedSolid& solid) {
  std::vector<std::pair<std::array<std::uint32_t, 3>, std::uint32_t>> triangles; // with facet
  const auto add = [&](std::array<std::uint32_t, 3> t, std::uint32_t facet) {
    for (std::uint32_t& v : t)
      v = hull.vertexOf[v];
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    triangles.emplace_back(t, facet);
  };
  for (std::uint32_t f = 0; f < polytope.loops.size(); ++f) {
    const auto loop = polytope.loops[f];
    const std::size_t first = std::size_t(std::min_element(loop.begin(), loop.end()) - loop.begin());
    for (std::size_t i = 1; i + 1 < loop.size(); ++i)
      add({loop[first], loop[(first + i) % loop.size()], loop[(first + i + 1) % loop.size()]}, f);
  }
  if (polytope.loops.size() == 0) // a facet's border is not one loop
    for (std::size_t t = 0; t < hull.hull.triangles.size(); ++t)
      add(hull.hull.triangles[t], polytope.facetOfTriangle[t]);
  std::sort(triangles.begin(), triangles.end());
  for (const auto& [t, facet] : triangles) {
    solid.hullTriangles.push_back(t);
    solid.hullFacets.push_back(facet);
  }
}

/// Judges a surface that the cheap test did not accept. Within the tolerance its hull becomes the solid.
std::optional<Fault> judgeByHull(const Component& component, const PreprocessOptions& options,
                                 const Surface& surface, double diagonal, RoundedSolid& solid,
                                 Polytope& polytope, std::vector<Vector3>& positions) {
  const auto meshTriangle = [&](std::uint32_t t) { return component.meshTriangle[t]; };
  auto hull =
      hullOf(surface, options.tolerances.planarity * diagonal, shareOf(options, "convexity", surface));
  if (!hull)
    return Fault{FaultKind::Flat, "all its vertices lie in one plane", 0, component.positions.front(),
                 meshTriangle(0)};
  const HullVerdict& verdict = hull->verdict;
  const double relative = verdict.depth / diagonal;
  const bool asHull = options.onNonConvex == OnNonConvex::Hull;
  const Point3 place(verdict.place + solid.origin);
  if (!asHull && relative > options.tolerances.convexity)
    return Fault{FaultKind::Concave,
                 "its surface lies " + rough(relative) + " of its diagonal below its convex hull at " +
                     pointText(place.x, place.y, place.z, 6) + "; the tolerance is " +
                     rough(options.tolerances.convexity) + " (--convexity)",
                 relative, place, meshTriangle(verdict.triangle)};
  // A surface that stays near its hull but encloses another volume winds around it more than once, or folds.
  if (!asHull && std::abs(verdict.coverage - 1) > 0.5)
    return Fault{FaultKind::SelfIntersecting,
                 "it encloses " + rough(verdict.coverage) +
                     " times the volume of its convex hull, so its faces fold "
                     "or wind around more than once",
                 verdict.coverage, component.positions.front(), meshTriangle(0)};
  solid.depth = relative;
  solid.usedHull = relative > options.tolerances.convexity;
  polytope = std::move(hull->facets);
  // Raises each plane to its farthest vertex; a hull passes unless merging went wrong.
  if (cheapToCompare(hull->hull, polytope) &&
      !convexByPlanes(hull->hull, polytope, 8 * options.tolerances.planarity * diagonal)) {
    // Facets of a hull that cannot be told apart well enough to merge: its triangles are its facets.
    polytope = findFacets(hull->hull, 0);
    convexByPlanes(hull->hull, polytope, options.tolerances.convexity * diagonal);
  }
  if (solid.usedHull) takeHullTriangles(*hull, polytope, solid);
  positions = hull->hull.positions;
  solid.facetOfTriangle = facetsOnHull(surface, hull->hull, polytope);
  return std::nullopt;
}

void recentre(RoundedSolid& solid, const Vector3& to, Polytope& polytope, std::vector<Vector3>& positions,
              std::vector<Vector3>& hullPositions) {
  solid.origin += to;
  for (Plane& p : polytope.facets)
    p.offset -= dot(p.normal, to);
  solid.boundRadius = 0;
  for (Vector3& p : positions) {
    p -= to;
    solid.boundRadius = std::max(solid.boundRadius, length(p));
  }
  for (Vector3& p : hullPositions)
    p -= to;
}

std::vector<FacetTree> buildTrees(const RoundedSolid& solid, const Surface& surface, const Share& share) {
  const Lists& loops = solid.core.loops;
  std::vector<FacetTree> trees;
  std::vector<Bounds3> domains; // by facet, once any is wanted
  for (std::uint32_t f = 0; f < loops.size(); ++f) {
    const auto loop = loops[f];
    if (f % 1024 == 0) share(double(f) / double(loops.size()));
    if (loop.size() <= kLoopIsLeaf) continue;
    if (domains.empty()) {
      domains.resize(loops.size());
      for (std::size_t t = 0; t < solid.facetOfTriangle.size(); ++t)
        for (const std::uint32_t v : surface.triangles[t])
          domains[solid.facetOfTriangle[t]].extend(Point3(surface.positions[v]));
    }
    for (const std::uint32_t v : loop)
      domains[f].extend(Point3(solid.core.vertices[v] + solid.facets[f].normal * solid.radius));
    trees.push_back(
        {f, buildDetectionTree(solid.facets[f], solid.core.vertices, loop, loops.start[f], domains[f])});
  }
  return trees;
}

} // namespace

RoundedSolid roundSolid(const Component& component, const PreprocessOptions& options, StageTimes& times) {
  RoundedSolid solid;
  if (component.fault) {
    solid.fault = component.fault;
    return solid;
  }
  Stopwatch watch;
  const double diagonal = component.bounds.diagonal();
  solid.origin = Vector3(component.bounds.centre());
  Surface surface;
  surface.positions.reserve(component.positions.size());
  for (const Point3& p : component.positions)
    surface.positions.push_back(Vector3(p) - solid.origin);
  surface.triangles = component.triangles;
  surface.opposite = component.opposite;
  for (const Vector3& p : surface.positions)
    solid.boundRadius = std::max(solid.boundRadius, length(p));

  Polytope polytope = findFacets(surface, options.tolerances.planarity * diagonal);
  times.facets += watch.lap();
  std::vector<Vector3> hullPositions;
  const bool plain = convexByPlanes(surface, polytope, options.tolerances.planarity * diagonal);
  if (!plain) {
    solid.fault = judgeByHull(component, options, surface, diagonal, solid, polytope, hullPositions);
    if (solid.fault) return solid;
  } else {
    solid.facetOfTriangle = std::move(polytope.facetOfTriangle);
  }
  times.convexity += watch.lap();

  const Share inCore = shareOf(options, "core", surface),
              inDetection = shareOf(options, "detection", surface);
  inCore(0);
  const InnerBall inner = largestBall(polytope.facets, solid.boundRadius);
  solid.inradius = inner.radius;
  if (!(inner.radius > 1e-9 * diagonal)) {
    solid.fault = Fault{FaultKind::Flat,
                        "it is flat: its inradius is " + rough(inner.radius / diagonal) + " of its diagonal",
                        inner.radius / diagonal, component.positions.front(), component.meshTriangle.front()};
    return solid;
  }
  solid.cornersOver3 = polytope.cornersOver3;
  solid.radius = options.radius.relative ? options.radius.value * diagonal : options.radius.value;
  if (options.clamp > 0 && solid.radius > options.clamp * inner.radius) {
    solid.radius = options.clamp * inner.radius;
    solid.clamped = true;
  }
  if (!(solid.radius < inner.radius)) {
    solid.radiusTooLarge = true;
    return solid;
  }
  // The frame's origin becomes the inner ball's centre, a point inside E.
  recentre(solid, inner.centre, polytope, surface.positions, hullPositions);
  const MergeTolerance merge = mergeTolerance(solid.boundRadius, inner.radius, solid.radius);
  inCore(0.2);
  auto core = offsetCore(polytope, plain ? surface.positions : hullPositions, solid.radius, merge.preferred);
  if (!core)
    core = exactCore(polytope.facets, solid.radius, merge, [&](double share) { inCore(0.2 + 0.8 * share); });
  if (!core) {
    solid.radiusTooLarge = true;
    return solid;
  }
  solid.core = std::move(*core);
  solid.facets = std::move(polytope.facets);
  linkCore(solid);
  times.core += watch.lap();
  solid.trees = buildTrees(solid, surface, inDetection);
  times.detection += watch.lap();
  return solid;
}

} // namespace chamfer
