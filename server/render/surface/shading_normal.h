// Shading normals: what they may do to light. The surface's own (geometric) normal decides on which side a
// direction lies; a shading normal n turns the frame in which the BSDF scatters, and nothing else. Unit
// vectors throughout; "up" is the geometric normal on the side of wo.
#pragma once

#include "common/vec.h"

#include <algorithm>

namespace chamfer {

/// Bends `n` as little as is needed for the mirror image of `wo` about it to leave on the side of `up`, where
/// it is not there by a cosine of min(0.01, 0.9 wo.up) already: wo then lies above the shading hemisphere
/// too. wo.up > 0.
///   Keller et al., "The Iray Light Transport Simulation and Rendering System", 2017, on shading normals: the
///   mirror direction is moved along n until it clears the surface, and the half vector taken.
inline Vector3 bendNormal(const Vector3& wo, Vector3 n, const Vector3& up) {
  constexpr double kLeastCosine = 0.01;
  if (const double slope = dot(n, up); !(slope > kLeastCosine)) { // beyond the horizon: back to it first
    n = n + up * (kLeastCosine - slope);
    if (!(lengthSquared(n) > 0)) return up;
    n = normalize(n);
  }
  const Vector3 mirrored = n * (2 * dot(n, wo)) - wo;
  const double cosine = dot(mirrored, up), least = std::min(kLeastCosine, 0.9 * dot(wo, up));
  if (cosine >= least) return n;
  return normalize(wo + normalize(mirrored + n * ((least - cosine) / dot(n, up))));
}

/// What is left of diffusely reflected light from `wi` at a surface whose shading normal `n` was turned away
/// from its smooth normal `smooth`, 0..1: without it the light ends in a hard line where the surface itself
/// turns away from it.
///   Chiang, Li and Burley, "Taming the Shadow Terminator", SIGGRAPH 2019 Talks.
inline double terminatorFactor(const Vector3& smooth, const Vector3& n, const Vector3& wi) {
  const double surface = dot(smooth, wi), shading = dot(n, wi) * dot(n, smooth);
  if (!(surface > 0 && shading > 0)) return surface > 0 ? 1 : 0;
  const double g = std::min(1.0, surface / shading);
  return g * (1 + g * (1 - g));
}

} // namespace chamfer
