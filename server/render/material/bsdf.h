// Scattering at one surface point. Local frame: +z is the normal on the side of wo, so wo.z > 0; wi.z > 0 is
// reflection and wi.z < 0 transmission. Directions are unit and point away from the surface. wo is where the
// path came from.
//
// Lobes, with metal + glass + base = 1:
//   reflection   GGX, Fresnel of the three parts together (Schlick for metal and coat, exact for glass)
//   diffuse      base * baseColor / pi * (1 - E(wo)) (1 - E(wi)) / (1 - mean E), E the coat's albedo: what
//   the coat does
//                not reflect, reciprocal and conserving (Kelemen and Szirmay-Kalos, "A Microfacet Based
//                Coupled Specular-Matte BRDF Model with Importance Sampling", Eurographics 2001)
//   transmission GGX refraction (Walter et al. 2007), tinted by baseColor
// Below a roughness where GGX is a mirror to float32 the reflection and transmission lobes are Dirac deltas.
#pragma once

#include "server/render/image/color.h"
#include "server/render/material/microfacet.h"

namespace chamfer {

/// A material's values at a point, textures looked up.
struct SurfaceValues {
  Color baseColor;
  float roughness, metallic, specular, transmission, ior;
};

struct BsdfValue {
  Color f;       ///< f(wo, wi) |wi.z|, delta lobes left out
  float pdf = 0; ///< of sample(), per solid angle of wi, delta lobes left out
};

struct BsdfSample {
  Vector3f wi;
  Color weight;  ///< f |wi.z| / pdf
  float pdf = 0; ///< per solid angle; 0 for a delta
  bool delta = false;
  bool valid = false;   ///< false: the sample carries nothing, the path ends
  float etaSquared = 1; ///< squared relative index crossed; 1 without transmission
};

class Bsdf {
public:
  /// `eta`: index of refraction of the far side over that of wo's side; 1: light goes straight on. `wo.z` >
  /// 0.
  Bsdf(const SurfaceValues& surface, const Vector3f& wo, float eta);

  /// `diffuseLeft`: what a shading normal leaves of the diffuse part (terminatorFactor()); sample() knows
  /// none.
  BsdfValue evaluate(const Vector3f& wi, float diffuseLeft = 1) const;
  BsdfSample sample(float lobe, const Float2& u) const;
  /// Has it a part that evaluate() sees?
  bool hasSmoothPart() const { return !mirror_ || diffuse_ > 0 || (glass_ > 0 && !clearGlass_); }

private:
  Color reflectance(float cosine) const; ///< Fresnel of all reflecting parts at a microfacet
  BsdfValue evaluateReflection(const Vector3f& wi, float diffuseLeft) const;
  BsdfValue evaluateTransmission(const Vector3f& wi) const;
  BsdfSample sampleReflection(const Vector3f& m) const;
  BsdfSample sampleMirror() const;
  BsdfSample sampleClearGlass() const;
  BsdfSample finish(const Vector3f& wi) const;

  Vector3f wo_;
  Ggx ggx_;
  Color baseColor_;
  float metal_, glass_, base_; ///< shares, sum 1
  float coatF0_, roughness_;
  float eta_;          ///< index on the far side over that on wo's side
  float coatLeft_ = 0; ///< (1 - E(wo)) / (1 - mean E)
  float diffuse_ = 0;  ///< probability of the diffuse lobe; those of the others:
  float reflect_ = 0, refract_ = 0;
  bool mirror_, clearGlass_;
};

} // namespace chamfer
