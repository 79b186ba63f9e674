#include "preprocess/preprocess.h"

#include "common/error.h"
#include "common/text.h"
#include "preprocess/components/diagonals.h"
#include "preprocess/rounding/hulled_mesh.h"
#include "preprocess/rounding/round_solid.h"
#include "preprocess/worker_arena.h"

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <cmath>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

namespace chamfer {
namespace {

/// Of the report, beside those of reading: one a component would be too many to read.
constexpr std::size_t kMostWarnings = 50;

/// Frees what only the rounding of the component needed, on the thread that is done with it: for many small
/// solids freeing costs as much as a stage.
void releaseSurface(Component& component) {
  component.positions = {};
  component.triangles = {};
  component.opposite = {};
}

void add(StageTimes& to, const StageTimes& t) {
  to.convexity += t.convexity;
  to.facets += t.facets;
  to.core += t.core;
  to.detection += t.detection;
}

/// Where a fault was seen, and how far the face there is from flat.
std::string placeOfFault(const TriangleMesh& mesh, const Component& component, const Fault& fault) {
  if (fault.triangle >= mesh.triangles.size()) return "";
  std::string text =
      "; nearest triangle " + std::to_string(fault.triangle) + " of " + placeOfTriangle(mesh, fault.triangle);
  const Warp warp = warpOf(mesh, fault.triangle);
  if (fault.kind == FaultKind::Concave &&
      warp.distance > InputTolerances{}.planarity * component.bounds.diagonal())
    text += ", which is warped: its " + std::to_string(warp.corners) + " corners lie up to " +
            numberText(warp.distance) + " off one plane";
  return text;
}

[[noreturn]] void refuseFaults(const TriangleMesh& mesh, const Components& components,
                               const std::vector<RoundedSolid>& solids) {
  std::size_t first = solids.size(), count = 0;
  for (std::size_t i = solids.size(); i-- > 0;)
    if (solids[i].fault) {
      first = i;
      ++count;
    }
  const Fault& fault = *solids[first].fault;
  std::string message = "component " + std::to_string(first + 1) + " of " +
                        std::to_string(components.list.size()) + " is not a closed convex solid (" +
                        faultWord(fault.kind) + "): " + fault.message;
  message += placeOfFault(mesh, components.list[first], fault);
  if (count > 1) message += "; " + std::to_string(count - 1) + " more components are refused, too";
  message +=
      ". --on-nonconvex sharp leaves such components sharp, hull rounds a closed one as its convex hull";
  Error error(ErrorKind::NotConvexSolid, message);
  error.with("component", double(first + 1));
  if (fault.triangle != kNone) error.with("triangle", fault.triangle);
  error.with("measure", fault.measure)
      .with("x", fault.place.x)
      .with("y", fault.place.y)
      .with("z", fault.place.z);
  throw error;
}

/// The component whose radius is farthest beyond what it admits.
[[noreturn]] void refuseRadius(const std::vector<RoundedSolid>& solids, const Radius& asked) {
  std::size_t worst = solids.size(), count = 0;
  for (std::size_t i = 0; i < solids.size(); ++i)
    if (solids[i].radiusTooLarge) {
      ++count;
      if (worst == solids.size() ||
          solids[i].inradius * solids[worst].radius < solids[worst].inradius * solids[i].radius)
        worst = i;
    }
  const RoundedSolid& s = solids[worst];
  const double largest = 0.999 * s.inradius;
  std::string message = "radius " + numberText(s.radius) + " is too large for solid " +
                        std::to_string(worst + 1) + ", whose inradius is " + numberText(s.inradius) +
                        ": the largest radius that works is " + numberText(largest);
  if (asked.relative)
    message += ", " + numberText(100 * asked.value * largest / s.radius) + "% of its diagonal";
  if (s.radius < largest) // within the limit, and yet no core: thinner than its storage
    message = "solid " + std::to_string(worst + 1) + " has no core that can be stored at radius " +
              numberText(s.radius) + ": it is too thin there; take a smaller radius";
  if (count > 1) message += " (" + std::to_string(count) + " solids are too small)";
  message += ". --clamp 0.9 rounds each solid with at most 0.9 of its own inradius";
  throw Error(ErrorKind::RadiusTooLarge, message)
      .with("solid", double(worst + 1))
      .with("radius", s.radius)
      .with("inradius", s.inradius)
      .with("max_radius", largest);
}

} // namespace

Radius parseRadius(std::string_view text) {
  Radius radius;
  std::string_view digits = text;
  if (digits.ends_with('%')) {
    radius.relative = true;
    digits.remove_suffix(1);
  }
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), radius.value);
  if (error != std::errc{} || end != digits.data() + digits.size() || !std::isfinite(radius.value) ||
      !(radius.value > 0))
    throw Error(ErrorKind::Usage,
                "radius '" + std::string(text) +
                    "' is not a number above 0: write a length such as 0.1, or a share of each "
                    "solid's diagonal such as 2%");
  if (radius.relative) radius.value /= 100;
  return radius;
}

