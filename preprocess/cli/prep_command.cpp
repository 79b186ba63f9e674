#include "preprocess/cli/prep_command.h"

#include "common/atomic_file.h"
#include "common/error.h"
#include "common/progress_line.h"
#include "preprocess/cli/output_paths.h"
#include "preprocess/rounding/explicit_mesh.h"
#include "preprocess/rounding/explicit_mesh_uv.h"

#include <chrono>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>

namespace chamfer {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

struct Outcome {
  PreprocessReport report;
  std::filesystem::path sidecar;
  std::size_t sidecarBytes = 0, explicitTriangles = 0;
  double readSeconds = 0, seconds = 0;
};

/// `warnings` are those of reading, known even where the mesh is then refused.
Outcome roundOne(const PrepCommandOptions& options, const std::filesystem::path& path,
                 std::vector<std::string>& warnings) {
  const auto seconds = [](Clock::time_point since) {
    return std::chrono::duration<double>(Clock::now() - since).count();
  };
  ProgressLine progress(!options.quiet && !options.json);
  Outcome outcome;
  const auto start = Clock::now();
  progress("reading", 0);
  const auto read = std::make_shared<const TriangleMesh>(readMesh(path));
  outcome.readSeconds = seconds(start);
  warnings = read->warnings;
  PreprocessOptions preprocessOptions = options.preprocess;
  preprocessOptions.progress = [&](const char* stage, double share) { progress(stage, share); };
  const auto afterReading = Clock::now();
  const PreprocessResult result = preprocess(*read, preprocessOptions);
  outcome.seconds = seconds(afterReading);
  outcome.report = result.report;
  // Both files or none: the explicit mesh takes its name once the sidecar is written.
  std::optional<AtomicFile> staged;
  if (!options.explicitMesh.empty()) {
    if (std::error_code error; std::filesystem::is_directory(options.explicitMesh, error))
      throw Error(ErrorKind::CannotWrite,
                  "cannot write " + options.explicitMesh.string() + ": it is a folder");
    const auto mesh = result.mesh ? result.mesh : read;
    ExplicitMesh rounded = explicitMesh(result.rounding->view(), *mesh, options.segments);
    if (const CutTextures cuts = addTextureCoordinates(rounded, mesh, result.rounding); cuts.triangles > 0)
      outcome.report.warnings.push_back(
          placeOfTriangle(*mesh, cuts.first) + ": its texture coordinates end within a flat facet; " +
          std::to_string(cuts.triangles) +
          " triangles of the explicit mesh carry them on past there: lay the facet out in one piece");
    outcome.explicitTriangles = rounded.triangles.size();
    if (!options.dryRun) writeExplicitMesh(staged.emplace(options.explicitMesh), rounded);
  }
  outcome.sidecar = sidecarPath(options, path);
  outcome.sidecarBytes =
      options.dryRun ? serializedSize(*result.rounding) : writeSidecar(outcome.sidecar, *result.rounding);
  if (staged) staged->commit();
  return outcome;
}

Json toJson(const std::filesystem::path& mesh, const PrepCommandOptions& options, const Outcome& o) {
  const PreprocessReport& r = o.report;
  return Json{{"mesh", mesh.string()},
              {"sidecar", options.dryRun ? Json(nullptr) : Json(o.sidecar.string())},
              {"solids", r.solids},
              {"facets", r.facets},
              {"rounded_edges", r.roundedEdges},
              {"spheres", r.spheres},
              {"corners_over_3", r.cornersOver3},
              {"max_radius", r.solids > 0 ? Json(r.maxRadius) : Json(nullptr)},
              {"max_radius_solid", r.solids > 0 ? Json(r.maxRadiusSolid + 1) : Json(nullptr)},
              {"sidecar_bytes", o.sidecarBytes},
              {"seconds", o.seconds},
              {"read_seconds", o.readSeconds},
              {"vanished_facets", r.vanishedFacets},
              {"sharp_components", r.sharpComponents},
              {"hulled_components", r.hulledComponents},
              {"clamped_solids", r.clampedSolids},
              {"nonconvexity", r.nonConvexity},
              {"tree_nodes", r.treeNodes},
              {"welded_vertices", r.counts.weldedVertices},
              {"unused_vertices", r.counts.unusedVertices},
              {"degenerate_triangles", r.counts.degenerateTriangles},
              {"duplicate_triangles", r.counts.duplicateTriangles},
              {"duplicate_solids", r.counts.duplicateSolids},
              {"split_edges", r.counts.splitEdges},
              {"turned_components", r.counts.turned},
              {"thread_seconds",
               {{"components", r.times.components},
                {"facets", r.times.facets},
                {"convexity", r.times.convexity},
                {"core", r.times.core},
                {"detection", r.times.detection},
                {"pack", r.times.pack}}},
              {"explicit_triangles", o.explicitTriangles},
              {"warnings", r.warnings}};
}

void printReport(const std::filesystem::path& mesh, const PrepCommandOptions& options, const Outcome& o) {
  const PreprocessReport& r = o.report;
  std::printf("%s: %zu solids, %zu facets, %zu rounded edges, %zu spheres\n", mesh.c_str(), r.solids,
              r.facets, r.roundedEdges, r.spheres);
  std::printf("  corners of more than 3 facets %zu, vanished facets %zu, largest radius below %.9g\n",
              r.cornersOver3, r.vanishedFacets, r.maxRadius);
  const ComponentCounts& c = r.counts;
  if (c.weldedVertices + c.unusedVertices + c.degenerateTriangles + c.duplicateTriangles + c.turned > 0)
    std::printf(
        "  welded %zu vertices, unused %zu; dropped %zu degenerate and %zu duplicate triangles; turned %zu "
        "components outward\n",
        c.weldedVertices, c.unusedVertices, c.degenerateTriangles, c.duplicateTriangles, c.turned);
  if (c.splitEdges > 0)
    std::printf(
        "  %zu edges have vertices on them that their face does not know (T-junctions): taken as closed\n",
        c.splitEdges);
  if (r.nonConvexity > 0) std::printf("  deepest below a hull, in diagonals: %.3g\n", r.nonConvexity);
  if (r.sharpComponents + r.hulledComponents + r.clampedSolids > 0)
    std::printf("  kept sharp %zu, rounded as hull %zu, radius clamped on %zu\n", r.sharpComponents,
                r.hulledComponents, r.clampedSolids);
  std::printf("  %s%s: %zu bytes (%.1f per rounded edge), %.4f s after reading for %.4f s\n",
              options.dryRun ? "not written, " : "", o.sidecar.c_str(), o.sidecarBytes,
              r.roundedEdges ? double(o.sidecarBytes) / double(r.roundedEdges) : 0.0, o.seconds,
              o.readSeconds);
  if (!options.explicitMesh.empty())
    std::printf("  %s%s: %zu triangles with %u segments across each edge\n",
                options.dryRun ? "not written, " : "", options.explicitMesh.c_str(), o.explicitTriangles,
                options.segments);
  for (const std::string& w : r.warnings)
    std::printf("  warning: %s\n", w.c_str());
}

Json errorJson(const std::filesystem::path& mesh, const char* word, const std::string& message, int status,
               const std::vector<std::pair<std::string, double>>& details,
               const std::vector<std::string>& warnings) {
  Json error{{"kind", word}, {"message", message}, {"exit_status", status}};
  for (const auto& [key, value] : details)
    error[key] = value;
  return Json{{"mesh", mesh.string()}, {"error", error}, {"warnings", warnings}};
}

std::string dump(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace); }

} // namespace

