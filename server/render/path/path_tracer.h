// The light that arrives along one camera ray: a path with next-event estimation at every vertex, both
// techniques weighed by multiple importance sampling (Veach and Guibas, "Optimally Combining Sampling
// Techniques", SIGGRAPH 1995), ended by Russian roulette. Unbiased but for the limit on bounces, and
// for the clamp of indirect light where one is asked for.
//
// radiance() follows one path to its end and is what to read first. Its steps are there to be called one by
// one, too: the wavefront (render/wavefront) takes them for many paths at once.
#pragma once

#include "server/render/light/lights.h"
#include "server/render/path/media.h"
#include "server/render/path/render.h"
#include "server/render/surface/surface.h"

namespace chamfer {

/// Dimension pairs of the sampler that a path starts with.
inline constexpr std::uint32_t kPixelPair = 0, kLensPair = 1, kFirstPathPair = 2;
/// What a bounce's pairs are for; the first of bounce b is kFirstPathPair + b * kPairsPerBounce.
inline constexpr std::uint32_t kPairsPerBounce = 4;
enum PathPair : std::uint32_t { kChoicePair, kLightPair, kScatterPair, kRoulettePair };

/// A path on its way.
struct Path {
  Path(const Ray& camera, const Sampler& itsSampler) : ray(camera), sampler(itsSampler) {}

  Ray ray;
  double start = 0; ///< beyond 0 where the ray has gone through surfaces that are none
  Sampler sampler;
  Color sum, throughput = grey(1);
  float scatterPdf = 0; ///< with which the last direction was drawn; 0: delta or camera
  float etaScale = 1;   ///< undoes the compression of radiance in glass, for Russian roulette only
  unsigned bounce = 0;
  unsigned spread = 0; ///< scatterings so far that were no deltas
  unsigned nothings = 0;

  std::uint32_t firstPair() const { return kFirstPathPair + bounce * kPairsPerBounce; }
};

class PathTracer {
public:
  /// All must outlive the path tracer. `maxBounces`: scattering events; 0 shows lights only. `indirectClamp`:
  /// as in RenderSettings; indirect is light that was spread twice, by anything but mirrors and clear glass.
  PathTracer(const Surfaces& surfaces, const Tracer& tracer, const Lights& lights, unsigned maxBounces,
             float indirectClamp = 0)
      : surfaces_(surfaces), tracer_(tracer), lights_(lights), media_(surfaces, tracer),
        maxBounces_(maxBounces), indirectClamp_(indirectClamp > 0 ? indirectClamp : INFINITY) {}
  /// `from`: of the point that the ray starts at (a camera).
  Color radiance(const Ray& ray, const PathState& from, const Sampler& sampler,
                 RayStatistics& statistics) const;

  /// The ray meets nothing: adds the light from there. The path ends.
  void escape(Path& path) const;
  enum class Met { End, Nothing, Surface };
  /// Adds what the surface emits. After Met::Nothing the path goes on as it is.
  Met meet(Path& path, const Crossing& crossing, RayCount& count) const;
  /// Adds the light that comes to the surface directly and goes on into a new direction; false: the path
  /// ends.
  bool scatter(Path& path, const Crossing& crossing, const PathState& state, RayStatistics& statistics) const;
  /// Goes on after path.ray has been scattered, by roulette; false: the path ends.
  bool goOn(Path& path, const Color& weight, float pdf, bool delta, float etaSquared) const;
  /// Bounded by the clamp.
  Color limited(const Color& light, bool indirect) const {
    const float most = maxComponent(light);
    return indirect && most > indirectClamp_ ? light * (indirectClamp_ / most) : light;
  }

  const Surfaces& surfaces() const { return surfaces_; }
  const Tracer& tracer() const { return tracer_; }
  const Lights& lights() const { return lights_; }
  const Media& media() const { return media_; }

private:
  class Vertex;
  /// Does the light come to the vertex? `through` is multiplied by what media leave of it.
  bool reaches(const Vertex& vertex, const LightSample& light, RayCount& count, Color& through) const;
  bool reachesThrough(const Ray& ray, const PathState& from, const LightSample& light, Color& through,
                      Feature& blocker) const;
  Color directLight(const Vertex& vertex, const Float2& choice, const Float2& u,
                    RayStatistics& statistics) const;

  const Surfaces& surfaces_;
  const Tracer& tracer_;
  const Lights& lights_;
  Media media_;
  unsigned maxBounces_;
  float indirectClamp_;
};

} // namespace chamfer
