#include "common/error.h"
#include "preprocess/cli/output_paths.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>

int main(int argc, char** argv) {
  using namespace chamfer;
  PrepCommandOptions options;
  PreprocessOptions& p = options.preprocess;
  std::string radius;
  CLI::App app{
      "Rounds every edge and corner of the convex solids in a mesh, exactly, without touching the mesh:\n"
      "writes MESH.chamfer beside it, for chamferd to render.",
      "chamferprep"};
  app.add_option("MESH", options.meshes, "Meshes: .obj, .stl, .ply or .off")->required();
  app.add_option("-r,--radius", radius,
                 "Rounding radius, above 0: a length in mesh units (0.1), or a share of each solid's\n"
                 "bounding box diagonal (2%)")
      ->required();
  app.add_option("-o,--output", options.output, "Where to write: a folder, or a file for a single mesh");
  app.add_option(
      "--mesh", options.explicitMesh,
      "Also write the rounded solids as an explicit mesh for other engines: .obj, with vertex normals, and\n"
      "texture coordinates where MESH has them");
  app.add_option("--segments", options.segments, "Segments of the explicit mesh across each edge (1 to 256)")
      ->capture_default_str()
      ->check(CLI::Range(1u, 256u));
  app.add_option("--clamp", p.clamp,
                 "Round each solid with at most this share of its own inradius (0 to 0.999)")
      ->check(CLI::Range(0.0, kMostClamp));
  const std::map<std::string, OnNonConvex> choices{
      {"error", OnNonConvex::Error}, {"sharp", OnNonConvex::Sharp}, {"hull", OnNonConvex::Hull}};
  app.add_option("--on-nonconvex", p.onNonConvex,
                 "What to do with a component that is not a closed convex solid: error (write nothing),\n"
                 "sharp (leave it as it is), hull (round a closed one as its convex hull)")
      ->transform(CLI::CheckedTransformer(choices));
  app.add_option(
         "--weld", p.tolerances.weld,
         "Vertices nearer than this share of a component's diagonal are one, and nearer to an edge lie on it")
      ->capture_default_str()
      ->check(CLI::Range(0.0, kMostWeld));
  app.add_option("--planarity", p.tolerances.planarity,
                 "Triangles this near to a plane, as a share of the diagonal, are one facet")
      ->capture_default_str()
      ->check(CLI::Range(0.0, kMostPlanarity));
  app.add_option("--convexity", p.tolerances.convexity,
                 "Depth below the convex hull, as a share of the diagonal, that still counts as convex")
      ->capture_default_str()
      ->check(CLI::Range(0.0, kMostConvexity));
  app.add_option("-j,--threads", p.threads, "Threads (0: all)")->capture_default_str();
  app.add_flag("--json", options.json, "Print the report as JSON (an array when there are several meshes)");
  app.add_flag("--dry-run", options.dryRun, "Do everything but write");
  app.add_flag("-q,--quiet", options.quiet, "Print errors only");
  app.set_version_flag("--version", "chamferprep " CHAMFER_VERSION, "Print the version");
  app.footer("Exit status: 0 done, 1 internal error, 2 usage, 3 unreadable or malformed input, 4 not a "
             "convex solid,\n"
             "5 radius too large, 6 cannot write. A mesh that fails leaves nothing written.");
  try {
    app.parse(argc, argv);
    p.radius = parseRadius(radius);
    checkOutputs(options);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : exitStatus(ErrorKind::Usage);
  } catch (const Error& e) {
    std::fprintf(stderr, "chamferprep: %s\n", e.what());
    return exitStatus(e.kind());
  }
  if (!options.explicitMesh.empty() &&
      (options.meshes.size() > 1 || options.explicitMesh.extension() != ".obj")) {
    std::fputs("chamferprep: --mesh names one .obj file, for a single MESH\n", stderr);
    return exitStatus(ErrorKind::Usage);
  }
  return runPrepCommand(options);
}