int runPrepCommand(const PrepCommandOptions& options) {
  int status = 0;
  Json all = Json::array();
  for (const auto& mesh : options.meshes) {
    std::vector<std::string> warnings;
    const auto failed = [&](const char* word, const std::string& message, int exit,
                            const std::vector<std::pair<std::string, double>>& details) {
      if (status == 0) status = exit;
      std::fprintf(stderr, "chamferprep: %s: %s\n", mesh.c_str(), message.c_str());
      for (const std::string& w : warnings)
        if (!options.quiet) std::fprintf(stderr, "chamferprep: %s: warning: %s\n", mesh.c_str(), w.c_str());
      if (options.json) all.push_back(errorJson(mesh, word, message, exit, details, warnings));
    };
    try {
      const Outcome outcome = roundOne(options, mesh, warnings);
      if (options.json)
        all.push_back(toJson(mesh, options, outcome));
      else if (!options.quiet)
        printReport(mesh, options, outcome);
    } catch (const Error& e) {
      failed(errorWord(e.kind()), e.what(), exitStatus(e.kind()), e.details());
    } catch (const std::bad_alloc&) {
      failed("internal", "out of memory", 1, {});
    } catch (const std::exception& e) {
      failed("internal", std::string("a defect of chamferprep: ") + e.what(), 1, {});
    }
  }
  if (options.json) std::cout << dump(all.size() == 1 ? all[0] : all) << '\n';
  return status;
}

} // namespace chamfer