RoundingOptions recordOf(const PreprocessOptions& o) {
  return {o.radius.value,         o.radius.relative,      o.onNonConvex, o.tolerances.weld,
          o.tolerances.planarity, o.tolerances.convexity, o.clamp};
}

PreprocessOptions optionsOf(const RoundingOptions& r) {
  PreprocessOptions o;
  o.radius = {r.radius, r.relative};
  o.onNonConvex = r.onNonConvex;
  o.tolerances.weld = r.weld;
  o.tolerances.planarity = r.planarity;
  o.tolerances.convexity = r.convexity;
  o.clamp = r.clamp;
  return o;
}

PreprocessResult preprocess(const TriangleMesh& mesh, const PreprocessOptions& options) {
  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point t) {
    return std::chrono::duration<double>(Clock::now() - t).count();
  };
  const auto progress = [&](const char* stage, double share) {
    if (options.progress) options.progress(stage, share);
  };
  PreprocessResult result;
  PreprocessReport& report = result.report;

  progress("components", 0);
  auto start = Clock::now();
  Components components = splitComponents(mesh, options.tolerances, options.threads);
  report.times.components = since(start);
  report.counts = components.counts;
  report.warnings = mesh.warnings;
  report.warnings.insert(report.warnings.end(), components.warnings.begin(), components.warnings.end());
  if (components.list.empty())
    throw Error(ErrorKind::NotConvexSolid, "the mesh has no triangles, so there is no solid to round");

  const std::size_t count = components.list.size();
  std::vector<RoundedSolid> solids(count);
  std::atomic<std::size_t> done{0};
  tbb::enumerable_thread_specific<StageTimes> times;
  WorkerArena arena(options.threads);
  arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 16), [&](const auto& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        solids[i] = roundSolid(components.list[i], options, times.local());
        if (!solids[i].usedHull) releaseSurface(components.list[i]);
      }
      done += range.size();
      progress("rounding", double(done) / double(count));
    });
  });
  for (const StageTimes& t : times)
    add(report.times, t);

  const auto any = [&](auto&& what) { return std::any_of(solids.begin(), solids.end(), what); };
  // "hull" rounds closed components; one that is not even closed has no inside and is still refused.
  if (options.onNonConvex != OnNonConvex::Sharp &&
      any([](const RoundedSolid& s) { return s.fault.has_value(); }))
    refuseFaults(mesh, components, solids);
  if (any([](const RoundedSolid& s) { return s.radiusTooLarge; })) refuseRadius(solids, options.radius);

  progress("packing", 0);
  start = Clock::now();
  RoundingArrays arrays;
  arrays.facetOfTriangle.assign(mesh.triangles.size(), kNone);
  HulledMesh hulled(mesh);
  report.maxRadius = INFINITY;
  for (std::size_t i = 0; i < count; ++i) {
    const RoundedSolid& s = solids[i];
    if (s.fault) {
      ++report.sharpComponents;
      report.warnings.push_back("component " + std::to_string(i + 1) + " stays sharp (" +
                                faultWord(s.fault->kind) + "): " + s.fault->message +
                                placeOfFault(mesh, components.list[i], *s.fault));
      continue;
    }
    const auto firstFacet = std::uint32_t(arrays.facets.size());
    appendSolid(arrays, s, components.list[i].meshTriangle);
    for (const std::uint32_t t : components.list[i].degenerate)
      arrays.facetOfTriangle[t] = firstFacet;
    for (const auto& [triangle, twin] : components.list[i].duplicates)
      arrays.facetOfTriangle[triangle] = arrays.facetOfTriangle[twin];
    ++report.solids;
    report.facets += s.facets.size();
    report.roundedEdges += s.core.loops.items.size() / 2;
    report.spheres += s.core.vertices.size();
    report.cornersOver3 += s.cornersOver3;
    report.hulledComponents += s.usedHull;
    if (s.usedHull && !options.keepTriangles) hulled.replace(components.list[i], s, firstFacet);
    report.clampedSolids += s.clamped;
    report.nonConvexity = std::max(report.nonConvexity, s.depth);
    if (s.inradius < report.maxRadius) {
      report.maxRadius = s.inradius;
      report.maxRadiusSolid = i;
    }
    for (std::size_t f = 0; f < s.core.loops.size(); ++f)
      report.vanishedFacets += s.core.loops[f].empty();
  }
  if (report.solids == 0) report.maxRadius = 0;
  finishArrays(arrays);
  arena.execute([&] { tbb::parallel_for(std::size_t(0), count, [&](std::size_t i) { solids[i] = {}; }); });
  keepFirst(report.warnings, mesh.warnings.size() + kMostWarnings);
  report.treeNodes = arrays.treeNodes.size();
  if (hulled.changed()) result.mesh = std::make_shared<TriangleMesh>(hulled.finish(arrays.facetOfTriangle));
  result.rounding =
      makeRounding(std::move(arrays), geometryDigest(result.mesh ? *result.mesh : mesh), recordOf(options));
  report.times.pack = since(start);
  progress("packing", 1);
  return result;
}

} // namespace chamfer
