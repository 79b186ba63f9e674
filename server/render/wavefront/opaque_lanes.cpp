#include "server/render/wavefront/opaque_lanes.h"

#include "server/render/material/albedo_grid.h"
#include "server/render/material/albedo_table.h"
#include "server/render/material/bsdf.h"

namespace chamfer {
namespace {

Lanes lerp(const Lanes& a, const Lanes& b, const Lanes& t) { return a + (b - a) * t; }

Lanes gather(const float* table, const int* index) {
  return Lanes([&](std::size_t i) { return table[index[i]]; });
}

/// The cells of places on an axis of `nodes`.
void cellsOf(const Lanes& place, int nodes, int* cells, Lanes& share) {
  const Lanes cell = min(floor(place), Lanes(float(nodes - 2)));
  share = place - cell;
  for (std::size_t i = 0; i < kLanes; ++i)
    cells[i] = int(cell[i]);
}

} // namespace

OpaqueBsdf::OpaqueBsdf(const OpaqueSurfaces& s, const VectorLanes& wo)
    : wo_(wo), baseColor_(s.baseColor), metal_(s.metallic), base_(Lanes(1) - metal_) {
  const Lanes roughness = s.roughness, ior = s.ior;
  ggx_.alpha = roughness * roughness;
  const Lanes r = (ior - Lanes(1)) / (ior + Lanes(1));
  coatF0_ = min(Lanes(1), Lanes(2) * Lanes(s.specular) * r * r);
  mirror_ = ggx_.alpha < kMirrorAlpha;
  anyMetal_ = any_of(metal_ > 0);
  anyBase_ = any_of(base_ > 0);
  const Lanes ofTable = select(mirror_, Lanes(0), roughness);
  cellsOf(min(max(ofTable, Lanes(0)), Lanes(1)) * Lanes(float(albedo_grid::kRoughnesses - 1)),
          albedo_grid::kRoughnesses, row_, rowShare_);
  const ReflectionTables& tables = reflectionTables();
  int next[kLanes];
  for (std::size_t i = 0; i < kLanes; ++i)
    next[i] = row_[i] + 1;
  const Albedo seen = directional(wo.z);
  const Albedo mean{
      lerp(gather(tables.mirroredAverage, row_), gather(tables.mirroredAverage, next), rowShare_),
      lerp(gather(tables.whiteAverage, row_), gather(tables.whiteAverage, next), rowShare_)};
  if (anyBase_) {
    const LaneMask coated = coatF0_ > 0;
    const Lanes coat = select(coated, seen.at(coatF0_), Lanes(0)),
                average = select(coated, mean.at(coatF0_), Lanes(0));
    const ColorLanes lobe = baseColor_ * (base_ * Lanes(kInvPi) * (Lanes(1) - coat) / (Lanes(1) - average));
    baseLobe_ = select(base_ > 0 && average < 1, lobe, {});
    where(base_ > 0, cosine_) = base_ * luminance(baseColor_) * (Lanes(1) - coat);
    where(base_ > 0, reflect_) = base_ * coat;
  }
  if (anyMetal_) {
    const LaneMask rough = metal_ > 0 && !mirror_;
    const Lanes kept = select(mirror_, Lanes(1), seen.total);
    const auto repeated = [&](const Lanes& f) {
      const Lanes average = (Lanes(20) * f + Lanes(1)) / Lanes(21);
      return average * average * mean.total / (Lanes(1) - average * (Lanes(1) - mean.total));
    };
    const ColorLanes again =
        ColorLanes{repeated(baseColor_.r), repeated(baseColor_.g), repeated(baseColor_.b)} *
        (metal_ * (Lanes(1) - kept));
    const LaneMask loses = rough && Lanes(1) - mean.total > kLeastLoss;
    metalLobe_ = select(loses, again * (Lanes(kInvPi) / (Lanes(1) - mean.total)), {});
    where(loses, cosine_) = cosine_ + luminance(again);
    where(metal_ > 0, reflect_) = reflect_ + metal_ * luminance(schlickOfMetal(wo.z)) * kept;
  }
  const Lanes sum = cosine_ + reflect_;
  where(sum > 0, cosine_) = cosine_ / sum;
  where(sum > 0, reflect_) = reflect_ / sum;
}

OpaqueBsdf::Albedo OpaqueBsdf::directional(const Lanes& mu) const {
  using namespace albedo_grid;
  const ReflectionTables& tables = reflectionTables();
  int low[kLanes], high[kLanes], lowNext[kLanes], highNext[kLanes];
  Lanes share;
  cellsOf(sqrt(min(max(mu, Lanes(0)), Lanes(1))) * Lanes(float(kCosines - 1)), kCosines, low, share);
  for (std::size_t i = 0; i < kLanes; ++i) {
    low[i] += row_[i] * kCosines;
    lowNext[i] = low[i] + 1;
    high[i] = low[i] + kCosines;
    highNext[i] = high[i] + 1;
  }
  const auto in = [&](const float* table) {
    return lerp(lerp(gather(table, low), gather(table, lowNext), share),
                lerp(gather(table, high), gather(table, highNext), share), rowShare_);
  };
  return {in(tables.mirrored), in(tables.white)};
}

ColorLanes OpaqueBsdf::schlickOfMetal(const Lanes& cosine) const {
  const Lanes weight = schlickWeight(cosine);
  const auto of = [&](const Lanes& f0) { return f0 + (Lanes(1) - f0) * weight; };
  return {of(baseColor_.r), of(baseColor_.g), of(baseColor_.b)};
}

ColorLanes OpaqueBsdf::reflectance(const Lanes& cosine) const {
  ColorLanes f;
  if (anyMetal_) f = select(metal_ > 0, f + schlickOfMetal(cosine) * metal_, f);
  if (anyBase_) {
    const Lanes coat = base_ * (coatF0_ + (Lanes(1) - coatF0_) * schlickWeight(cosine));
    f = select(base_ > 0 && coatF0_ > 0, f + ColorLanes{coat, coat, coat}, f);
  }
  return f;
}

BsdfLanes OpaqueBsdf::evaluate(const VectorLanes& wi) const {
  BsdfLanes value;
  const Albedo reflected = directional(wi.z);
  ColorLanes cosines = baseLobe_;
  if (anyBase_) {
    const LaneMask coated = base_ > 0 && (coatF0_ > 0 || metal_ > 0);
    cosines = select(coated, cosines * (Lanes(1) - reflected.at(coatF0_)), cosines);
  }
  if (anyMetal_) cosines = cosines + metalLobe_ * (Lanes(1) - reflected.total);
  const LaneMask spread = cosine_ > 0;
  value.f = select(spread, cosines * wi.z, {});
  value.pdf = select(spread, cosine_ * Lanes(kInvPi) * wi.z, Lanes(0));

  const LaneMask facets = !mirror_ && reflect_ > 0;
  if (any_of(facets)) {
    const VectorLanes m = normalize(wo_ + wi);
    const Lanes cosine = dot(wo_, m);
    const LaneMask lit = facets && cosine > 0;
    const Lanes scale = ggx_.density(m) / (Lanes(4) * wo_.z);
    const ColorLanes f = reflectance(cosine) * (scale * ggx_.maskingShadowing(wo_, wi));
    value.f = select(lit, value.f + f, value.f);
    where(lit, value.pdf) = value.pdf + reflect_ * scale * ggx_.masking(wo_);
  }
  const LaneMask above = wi.z > 0;
  return {select(above, value.f, {}), select(above, value.pdf, Lanes(0))};
}

BsdfSampleLanes OpaqueBsdf::sample(const Lanes& lobe, const Lanes& ux, const Lanes& uy) const {
  BsdfSampleLanes s;
  const LaneMask spread = lobe < cosine_, reflects = !spread && reflect_ > 0, mirrored = reflects && mirror_,
                 facets = reflects && !mirror_;
  s.wi = warpToCosineHemisphere(ux, uy);
  if (any_of(reflects)) {
    const VectorLanes m = ggx_.sampleVisible(wo_, ux, uy), r = reflect(wo_, m);
    s.wi = {select(facets, r.x, s.wi.x), select(facets, r.y, s.wi.y), select(facets, r.z, s.wi.z)};
    s.wi = {select(mirrored, -wo_.x, s.wi.x), select(mirrored, -wo_.y, s.wi.y),
            select(mirrored, wo_.z, s.wi.z)};
  }
  const BsdfLanes value = evaluate(s.wi);
  s.delta = mirrored;
  s.valid = mirrored || ((spread || (facets && s.wi.z > 0)) && value.pdf > 0);
  s.pdf = select(mirrored, Lanes(0), value.pdf);
  s.weight = value.f * (Lanes(1) / value.pdf);
  if (any_of(mirrored)) s.weight = select(mirrored, reflectance(wo_.z) * (Lanes(1) / reflect_), s.weight);
  return s;
}

} // namespace chamfer
