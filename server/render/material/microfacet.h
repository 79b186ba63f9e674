// The isotropic GGX (Trowbridge-Reitz) microfacet distribution with Smith's height-correlated masking, and
// Fresnel reflectances. Directions are unit, in the local frame with the macroscopic normal +z; wo.z > 0.
//   Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007.
//   Heitz, "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs", JCGT 3(2), 2014.
//   Dupuy and Benyoub, "Sampling Visible GGX Normals with Spherical Caps", HPG 2023.
#pragma once

#include "server/render/image/color.h"
#include "server/render/path/warp.h"

namespace chamfer {

/// GGX of width alpha > 0.
struct Ggx {
  float alpha;

  /// Density of normals, per solid angle of m and projected area: integral of D(m) m.z over the hemisphere
  /// is 1.
  float density(const Vector3f& m) const {
    const float a2 = alpha * alpha;
    // 1 - m.z^2 (1 - a2), with the part that cancels near the pole taken from x and y.
    const float k = (m.x * m.x + m.y * m.y) + a2 * m.z * m.z;
    return a2 / (kPi * k * k);
  }
  /// Smith's Lambda of a direction at any side.
  float lambda(const Vector3f& w) const {
    const float cos2 = w.z * w.z;
    const float tan2 = (w.x * w.x + w.y * w.y) / cos2;
    return std::isinf(tan2) ? INFINITY : (std::sqrt(1 + alpha * alpha * tan2) - 1) / 2;
  }
  float masking(const Vector3f& w) const { return 1 / (1 + lambda(w)); }
  float maskingShadowing(const Vector3f& wo, const Vector3f& wi) const {
    return 1 / (1 + lambda(wo) + lambda(wi));
  }
  /// Density, per solid angle of m, of sampleVisible().
  float visibleDensity(const Vector3f& wo, const Vector3f& m) const {
    return masking(wo) * std::max(0.f, dot(wo, m)) * density(m) / wo.z;
  }
  /// A normal from the distribution of those visible from wo.
  Vector3f sampleVisible(const Vector3f& wo, const Float2& u) const {
    const Vector3f v = normalize(Vector3f(wo.x * alpha, wo.y * alpha, wo.z));
    float across, along; // of the angle about the cap's axis
    sineCosine(2 * kPi * u.x, across, along);
    const float z = (1 - u.y) * (1 + v.z) - v.z;
    const float sine = std::sqrt(std::clamp(1 - z * z, 0.f, 1.f));
    const Vector3f cap{sine * along + v.x, sine * across + v.y, z + v.z};
    return normalize(Vector3f(cap.x * alpha, cap.y * alpha, std::max(0.f, cap.z)));
  }
};

/// (1 - cosine)^5, the weight of white in Schlick's approximation.
inline float schlickWeight(float cosine) {
  const float c = std::clamp(1 - cosine, 0.f, 1.f), c2 = c * c;
  return c2 * c2 * c;
}
inline float schlick(float f0, float cosine) { return f0 + (1 - f0) * schlickWeight(cosine); }
inline Color schlick(const Color& f0, float cosine) { return f0 + (grey(1) - f0) * schlickWeight(cosine); }

/// Unpolarised reflectance of a dielectric boundary; `cosine` >= 0 is the incident side's, `eta` the index of
/// the far side over that of the near side. 1 under total internal reflection, 0 where no index changes.
inline float fresnelDielectric(float cosine, float eta) {
  if (eta == 1) return 0;
  const float sin2t = (1 - cosine * cosine) / (eta * eta);
  if (sin2t >= 1) return 1;
  const float cosT = std::sqrt(1 - sin2t);
  const float parallel = (eta * cosine - cosT) / (eta * cosine + cosT);
  const float perpendicular = (cosine - eta * cosT) / (cosine + eta * cosT);
  return (parallel * parallel + perpendicular * perpendicular) / 2;
}

/// Mirror image of w about m.
inline Vector3f reflect(const Vector3f& w, const Vector3f& m) { return m * (2 * dot(w, m)) - w; }

/// Direction into which w (on m's side: dot(w, m) > 0) refracts, `eta` as above; false under total
/// reflection.
inline bool refract(const Vector3f& w, const Vector3f& m, float eta, Vector3f& out) {
  const float cosine = dot(w, m);
  const float sin2t = std::max(0.f, 1 - cosine * cosine) / (eta * eta);
  if (sin2t >= 1) return false;
  out = m * (cosine / eta - std::sqrt(1 - sin2t)) - w / eta;
  return true;
}

} // namespace chamfer
