// Scattering at one surface point. Local frame: +z is the normal on the side of wo, so wo.z > 0; wi.z > 0 is
// reflection and wi.z < 0 transmission. Directions are unit and point away from the surface. wo is where the
// path came from.
//
// Lobes, with metal + glass + base = 1:
//   reflection   GGX, Fresnel of the three parts together (Schlick for metal and coat, exact for glass)
//   diffuse      base * baseColor / pi * (1 - E(wo)) (1 - E(wi)) / (1 - mean E), E the coat's albedo: what
//                the coat does not reflect, reciprocal and conserving (Kelemen and Szirmay-Kalos, "A
//                Microfacet Based Coupled Specular-Matte BRDF Model with Importance Sampling", Eurographics
//                2001)
//   transmission GGX refraction (Walter et al. 2007), tinted by baseColor
//   multiple     what GGX facets of metal and glass lose because they let light scatter but once comes back
//                in the same diffuse form, so that no roughness loses light (Kulla and Conty, "Revisiting
//                Physically Based Shading at Imageworks", SIGGRAPH 2017 course). Metal tints it by the
//                mean colour of the second and further reflections; glass sends a share of it through.
// Below a roughness where GGX is a mirror to float32 the reflection and transmission lobes are Dirac deltas,
// and nothing is lost. Where no index changes, glass lets everything straight through.
#pragma once

#include "server/render/image/color.h"
#include "server/render/material/albedo_table.h"
#include "server/render/material/microfacet.h"

namespace chamfer {

/// GGX narrower than this is a delta: at alpha 1e-3 the density at its peak is 3e5 and its width some 0.1
/// degrees.
inline constexpr float kMirrorAlpha = 1e-3f;
/// Facets that lose less than this on average are taken to lose nothing.
inline constexpr float kLeastLoss = 1e-5f;

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
  /// `eta`: index of refraction of the far side over that of wo's side, for glass; below 1 where light leaves
  /// the denser. The coat's index is the surface's own. `wo.z` > 0.
  Bsdf(const SurfaceValues& surface, const Vector3f& wo, float eta);

  /// `diffuseLeft`: what a shading normal leaves of diffusely reflected light (terminatorFactor()); sample()
  /// knows none.
  BsdfValue evaluate(const Vector3f& wi, float diffuseLeft = 1) const;
  BsdfSample sample(float lobe, const Float2& u) const;
  /// Has it a part that evaluate() sees?
  bool hasSmoothPart() const {
    return cosine_ > 0 || (reflect_ > 0 && !mirror_) || (refract_ > 0 && !clearGlass_);
  }

private:
  /// Lobes that follow the cosine of wi, without that and without what depends on wi.
  struct CosineLobes {
    Color base, metal;
    float back = 0, through = 0; ///< of glass: reflected, transmitted (untinted)
  };
  void addBase();
  void addMetal();
  void addGlass();
  Color reflectance(float cosine) const; ///< Fresnel of all reflecting parts at a microfacet
  Color cosineReflection(float cosine) const;
  BsdfValue evaluateReflection(const Vector3f& wi, float diffuseLeft) const;
  BsdfValue evaluateTransmission(const Vector3f& wi) const;
  void addRefraction(const Vector3f& wi, BsdfValue& value) const;
  BsdfSample sampleReflection(const Vector3f& m) const;
  BsdfSample sampleMirror() const;
  BsdfSample sampleClearGlass() const;
  BsdfSample finish(const Vector3f& wi) const;

  Vector3f wo_;
  Ggx ggx_;
  Color baseColor_;
  float metal_, glass_, base_; ///< shares, sum 1
  float coatF0_;
  float eta_; ///< index on the far side over that on wo's side
  bool mirror_, clearGlass_;
  ReflectionAlbedo reflected_; ///< of metal and coat
  GlassAlbedo glassAlbedo_;
  CosineLobes lobes_;
  /// Probabilities of the lobes: the cosine on either side, GGX without and with refraction.
  float cosine_ = 0, through_ = 0, reflect_ = 0, refract_ = 0;
};

} // namespace chamfer
