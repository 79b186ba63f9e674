// The isotropic GGX (Trowbridge-Reitz) microfacet distribution with Smith's height-correlated masking, and
// Fresnel reflectances. Directions are unit, in the local frame with the macroscopic normal +z; wo.z > 0.
//   Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007.
//   Heitz, "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs", JCGT 3(2), 2014.
//   Dupuy and Benyoub, "Sampling Visible GGX Normals with Spherical Caps", HPG 2023.
#pragma once

#include "server/render/image/color.h"
#include "server/render/path/warp.h"

namespace chamfer {

/// GGX of width alpha > 0; F: float, or lanes of floats.
template <class F>
struct GgxT {
  using Direction = Vector3T<F>;
  F alpha;

  /// Density of normals, per solid angle of m and projected area: integral of D(m) m.z over the hemisphere
  /// is 1.
  F density(const Direction& m) const {
    const F a2 = alpha * alpha;
    // 1 - m.z^2 (1 - a2), with the part that cancels near the pole taken from x and y.
    const F k = (m.x * m.x + m.y * m.y) + a2 * m.z * m.z;
    return a2 / (F(kPi) * k * k);
  }
  /// Smith's Lambda of a direction at any side.
  F lambda(const Direction& w) const {
    using std::isinf, std::sqrt;
    const F cos2 = w.z * w.z;
    const F tan2 = (w.x * w.x + w.y * w.y) / cos2;
    return select(isinf(tan2), F(INFINITY), (sqrt(F(1) + alpha * alpha * tan2) - F(1)) / F(2));
  }
  F masking(const Direction& w) const { return F(1) / (F(1) + lambda(w)); }
  F maskingShadowing(const Direction& wo, const Direction& wi) const {
    return F(1) / (F(1) + lambda(wo) + lambda(wi));
  }
  /// Density, per solid angle of m, of sampleVisible().
  F visibleDensity(const Direction& wo, const Direction& m) const {
    using std::max;
    return masking(wo) * max(F(0), dot(wo, m)) * density(m) / wo.z;
  }
  /// A normal from the distribution of those visible from wo.
  Direction sampleVisible(const Direction& wo, const F& ux, const F& uy) const {
    using std::max, std::min, std::sqrt;
    const Direction v = normalize(Direction(wo.x * alpha, wo.y * alpha, wo.z));
    F across, along; // of the angle about the cap's axis
    sineCosine(F(2 * kPi) * ux, across, along);
    const F z = (F(1) - uy) * (F(1) + v.z) - v.z;
    const F sine = sqrt(min(max(F(1) - z * z, F(0)), F(1)));
    const Direction cap{sine * along + v.x, sine * across + v.y, z + v.z};
    return normalize(Direction(cap.x * alpha, cap.y * alpha, max(F(0), cap.z)));
  }
  Direction sampleVisible(const Direction& wo, const Float2& u) const { return sampleVisible(wo, u.x, u.y); }
};
using Ggx = GgxT<float>;

/// (1 - cosine)^5, the weight of white in Schlick's approximation.
template <class F>
F schlickWeight(const F& cosine) {
  using std::max, std::min;
  const F c = min(max(F(1) - cosine, F(0)), F(1)), c2 = c * c;
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
template <class F>
Vector3T<F> reflect(const Vector3T<F>& w, const Vector3T<F>& m) {
  return m * (F(2) * dot(w, m)) - w;
}

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
