// Run when the program is built: writes the tables of albedo_table.h as C++ arrays. Made there, they cost no
// time at start, and every machine that a binary runs on has the same bits whatever its C library computes.
#include "server/render/material/albedo_grid.h"
#include "server/render/material/microfacet.h"

#include <array>
#include <cstdio>
#include <vector>

namespace {

using namespace chamfer;
using namespace chamfer::albedo_grid;

/// What GGX facets scatter once, of light of direction cosine mu. By visible-normal sampling the weight of a
/// sample is F * G2 / G1.
struct Scattered {
  double mirrored = 0; ///< with Fresnel 1
  double white = 0;    ///< with Fresnel (1 - cos)^5
  double glass = 0;    ///< reflected and refracted together, with the Fresnel term of index `eta`
};

Scattered scatter(float mu, float roughness, float eta) {
  const Ggx ggx{roughness * roughness};
  const Vector3f wo{std::sqrt(std::max(0.f, 1 - mu * mu)), 0, mu};
  const float visible = ggx.masking(wo);
  constexpr int kPoints = 987, kGenerator = 610; // a Fibonacci lattice
  Scattered sum;
  for (int i = 0; i < kPoints; ++i) {
    const Float2 u{float(i * kGenerator % kPoints) / kPoints, (float(i) + 0.5f) / kPoints};
    const Vector3f m = ggx.sampleVisible(wo, u);
    const float cosine = dot(wo, m), fresnel = fresnelDielectric(std::max(0.f, cosine), eta);
    if (const Vector3f wi = reflect(wo, m); wi.z > 0) {
      const double weight = ggx.maskingShadowing(wo, wi) / visible;
      sum.mirrored += weight / kPoints;
      sum.white += weight * schlickWeight(cosine) / kPoints;
      sum.glass += weight * fresnel / kPoints;
    }
    if (Vector3f wi; refract(wo, m, eta, wi) && wi.z < 0)
      sum.glass += double(ggx.maskingShadowing(wo, wi) / visible * (1 - fresnel)) / kPoints;
  }
  return sum;
}

using Column = std::array<float, kCosines>;

/// 2 * integral of mu E(mu), exact for the E that is linear in sqrt(mu) between nodes, which is what is
/// looked up: so what one direction loses and what all directions lose agree to rounding.
float average(const Column& e) {
  double sum = 0;
  for (int c = 0; c + 1 < kCosines; ++c) { // t = sqrt(mu): 4 t^3 E(t) dt
    const double a = c, b = c + 1, a4 = a * a * a * a, b4 = b * b * b * b;
    const double all = b4 - a4, first = 0.8 * (b4 * b - a4 * a); // integrals of 4 t^3 and 4 t^4
    sum += e[std::size_t(c)] * (b * all - first) + e[std::size_t(c) + 1] * (first - a * all);
  }
  return float(sum / std::pow(double(kCosines - 1), 4));
}

/// Cosine-weighted mean of the Fresnel reflectance.
float averageFresnel(float eta) {
  constexpr int kSteps = 1000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const float mu = (float(i) + 0.5f) / kSteps;
    sum += 2.0 * double(mu * fresnelDielectric(mu, eta)) / kSteps;
  }
  return float(sum);
}

void print(const char* name, const std::vector<float>& values) {
  std::printf("constexpr float %s[%zu] = {", name, values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    std::printf("%s%.9ef,", i % 8 == 0 ? "\n" : "", double(values[i]));
  std::printf("};\n");
}

} // namespace

int main() {
  std::vector<float> mirrored, white, mirroredAverage, whiteAverage, glass, glassAverage, fresnelAverage;
  for (int r = 0; r < kRoughnesses; ++r) {
    Column all, grazing;
    for (int c = 0; c < kCosines; ++c) {
      const float mu = cosineOf(c);
      const Scattered s = r == 0 ? Scattered{1, schlickWeight(mu), 1} : scatter(mu, roughnessOf(r), 1);
      mirrored.push_back(all[std::size_t(c)] = std::min(float(s.mirrored), 1.f));
      white.push_back(grazing[std::size_t(c)] = float(s.white));
    }
    mirroredAverage.push_back(average(all));
    whiteAverage.push_back(average(grazing));
  }
  for (const bool dense : {false, true})
    for (int i = 0; i < kIndices; ++i)
      for (int r = 0; r < kRoughnesses; ++r) {
        const float eta = dense ? 1 / indexOf(i) : indexOf(i);
        Column all;
        for (int c = 0; c < kCosines; ++c) {
          const float e = r == 0 ? 1 : float(scatter(cosineOf(c), roughnessOf(r), eta).glass);
          glass.push_back(all[std::size_t(c)] = std::min(e, 1.f));
        }
        glassAverage.push_back(average(all));
      }
  for (int i = 0; i < kIndices; ++i)
    fresnelAverage.push_back(averageFresnel(indexOf(i)));
  print("kMirrored", mirrored);
  print("kWhite", white);
  print("kMirroredAverage", mirroredAverage);
  print("kWhiteAverage", whiteAverage);
  print("kGlass", glass);
  print("kGlassAverage", glassAverage);
  print("kFresnelAverage", fresnelAverage);
  return std::fflush(stdout) == 0 && !std::ferror(stdout) ? 0 : 1;
}
