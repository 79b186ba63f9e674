#include "server/render/material/bsdf.h"

#include "server/render/material/albedo_table.h"

namespace chamfer {
namespace {

/// GGX narrower than this is a delta: at alpha 1e-3 the density at its peak is 3e5 and its width some 0.1
/// degrees.
constexpr float kMirrorAlpha = 1e-3f;

float coatReflectance(const SurfaceValues& s) {
  const float r = (s.ior - 1) / (s.ior + 1);
  return std::min(1.f, 2 * s.specular * r * r);
}

} // namespace

Bsdf::Bsdf(const SurfaceValues& s, const Vector3f& wo, float eta)
    : wo_(wo), ggx_{s.roughness * s.roughness}, baseColor_(s.baseColor), metal_(s.metallic),
      glass_((1 - s.metallic) * s.transmission), base_((1 - s.metallic) * (1 - s.transmission)),
      coatF0_(coatReflectance(s)), roughness_(s.roughness), eta_(eta), mirror_(ggx_.alpha < kMirrorAlpha),
      clearGlass_(mirror_ || eta == 1) {
  float coat = 0; // E(wo)
  if (base_ > 0) {
    float average = 0;
    if (coatF0_ > 0) {
      if (mirror_) roughness_ = 0;
      coat = AlbedoTable::instance().directional(wo.z, roughness_).at(coatF0_);
      average = AlbedoTable::instance().average(roughness_).at(coatF0_);
    }
    coatLeft_ = average < 1 ? (1 - coat) / (1 - average) : 0;
  }
  const float diffuse = base_ * luminance(baseColor_) * (1 - coat);
  const float reflection = metal_ * luminance(schlick(baseColor_, wo.z)) + base_ * coat;
  const float sum = diffuse + reflection + glass_;
  if (!(sum > 0)) return;
  diffuse_ = diffuse / sum;
  reflect_ = reflection / sum;
  refract_ = glass_ / sum;
}

Color Bsdf::reflectance(float cosine) const {
  Color f = grey(0);
  if (metal_ > 0) f += metal_ * schlick(baseColor_, cosine);
  if (base_ > 0 && coatF0_ > 0) f += grey(base_ * schlick(coatF0_, cosine));
  if (glass_ > 0) f += grey(glass_ * fresnelDielectric(cosine, eta_));
  return f;
}

BsdfValue Bsdf::evaluate(const Vector3f& wi, float diffuseLeft) const {
  if (wi.z > 0) return evaluateReflection(wi, diffuseLeft);
  if (wi.z < 0 && glass_ > 0 && !clearGlass_) return evaluateTransmission(wi);
  return {};
}

BsdfValue Bsdf::evaluateReflection(const Vector3f& wi, float diffuseLeft) const {
  BsdfValue value;
  if (diffuse_ > 0) {
    const float left =
        coatF0_ > 0 ? 1 - AlbedoTable::instance().directional(wi.z, roughness_).at(coatF0_) : 1;
    value.f = baseColor_ * (base_ * kInvPi * wi.z * coatLeft_ * left * diffuseLeft);
    value.pdf = diffuse_ * kInvPi * wi.z;
  }
  if (mirror_ || !(reflect_ > 0 || refract_ > 0)) return value;
  const Vector3f m = normalize(wo_ + wi);
  const float cosine = dot(wo_, m);
  if (!(cosine > 0)) return value;
  const float density = ggx_.density(m);
  // f |wi.z| = D G2 F / (4 wo.z); pdf of the half vector's reflection: G1 D / (4 wo.z).
  const float probability = reflect_ + (refract_ > 0 ? refract_ * fresnelDielectric(cosine, eta_) : 0);
  const float scale = density / (4 * wo_.z);
  value.f += reflectance(cosine) * (scale * ggx_.maskingShadowing(wo_, wi));
  value.pdf += probability * scale * ggx_.masking(wo_);
  return value;
}

BsdfValue Bsdf::evaluateTransmission(const Vector3f& wi) const {
  Vector3f m = wo_ + wi * eta_;
  if (lengthSquared(m) == 0) return {};
  m = normalize(m);
  if (m.z < 0) m = -m;
  const float cosO = dot(wo_, m), cosI = dot(wi, m);
  if (!(cosO > 0 && cosI < 0)) return {};
  const float fresnel = fresnelDielectric(cosO, eta_);
  const float denominator = cosI + cosO / eta_;
  const float jacobian = -cosI / (denominator * denominator); // d(m) / d(wi)
  const float density = ggx_.density(m);
  BsdfValue value;
  // Radiance is compressed by the squared index: the path carries radiance, hence 1 / eta^2.
  value.f = baseColor_ * (glass_ * (1 - fresnel) * density * ggx_.maskingShadowing(wo_, wi) * cosO *
                          jacobian / (wo_.z * eta_ * eta_));
  value.pdf = refract_ * (1 - fresnel) * ggx_.masking(wo_) * cosO * density * jacobian / wo_.z;
  return value;
}

BsdfSample Bsdf::sample(float lobe, const Float2& u) const {
  if (lobe < diffuse_) return finish(warpToCosineHemisphere(u));
  lobe -= diffuse_;
  if (lobe < reflect_ || refract_ == 0) {
    if (reflect_ == 0) return {};
    if (mirror_) return sampleMirror();
    return sampleReflection(ggx_.sampleVisible(wo_, u));
  }
  const float choice = std::min((lobe - reflect_) / refract_, 0x1.fffffep-1f);
  const Vector3f m = clearGlass_ ? Vector3f(0, 0, 1) : ggx_.sampleVisible(wo_, u);
  const float fresnel = fresnelDielectric(std::max(0.f, dot(wo_, m)), eta_);
  if (choice < fresnel) {
    if (mirror_) return sampleMirror();
    if (!clearGlass_) return sampleReflection(m);
    return {}; // an index of 1 reflects nothing
  }
  if (clearGlass_) return sampleClearGlass();
  Vector3f wi;
  if (!refract(wo_, m, eta_, wi) || wi.z >= 0) return {};
  BsdfSample s = finish(wi);
  s.etaSquared = eta_ * eta_;
  return s;
}

BsdfSample Bsdf::sampleReflection(const Vector3f& m) const {
  const Vector3f wi = reflect(wo_, m);
  if (!(wi.z > 0)) return {}; // into the surface, by way of a second facet: what single scattering loses
  return finish(wi);
}

/// The mirror direction, which both the reflecting parts and smooth glass choose: their weights add up.
BsdfSample Bsdf::sampleMirror() const {
  const float glassShare = refract_ * fresnelDielectric(wo_.z, eta_);
  BsdfSample s;
  s.wi = {-wo_.x, -wo_.y, wo_.z};
  s.weight = reflectance(wo_.z) * (1 / (reflect_ + glassShare));
  s.delta = s.valid = true;
  return s;
}

BsdfSample Bsdf::sampleClearGlass() const {
  BsdfSample s;
  if (!refract(wo_, {0, 0, 1}, eta_, s.wi) || s.wi.z >= 0) return {};
  s.etaSquared = eta_ * eta_;
  s.weight = baseColor_ * (glass_ / (refract_ * s.etaSquared)); // (1 - F) is in weight and probability alike
  s.delta = s.valid = true;
  return s;
}

BsdfSample Bsdf::finish(const Vector3f& wi) const {
  const BsdfValue value = evaluate(wi);
  if (!(value.pdf > 0)) return {};
  BsdfSample s;
  s.wi = wi;
  s.pdf = value.pdf;
  s.weight = value.f * (1 / value.pdf);
  s.valid = true;
  return s;
}

} // namespace chamfer
