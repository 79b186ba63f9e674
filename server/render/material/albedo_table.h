// Directional albedo of a GGX reflection lobe under Schlick's Fresnel term, tabulated: what a specular coat
// reflects in all, hence what it leaves to the diffuse base below it.
#pragma once

#include <array>

namespace chamfer {

/// E(mu) = f0 * total + (1 - f0) * white for reflectance f0 at normal incidence, white at grazing incidence.
struct CoatAlbedo {
  float total = 0; ///< albedo with Fresnel 1: below 1, single scattering loses light at rough surfaces
  float white = 0; ///< albedo with Fresnel (1 - cos)^5
  float at(float f0) const { return f0 * total + (1 - f0) * white; }
};

class AlbedoTable {
public:
  /// The one table; made at first use, the same on every machine of one binary.
  static const AlbedoTable& instance();
  /// Of direction cosine `mu` in [0, 1] and perceptual roughness in [0, 1]; interpolated linearly.
  CoatAlbedo directional(float mu, float roughness) const;
  /// Cosine-weighted mean of directional() over the hemisphere: 2 * integral of E(mu) mu.
  CoatAlbedo average(float roughness) const;

private:
  AlbedoTable();
  static constexpr int kCosines = 32, kRoughnesses = 32;
  std::array<std::array<CoatAlbedo, kCosines>, kRoughnesses> directional_;
  std::array<CoatAlbedo, kRoughnesses> average_;
};

} // namespace chamfer
