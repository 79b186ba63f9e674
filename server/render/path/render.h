// Rendering of tiles: a pure function of scene, settings and tile. Same input, same bits, with any number of
// threads.
#pragma once

#include "server/render/scene/scene.h"

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace chamfer {

enum class RoundingMode : std::uint8_t { None, Analytic, Mesh, Bevel };
enum class Aov : std::uint8_t { Beauty, Albedo, Normal, GeometricNormal, Depth, Feature, Instance };

/// Which rounding a request asks for.
struct RoundingChoice {
  RoundingMode mode = RoundingMode::Analytic;
  unsigned count = 0;           ///< segments of mesh:K, probes of bevel:N
  std::optional<double> radius; ///< mesh units (SceneMesh::radiusUnit); nothing: the scene's
  /// No solid gets more than this share of its own inradius; 0: none; nothing: as the scene's were made.
  std::optional<double> radiusClamp = std::nullopt;
  bool operator==(const RoundingChoice&) const = default;
};

struct RenderSettings {
  unsigned width = 0, height = 0;          ///< of the whole frame
  unsigned firstSample = 0, endSample = 1; ///< samples s0 .. s1-1 of every pixel
  unsigned seed = 0;
  unsigned maxBounces = 8;
  /// Largest component that any one contribution of indirect light may have; 0: unlimited. Takes fireflies
  /// (bright light found by a rare path) at the price of a bias: the image gets darker, by what was cut off.
  float indirectClamp = 0;
  Aov aov = Aov::Beauty;
  std::optional<Camera> camera; ///< nothing: the scene's
};

struct TileRect {
  unsigned x = 0, y = 0, width = 0, height = 0; ///< pixels, y down from the top
  bool operator==(const TileRect&) const = default;
};

/// Rays of one kind: how many were traced, of these how many met a surface, of these how many met it on a
/// rounding (a cylinder or a sphere).
struct RayCount {
  std::uint64_t traced = 0, hits = 0, rounded = 0;
  RayCount& operator+=(const RayCount& o);
  bool operator==(const RayCount&) const = default;
  /// The paper's "affected rays": the part of the traced rays whose hit is on a rounding, 0..1.
  double roundedShare() const { return traced ? double(rounded) / double(traced) : 0; }
};

struct RayStatistics {
  RayCount camera, bounce;
  RayCount shadow; ///< a hit: the light is hidden, by whatever the search for a blocker found first
  std::uint64_t nonFiniteSamples = 0; ///< replaced by black, counted
  RayStatistics& operator+=(const RayStatistics& o);
  bool operator==(const RayStatistics&) const = default;
  std::uint64_t rays() const { return camera.traced + bounce.traced + shadow.traced; }
  std::uint64_t hits() const { return camera.hits + bounce.hits; } ///< surfaces seen
  std::uint64_t roundedHits() const { return camera.rounded + bounce.rounded; }
};

/// Scene plus one rounding choice, ready to trace. Immutable, shared; may be costly to make (another radius).
class PreparedScene;
/// Memory for the explicit meshes of one prepared scene.
struct MeshBudget {
  std::uint64_t bytes = UINT64_MAX;
  /// Told how many of them will be taken, before they are; may throw to refuse it.
  std::function<void(std::uint64_t bytes)> reserve{};
};
/// Throws Error(RadiusTooLarge) naming the largest radius that works, Error(OutOfRange). `cancelled` is asked
/// often, from any thread; true: Error(Cancelled).
std::shared_ptr<const PreparedScene> prepare(std::shared_ptr<const Scene> scene, const RoundingChoice& choice,
                                             unsigned threads = 0,
                                             const std::function<bool()>& cancelled = {},
                                             const MeshBudget& budget = {});
/// The tracer over the scene's own instances only (no studio ground): what POST .../rays asks.
const Tracer& ownTracer(const PreparedScene& prepared);
const Scene& sceneOf(const PreparedScene& prepared);
std::size_t memoryBytes(const PreparedScene& prepared);
/// Triangles that rays are tested against, over all instances (a mesh that is placed twice counts twice).
std::size_t tracedTriangles(const PreparedScene& prepared);

struct RenderControl {
  unsigned threads = 0;                       ///< 0: all cores
  std::function<bool()> cancelled;            ///< asked often; true: stop and throw Error(Cancelled)
  std::function<void(double share)> progress; ///< 0..1, from any thread
};

struct Image {
  unsigned width = 0, height = 0;
  std::vector<float> rgba; ///< [height][width][4], linear, top row first; alpha: coverage
};

struct RenderResult {
  Image image; ///< mean of the samples
  RayStatistics statistics;
};

/// How often renderTile() asks `cancelled` in all: before every some hundred samples, the first.
std::uint64_t looksOfRender(const RenderSettings& settings, const TileRect& tile);
RenderResult renderTile(const PreparedScene& prepared, const RenderSettings& settings, const TileRect& tile,
                        const RenderControl& control = {});

} // namespace chamfer
