// `chamferd render SCENE -o out.png|exr`: the renderer without HTTP. The caller parses the command line.
#pragma once

#include "server/render/path/render.h"

#include <filesystem>
#include <optional>
#include <string>

namespace chamfer {

struct RenderCommandOptions {
  std::filesystem::path scene;  ///< a `*.scene.json` or a mesh (with its sidecar beside it, if it has one)
  std::filesystem::path root;   ///< files may be named only below it; empty: the scene file's folder
  std::filesystem::path output; ///< .png or .exr
  unsigned width = 1280, height = 720;
  unsigned samples = 64; ///< per pixel
  unsigned seed = 0;
  unsigned bounces = 8;
  double indirectClamp = 0;          ///< 0: none; see RenderSettings
  std::string rounding = "analytic"; ///< parseRounding()'s words
  std::string aov = "beauty";        ///< parseAov()'s words
  std::optional<double> radius;      ///< mesh units; nothing: the sidecar's
  std::optional<double> radiusClamp; ///< share of each solid's inradius; nothing: the sidecar's
  std::optional<UpAxis> upAxis;      ///< of a bare mesh; nothing: z
  std::optional<Point3> eye, target; ///< nothing: the scene's camera
  std::optional<Vector3> up;
  std::optional<double> vfovDegrees;
  unsigned threads = 0; ///< 0: all cores
  bool quiet = false;   ///< no summary, no progress
  bool json = false;    ///< the summary as one JSON object, for programs (render_report.h)
};

/// Loads, renders, writes, and prints a summary (render_report.h) on standard output; progress on standard
/// error when that is a terminal. Returns 0. Throws Error (exitStatus() gives the exit
/// status); nothing is written then.
int runRenderCommand(const RenderCommandOptions& options);

} // namespace chamfer
