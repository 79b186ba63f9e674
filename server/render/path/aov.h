// Arbitrary output variables: what the first hit is, instead of the light that comes from it.
#pragma once

#include "server/render/surface/surface.h"

namespace chamfer {

/// Value and coverage of one sample. Misses are black with coverage 0, so a pixel's mean is premultiplied:
/// divide by alpha for the mean over what was hit.
struct AovSample {
  Color value;
  float coverage = 0;
};

/// Albedo: the base colour. Normal: the one shading uses, world, outward, -1..1; geometric normal: the
/// surface's own. Depth: distance from the ray's origin in world units, in all three channels. Feature: flat
/// (0.25, 0.25, 0.25), cylinder (1, 0.5, 0), sphere (0, 0.5, 1). Instance: a colour of its own for each, so
/// that a pixel's mean tells the instances' shares.
AovSample aovSample(const Surfaces& surfaces, const Tracer& tracer, Aov aov, const Ray& ray,
                    const PathState& from, const Sampler& sampler, RayStatistics& statistics);

} // namespace chamfer
