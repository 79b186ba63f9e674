#include "server/render/material/albedo_table.h"

#include "server/render/material/microfacet.h"

namespace chamfer {
namespace {

CoatAlbedo lerp(const CoatAlbedo& a, const CoatAlbedo& b, float t) {
  return {a.total + (b.total - a.total) * t, a.white + (b.white - a.white) * t};
}

/// Estimates E by visible-normal sampling: the weight of a sample is F * G2 / G1.
CoatAlbedo integrate(float mu, float roughness) {
  if (roughness == 0) return {1, schlickWeight(mu)};
  const Ggx ggx{roughness * roughness};
  const Vector3f wo{std::sqrt(std::max(0.f, 1 - mu * mu)), 0, mu};
  constexpr unsigned kSamples = 1024; // an aligned block: a (0,10,2)-net
  double total = 0, white = 0;
  for (unsigned i = 0; i < kSamples; ++i) {
    const Vector3f m = ggx.sampleVisible(wo, Sampler(0, 0, i, 0).pair(0));
    const Vector3f wi = reflect(wo, m);
    if (wi.z <= 0) continue;
    const float weight = ggx.maskingShadowing(wo, wi) / ggx.masking(wo);
    total += weight;
    white += weight * schlickWeight(dot(wo, m));
  }
  return {float(total / kSamples), float(white / kSamples)};
}

} // namespace

AlbedoTable::AlbedoTable() {
  for (int r = 0; r < kRoughnesses; ++r) {
    const float roughness = float(r) / (kRoughnesses - 1);
    for (int c = 0; c < kCosines; ++c) // the first column stands at a grazing angle where wo.z > 0
      directional_[r][c] = integrate(std::max(float(c) / (kCosines - 1), 1e-3f), roughness);
    // Exact integral of 2 mu E(mu) for the piecewise linear E that directional() returns, so that what the
    // coat leaves and what the base receives agree to rounding.
    CoatAlbedo sum;
    const double step = 1.0 / (kCosines - 1);
    for (int c = 0; c + 1 < kCosines; ++c) {
      const double wa = step * (step * c + step / 3), wb = step * (step * c + 2 * step / 3);
      const CoatAlbedo &a = directional_[r][c], &b = directional_[r][c + 1];
      sum.total += float(wa * a.total + wb * b.total);
      sum.white += float(wa * a.white + wb * b.white);
    }
    average_[r] = sum;
  }
}

const AlbedoTable& AlbedoTable::instance() {
  static const AlbedoTable table;
  return table;
}

CoatAlbedo AlbedoTable::directional(float mu, float roughness) const {
  const float x = std::clamp(mu, 0.f, 1.f) * (kCosines - 1),
              y = std::clamp(roughness, 0.f, 1.f) * (kRoughnesses - 1);
  const int c = std::min(int(x), kCosines - 2), r = std::min(int(y), kRoughnesses - 2);
  const auto &low = directional_[r], &high = directional_[r + 1];
  return lerp(lerp(low[c], low[c + 1], x - float(c)), lerp(high[c], high[c + 1], x - float(c)), y - float(r));
}

CoatAlbedo AlbedoTable::average(float roughness) const {
  const float y = std::clamp(roughness, 0.f, 1.f) * (kRoughnesses - 1);
  const int r = std::min(int(y), kRoughnesses - 2);
  return lerp(average_[r], average_[r + 1], y - float(r));
}

} // namespace chamfer
