// The light that arrives along one camera ray: a path with next-event estimation at every vertex, both
// techniques weighed by multiple importance sampling (Veach and Guibas, "Optimally Combining Sampling
// Techniques", SIGGRAPH 1995), ended by Russian roulette. Unbiased but for the limit on bounces, and
// for the clamp of indirect light where one is asked for.
#pragma once

#include "server/render/light/lights.h"
#include "server/render/path/media.h"
#include "server/render/path/render.h"
#include "server/render/surface/surface.h"

namespace chamfer {

/// Dimension pairs of the sampler that a path starts with.
inline constexpr std::uint32_t kPixelPair = 0, kLensPair = 1, kFirstPathPair = 2;

class PathTracer {
public:
  /// All must outlive the path tracer. `maxBounces`: scattering events; 0 shows lights only. `indirectClamp`:
  /// as in RenderSettings; indirect is light that was spread twice, by anything but mirrors and clear glass.
  PathTracer(const Surfaces& surfaces, const Tracer& tracer, const Lights& lights, unsigned maxBounces,
             float indirectClamp = 0)
      : surfaces_(surfaces), tracer_(tracer), lights_(lights), media_(surfaces, tracer),
        maxBounces_(maxBounces), indirectClamp_(indirectClamp > 0 ? indirectClamp : INFINITY) {}
  /// `from`: of the point that the ray starts at (a camera).
  Color radiance(Ray ray, const PathState& from, const Sampler& sampler, RayStatistics& statistics) const;

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
