// chamferd: serves rounded scenes over HTTP, and renders them from the command line.
#include "common/error.h"
#include "server/http/serve_command.h"
#include "server/http/version.h"
#include "server/jobs/cli/compare_options.h"
#include "server/render/cli/render_command.h"

#include <CLI/CLI.hpp>
#include <cstdio>

namespace {

using chamfer::RenderCommandOptions;
using chamfer::http::ServeCommandOptions;

/// "--key-file" is mirrored as CHAMFER_KEY_FILE; the flag wins.
void mirrorInEnvironment(CLI::App& command) {
  for (CLI::Option* option : command.get_options()) {
    std::string name =
        option->get_lnames().empty() ? option->get_single_name() : option->get_lnames().front();
    if (name == "help") continue;
    for (char& c : name)
      c = c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    option->envname("CHAMFER_" + name);
  }
}

template <class Axis>
void addUpAxis(CLI::App& command, Axis& axis, const char* about) {
  using chamfer::UpAxis;
  command
      .add_option_function<std::string>(
          "--up-axis", [&axis](const std::string& word) { axis = word == "y" ? UpAxis::Y : UpAxis::Z; },
          about)
      ->check(CLI::IsMember({"y", "z"}))
      ->type_name("y|z");
}

CLI::App* addServe(CLI::App& app, ServeCommandOptions& options) {
  CLI::App* serve =
      app.add_subcommand("serve", "Serve every scene and every rounded mesh below a folder over HTTP");
  serve
      ->add_option("root,--root", options.root,
                   "Folder with *.scene.json files and meshes with their sidecars")
      ->required();
  serve
      ->add_option("--host", options.host,
                   "Address to listen on; beyond this machine it needs --key-file or --no-auth")
      ->capture_default_str();
  serve->add_option("--port", options.port, "Port to listen on; 0: any free one, printed")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  serve->add_option("--threads", options.threads, "Threads of each render; 0: all cores")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  serve->add_option("--slots", options.slots, "Requests rendered at one time")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  serve->add_option("--waiting", options.waiting, "Requests that may wait for a slot; beyond, 503")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  serve->add_option("--connections", options.connections, "Open connections at one time")
      ->check(CLI::Range(8, 16384))
      ->capture_default_str();
  serve->add_option("--cache-megabytes", options.cacheMegabytes, "Memory for scenes prepared with a rounding")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
  serve->add_option("--scene-megabytes", options.sceneMegabytes, "Memory for all scenes together, as loaded")
      ->check(CLI::Range(1, 1 << 24))
      ->capture_default_str();
  serve->add_option("--deadline", options.deadlineSeconds, "Seconds after which a request is given up (504)")
      ->check(CLI::Range(0.1, 86400.0))
      ->capture_default_str();
  serve->add_option("--rescan", options.rescanSeconds, "Seconds between looks for changed files; 0: never")
      ->check(CLI::Range(0.0, 86400.0))
      ->capture_default_str();
  serve->add_option("--drain", options.drainSeconds, "Seconds that requests under way have after SIGTERM")
      ->check(CLI::Range(0.0, 86400.0))
      ->capture_default_str();
  serve
      ->add_option(
          "--drain-delay", options.drainDelaySeconds,
          "Seconds that it is not ready but still takes requests after SIGTERM, for balancers to see it")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  serve->add_flag("--behind-proxy", options.behindProxy,
                  "Tell clients apart by the last address of X-Forwarded-For, which a proxy sets");
  serve->add_option("--key-file", options.keyFile,
                    "File with one key a line; clients send Authorization: Bearer KEY");
  serve->add_flag("--no-auth", options.noAuth, "Listen beyond this machine without keys");
  serve->add_option("--allow-host", options.allowHosts,
                    "Name by which clients may call this server; may be repeated");
  addUpAxis(*serve, options.upAxis, "Axis that points up in the files of bare meshes: y or z; default: z");
  serve->add_option(
      "--jobs", options.jobs,
      "Folder for comparisons (POST /v1/comparisons), outside of the served one; default: none are "
      "taken");
  serve
      ->add_option("--jobs-megabytes", options.jobsMegabytes,
                   "Of that folder; beyond, the oldest finished comparisons go")
      ->check(CLI::Range(16, 1 << 24))
      ->capture_default_str();
  serve->add_option("--jobs-days", options.jobsDays, "Days after which finished comparisons go")
      ->check(CLI::Range(0.0, 36500.0))
      ->capture_default_str();
  serve->add_option("--jobs-waiting", options.jobsWaiting, "Comparisons that may wait or run; beyond, 503")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  serve->add_option("--web", options.web, "Folder of the page; default: the one built in");
  serve
      ->add_option("--log-level", options.logLevel,
                   "debug, info, warning, error or off; JSON lines on standard error")
      ->capture_default_str();
  mirrorInEnvironment(*serve);
  return serve;
}

/// "x,y,z"
template <class Triple>
void addTriple(CLI::App& command, const char* name, std::optional<Triple>& target, const char* about) {
  command
      .add_option_function<std::vector<double>>(
          name, [&target](const std::vector<double>& n) { target = Triple(n[0], n[1], n[2]); }, about)
      ->delimiter(',')
      ->expected(3)
      ->type_name("X,Y,Z");
}

CLI::App* addRender(CLI::App& app, RenderCommandOptions& options) {
  CLI::App* render = app.add_subcommand("render", "Render a scene to a file");
  render->add_option("scene,--scene", options.scene, "*.scene.json, or a mesh")->required();
  render->add_option("-o,--output", options.output, "Image to write: .png or .exr")->required();
  render->add_option("--root", options.root, "Files may be named only below it; default: the scene's folder");
  render->add_option("--width", options.width, "Pixels")->check(CLI::Range(1, 65536))->capture_default_str();
  render->add_option("--height", options.height, "Pixels")
      ->check(CLI::Range(1, 65536))
      ->capture_default_str();
  render->add_option("--samples", options.samples, "Samples of each pixel")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
  render->add_option("--seed", options.seed, "Of the sampler")->capture_default_str();
  render->add_option("--bounces", options.bounces, "Longest path")
      ->check(CLI::Range(0, 64))
      ->capture_default_str();
  render
      ->add_option(
          "--clamp", options.indirectClamp,
          "Largest value of one contribution of indirect light, against fireflies; biased: it darkens. 0: "
          "none")
      ->check(CLI::Range(0.0, 1e9))
      ->capture_default_str();
  render->add_option("--rounding", options.rounding, "analytic, none, mesh:K or bevel:N")
      ->capture_default_str();
  render
      ->add_option("--aov", options.aov,
                   "beauty, albedo, normal, geometric_normal, depth, feature or instance")
      ->capture_default_str();
  render->add_option("--radius", options.radius, "Rounding radius in mesh units; default: the sidecar's");
  render
      ->add_option("--radius-clamp", options.radiusClamp,
                   "Round each solid with at most this share of its own inradius; default: the sidecar's")
      ->check(CLI::Range(0.0, chamfer::kMostClamp));
  addUpAxis(*render, options.upAxis, "Axis that points up in the file of a bare mesh: y or z; default: z");
  addTriple(*render, "--eye", options.eye, "Camera position; default: the scene's camera");
  addTriple(*render, "--target", options.target, "Point the camera looks at");
  addTriple(*render, "--up", options.up, "Direction that is up in the picture");
  render->add_option("--vfov", options.vfovDegrees, "Vertical field of view in degrees")
      ->check(CLI::Range(0.01, 170.0));
  render->add_option("--threads", options.threads, "0: all cores")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  render->add_flag("-q,--quiet", options.quiet, "Print nothing");
  render->add_flag("--json", options.json, "Print the summary as JSON: seconds, samples, rays, memory");
  mirrorInEnvironment(*render);
  return render;
}

} // namespace

