// Directional albedos of GGX lobes, tabulated: what facets scatter once in all. What they lose thereby,
// bsdf.cpp gives back as a lobe of its own, or to the diffuse base below a coat.
//
// Interpolated linearly on the grid of albedo_grid.h; within 5e-3 of the truth, and 5e-4 on average.
#pragma once

namespace chamfer {

/// E(mu) = f0 * total + (1 - f0) * white for reflectance f0 at normal incidence, white at grazing incidence
/// (Schlick's Fresnel term).
struct CoatAlbedo {
  float total = 0; ///< albedo with Fresnel 1: below 1, single scattering loses light at rough surfaces
  float white = 0; ///< albedo with Fresnel (1 - cos)^5
  float at(float f0) const { return f0 * total + (1 - f0) * white; }
};

/// Of a reflection lobe of one perceptual roughness in [0, 1].
class ReflectionAlbedo {
public:
  explicit ReflectionAlbedo(float roughness);
  CoatAlbedo directional(float mu) const; ///< of light of direction cosine `mu` in [0, 1]
  CoatAlbedo average() const;             ///< cosine-weighted mean: 2 * integral of E(mu) mu

private:
  float share_; ///< of the next row; before `row_`, which sets it
  int row_;
};

/// The tables of ReflectionAlbedo, by roughness and cosine, and by roughness (albedo_grid.h).
struct ReflectionTables {
  const float *mirrored, *white, *mirroredAverage, *whiteAverage;
};
const ReflectionTables& reflectionTables();

/// Of the reflection and transmission lobes of a dielectric boundary together, of one roughness and relative
/// index `eta` = far side over near side in [1/4, 4]. Energy, not radiance: free of squared indices.
class GlassAlbedo {
public:
  GlassAlbedo() = default; ///< smooth
  GlassAlbedo(float roughness, float eta);
  float near(float mu) const { return directional(near_, mu); } ///< of light that comes from the near side
  float far(float mu) const { return directional(far_, mu); }
  float nearAverage() const { return average(near_); } ///< as ReflectionAlbedo::average()
  float farAverage() const { return average(far_); }
  /// Mean Fresnel reflectance of the boundary, smooth, for diffuse light from its thinner side.
  float thinFresnelAverage() const;

private:
  float directional(int side, float mu) const;
  float average(int side) const;
  float rowShare_ = 0, indexShare_ = 0; ///< of the next row and index; before them, which set these
  int near_ = 0, far_ = 1;              ///< 0: the thinner side, light enters the denser; 1: the denser
  int row_ = 0, index_ = 0;
};

} // namespace chamfer
