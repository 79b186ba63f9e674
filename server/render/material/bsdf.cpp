#include "server/render/material/bsdf.h"

namespace chamfer {
namespace {

float coatReflectance(const SurfaceValues& s) {
  const float r = (s.ior - 1) / (s.ior + 1);
  return std::min(1.f, 2 * s.specular * r * r);
}

/// Colour of light that metal's facets reflect twice or more: the geometric series of mean reflectances, each
/// followed by what leaves the surface (`mean`) and what meets another facet (1 - mean).
Color repeatedReflectance(const Color& f0, float mean) {
  const auto channel = [mean](float f) {
    const float average = (20 * f + 1) / 21; // cosine-weighted mean of Schlick's term
    return average * average * mean / (1 - average * (1 - mean));
  };
  return {channel(f0.r), channel(f0.g), channel(f0.b)};
}

} // namespace

Bsdf::Bsdf(const SurfaceValues& s, const Vector3f& wo, float eta)
    : wo_(wo), ggx_{s.roughness * s.roughness}, baseColor_(s.baseColor), metal_(s.metallic),
      glass_((1 - s.metallic) * s.transmission), base_((1 - s.metallic) * (1 - s.transmission)),
      coatF0_(coatReflectance(s)), eta_(eta), mirror_(ggx_.alpha < kMirrorAlpha),
      clearGlass_(mirror_ || eta == 1), reflected_(mirror_ ? 0 : s.roughness) {
  if (base_ > 0) addBase();
  if (metal_ > 0) addMetal();
  if (glass_ > 0) {
    if (!clearGlass_) glassAlbedo_ = GlassAlbedo(s.roughness, eta);
    addGlass();
  }
  const float sum = cosine_ + through_ + reflect_ + refract_;
  if (!(sum > 0)) return;
  cosine_ /= sum;
  through_ /= sum;
  reflect_ /= sum;
  refract_ /= sum;
}

void Bsdf::addBase() {
  float coat = 0, average = 0; // E(wo) and its mean
  if (coatF0_ > 0) {
    coat = reflected_.directional(wo_.z).at(coatF0_);
    average = reflected_.average().at(coatF0_);
  }
  if (average < 1) lobes_.base = baseColor_ * (base_ * kInvPi * (1 - coat) / (1 - average));
  cosine_ += base_ * luminance(baseColor_) * (1 - coat);
  reflect_ += base_ * coat;
}

void Bsdf::addMetal() {
  float kept = 1;
  if (!mirror_) {
    const float mean = reflected_.average().total;
    kept = reflected_.directional(wo_.z).total;
    const Color again = repeatedReflectance(baseColor_, mean) * (metal_ * (1 - kept));
    if (1 - mean > kLeastLoss) {
      lobes_.metal = again * (kInvPi / (1 - mean));
      cosine_ += luminance(again);
    }
  }
  reflect_ += metal_ * luminance(schlick(baseColor_, wo_.z)) * kept;
}

/// f = (1 - E(wo)) (1 - E(wi)) / (pi (1 - mean E)) of glass splits in two. Through the surface
///   energy(wo, wi) = c (1 - near E(wo)) (1 - far E(wi)) / pi
/// is reciprocal if c is eta^2 times that of the other side. The largest c that lets neither side send
/// through more than it has is min(1 / (1 - mean far E), eta^2 / (1 - mean near E)). Of that much goes
/// through as of diffuse light at a smooth boundary, seen from its thinner side.
void Bsdf::addGlass() {
  float kept = 1;
  if (!clearGlass_) {
    const float nearLoss = 1 - glassAlbedo_.nearAverage(), farLoss = 1 - glassAlbedo_.farAverage();
    kept = glassAlbedo_.near(wo_.z);
    if (std::min(nearLoss, farLoss) > kLeastLoss) {
      const float c = (1 - glassAlbedo_.thinFresnelAverage()) * std::min(1 / farLoss, eta_ * eta_ / nearLoss);
      const float lost = glass_ * (1 - kept), through = std::min(c * farLoss, 1.f);
      lobes_.through = lost * c * kInvPi / (eta_ * eta_); // radiance, which a denser side compresses
      lobes_.back = lost * (1 - through) * kInvPi / nearLoss;
      through_ += lost * through * luminance(baseColor_);
      cosine_ += lost * (1 - through);
    }
  }
  refract_ += glass_ * kept;
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

Color Bsdf::cosineReflection(float cosine) const {
  Color f = lobes_.base;
  if (coatF0_ > 0 || metal_ > 0) {
    const CoatAlbedo reflected = reflected_.directional(cosine);
    if (base_ > 0) f *= 1 - reflected.at(coatF0_);
    f += lobes_.metal * (1 - reflected.total);
  }
  if (lobes_.back > 0) f += grey(lobes_.back * (1 - glassAlbedo_.near(cosine)));
  return f;
}

BsdfValue Bsdf::evaluateReflection(const Vector3f& wi, float diffuseLeft) const {
  BsdfValue value;
  if (cosine_ > 0) {
    value.f = cosineReflection(wi.z) * (wi.z * diffuseLeft);
    value.pdf = cosine_ * kInvPi * wi.z;
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
  BsdfValue value;
  if (through_ > 0) {
    value.f = baseColor_ * (lobes_.through * (1 - glassAlbedo_.far(-wi.z)) * -wi.z);
    value.pdf = through_ * kInvPi * -wi.z;
  }
  addRefraction(wi, value);
  return value;
}

void Bsdf::addRefraction(const Vector3f& wi, BsdfValue& value) const {
  Vector3f m = wo_ + wi * eta_;
  if (lengthSquared(m) == 0) return;
  m = normalize(m);
  if (m.z < 0) m = -m;
  const float cosO = dot(wo_, m), cosI = dot(wi, m);
  if (!(cosO > 0 && cosI < 0)) return;
  const float fresnel = fresnelDielectric(cosO, eta_);
  const float denominator = cosI + cosO / eta_;
  const float jacobian = -cosI / (denominator * denominator); // d(m) / d(wi)
  const float density = ggx_.density(m);
  // Radiance is compressed by the squared index: the path carries radiance, hence 1 / eta^2.
  value.f += baseColor_ * (glass_ * (1 - fresnel) * density * ggx_.maskingShadowing(wo_, wi) * cosO *
                           jacobian / (wo_.z * eta_ * eta_));
  value.pdf += refract_ * (1 - fresnel) * ggx_.masking(wo_) * cosO * density * jacobian / wo_.z;
}

BsdfSample Bsdf::sample(float lobe, const Float2& u) const {
  if (lobe < cosine_) return finish(warpToCosineHemisphere(u));
  lobe -= cosine_;
  if (lobe < through_) {
    const Vector3f wi = warpToCosineHemisphere(u);
    return finish({wi.x, wi.y, -wi.z});
  }
  lobe -= through_;
  if (lobe < reflect_ || refract_ == 0) {
    if (reflect_ == 0) return {};
    if (mirror_) return sampleMirror();
    return sampleReflection(ggx_.sampleVisible(wo_, u));
  }
  const float choice = std::min((lobe - reflect_) / refract_, 0x1.fffffep-1f);
  const Vector3f m = clearGlass_ ? Vector3f(0, 0, 1) : ggx_.sampleVisible(wo_, u);
  const float fresnel = fresnelDielectric(std::max(0.f, dot(wo_, m)), eta_);
  if (choice < fresnel) return mirror_ ? sampleMirror() : sampleReflection(m);
  if (clearGlass_) return sampleClearGlass();
  Vector3f wi;
  if (!refract(wo_, m, eta_, wi) || wi.z >= 0) return {};
  return finish(wi);
}

BsdfSample Bsdf::sampleReflection(const Vector3f& m) const {
  const Vector3f wi = reflect(wo_, m);
  if (!(wi.z > 0)) return {}; // into the surface: of what it loses, the multiple lobes give back
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
  if (eta_ == 1)
    s.wi = -wo_;
  else if (!refract(wo_, {0, 0, 1}, eta_, s.wi) || s.wi.z >= 0)
    return {};
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
  if (wi.z < 0) s.etaSquared = eta_ * eta_;
  return s;
}

} // namespace chamfer