int main(int argc, char** argv) {
  CLI::App app("Renders rounded convex solids, over HTTP or to a file.", "chamferd");
  app.set_version_flag("--version", std::string("chamferd ") + chamfer::http::kVersion);
  app.require_subcommand(1);
  app.footer(
      "Every option of a command can also be set as an environment variable, as in CHAMFER_PORT or\n"
      "CHAMFER_KEY_FILE; an option on the command line wins. `chamferd COMMAND --help` lists them.\n"
      "Exit status: 0 done, 1 internal error, 2 usage, 3 unreadable or malformed input, 4 not a convex\n"
      "solid, 5 radius too large, 6 cannot write. Of compare: 0 same, 1 differs, 2 cannot tell or error.");
  ServeCommandOptions serveOptions;
  RenderCommandOptions renderOptions;
  chamfer::CompareCommandOptions compareOptions;
  const CLI::App* serve = addServe(app, serveOptions);
  const CLI::App* render = addRender(app, renderOptions);
  CLI::App* compare = addCompareCommand(app, compareOptions);
  mirrorInEnvironment(*compare);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : chamfer::exitStatus(chamfer::ErrorKind::Usage);
  }
  // Of a comparison 1 says that the sides differ, and nothing else may.
  const auto statusOf = [&](chamfer::ErrorKind kind) {
    return compare->parsed() ? chamfer::exitStatusOf(chamfer::Outcome::Error) : chamfer::exitStatus(kind);
  };
  try {
    if (serve->parsed()) return chamfer::http::runServeCommand(serveOptions);
    if (render->parsed()) return chamfer::runRenderCommand(renderOptions);
    compareOptions.version = chamfer::http::kVersion;
    compareOptions.command = chamfer::shellText({argv, argv + argc});
    return chamfer::runCompareCommand(compareOptions);
  } catch (const chamfer::Error& error) {
    std::fprintf(stderr, "chamferd: %s\n", error.what());
    return statusOf(error.kind());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "chamferd: internal error: %s\n", error.what());
    return statusOf(chamfer::ErrorKind::Internal);
  }
}
