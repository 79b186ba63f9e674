#include "server/render/material/bsdf.h"

#include "tests/render/direction_chi_squared.h"

#include <gtest/gtest.h>
#include <ostream>

namespace chamfer {

struct BsdfCase {
  const char* name;
  SurfaceValues surface; ///< base colour, roughness, metallic, specular, transmission, ior
  bool inside;
};
static void PrintTo(const BsdfCase& c, std::ostream* out) { *out << c.name << (c.inside ? " inside" : ""); }
/// Index of the far side over that of the near side.
static float etaOf(const BsdfCase& c) { return c.inside ? 1 / c.surface.ior : c.surface.ior; }

namespace {

using test::UniformNumbers;

const BsdfCase kCases[] = {
    {"diffuse", {{0.8f, 0.5f, 0.2f}, 0.5f, 0, 0, 0, 1.5f}, false},
    {"white diffuse", {{1, 1, 1}, 0.5f, 0, 0, 0, 1.5f}, false},
    {"plastic", {{0.7f, 0.1f, 0.1f}, 0.25f, 0, 0.5f, 0, 1.5f}, false},
    {"rough white plastic", {{1, 1, 1}, 0.9f, 0, 1, 0, 1.8f}, false},
    {"smooth plastic", {{0.6f, 0.6f, 0.9f}, 0, 0, 0.5f, 0, 1.5f}, false},
    {"metal", {{0.9f, 0.7f, 0.3f}, 0.3f, 1, 0.5f, 0, 1.5f}, false},
    {"white rough metal", {{1, 1, 1}, 1, 1, 0.5f, 0, 1.5f}, false},
    {"half metal", {{0.9f, 0.7f, 0.3f}, 0.5f, 0.5f, 0.5f, 0, 1.5f}, false},
    {"rough glass", {{1, 1, 1}, 0.6f, 0, 0.5f, 1, 1.5f}, false},
    {"rough glass", {{1, 1, 1}, 0.6f, 0, 0.5f, 1, 1.5f}, true},
    {"very rough tinted glass", {{0.4f, 0.9f, 0.6f}, 0.9f, 0, 0.5f, 1, 1.33f}, true},
    {"clear glass", {{1, 1, 1}, 0, 0, 0.5f, 1, 1.5f}, false},
    {"clear glass", {{1, 1, 1}, 0, 0, 0.5f, 1, 1.5f}, true},
    {"everything", {{0.8f, 0.6f, 0.4f}, 0.5f, 0.3f, 0.7f, 0.4f, 1.45f}, false},
    {"everything", {{0.8f, 0.6f, 0.4f}, 0.5f, 0.3f, 0.7f, 0.4f, 1.45f}, true},
    {"everything smooth", {{0.8f, 0.6f, 0.4f}, 0, 0.3f, 0.7f, 0.4f, 1.45f}, false},
    {"glass about 1", {{0.9f, 0.9f, 1}, 1, 0, 0.5f, 1, 1.05f}, false},
    {"glass about 1", {{0.9f, 0.9f, 1}, 1, 0, 0.5f, 1, 1.05f}, true},
    {"dense rough glass", {{1, 1, 1}, 0.8f, 0, 0.5f, 1, 3}, false},
    {"dense rough glass", {{1, 1, 1}, 0.8f, 0, 0.5f, 1, 3}, true},
    {"densest glass", {{1, 1, 1}, 1, 0, 0.5f, 1, 4}, true},
    {"metal and glass", {{0.9f, 0.7f, 0.3f}, 0.9f, 0.5f, 0.5f, 1, 1.5f}, false},
    {"metal and glass", {{0.9f, 0.7f, 0.3f}, 0.9f, 0.5f, 0.5f, 1, 1.5f}, true},
    {"index 1", {{0.8f, 0.6f, 0.4f}, 0.5f, 0, 0.5f, 0.5f, 1}, false},
    {"all index 1", {{0.8f, 0.6f, 0.4f}, 0.5f, 0, 0.5f, 1, 1}, true},
};

Vector3f fromAngle(double degrees) {
  const double a = degrees * std::numbers::pi / 180;
  return {float(std::sin(a) * 0.6), float(std::sin(a) * 0.8), float(std::cos(a))};
}

class BsdfTest : public testing::TestWithParam<BsdfCase> {};

TEST_P(BsdfTest, SamplesFollowTheDensity) {
  const BsdfCase& c = GetParam();
  for (const double angle : {10.0, 50.0, 80.0}) {
    const Bsdf bsdf(c.surface, fromAngle(angle), etaOf(c));
    // Deltas and lost samples share the cell of what has no density.
    const auto result = test::directionChiSquared(
        [&](UniformNumbers& u) -> std::optional<Vector3f> {
          const float lobe = u();
          const BsdfSample s = bsdf.sample(lobe, u.pair());
          if (!s.valid || s.delta) return {};
          return s.wi;
        },
        [&](const Vector3f& wi) { return bsdf.evaluate(wi).pdf; }, 100000, 40, 20,
        std::abs(etaOf(c) - 1) < 0.1f ? 96 : 24); // glass about 1 hardly bends light: a narrow lobe
    if (!bsdf.hasSmoothPart()) continue;          // nothing but deltas: the next test has them
    EXPECT_GT(result.pValue, test::kSignificance) << angle << " degrees: " << result.text();
  }
}

TEST_P(BsdfTest, WeightsAreValueOverDensity) {
  const BsdfCase& c = GetParam();
  const Bsdf bsdf(c.surface, fromAngle(40), etaOf(c));
  UniformNumbers u(1);
  for (int i = 0; i < 2000; ++i) {
    const float lobe = u();
    const BsdfSample s = bsdf.sample(lobe, u.pair());
    if (!s.valid) continue;
    EXPECT_NEAR(length(s.wi), 1, 1e-5);
    EXPECT_TRUE(isFinite(s.weight));
    EXPECT_EQ(s.delta, s.pdf == 0);
    EXPECT_EQ(s.etaSquared != 1, s.wi.z < 0 && c.surface.ior != 1);
    if (s.delta) continue;
    const BsdfValue v = bsdf.evaluate(s.wi);
    EXPECT_NEAR(s.weight.g * s.pdf, v.f.g, 1e-4f * v.f.g);
  }
}

TEST_P(BsdfTest, IsReciprocal) {
  const BsdfCase& c = GetParam();
  UniformNumbers u(2);
  int compared = 0;
  for (int i = 0; i < 4000; ++i) {
    Vector3f wo = u.direction();
    wo.z = std::abs(wo.z);
    const Vector3f wi = u.direction();
    if (wo.z < 0.02f || std::abs(wi.z) < 0.02f) continue;
    const Bsdf forward(c.surface, wo, etaOf(c));
    // Seen from the other side, wi is where the path comes from: its frame's z is on wi's side.
    const float flip = wi.z > 0 ? 1.f : -1.f;
    const Bsdf backward(c.surface, {wi.x, wi.y, wi.z * flip}, wi.z > 0 ? etaOf(c) : 1 / etaOf(c));
    const float a = forward.evaluate(wi).f.g / std::abs(wi.z);
    float b = backward.evaluate({wo.x, wo.y, wo.z * flip}).f.g / wo.z;
    // Radiance over squared index is what is conserved across a boundary.
    if (wi.z < 0) b /= etaOf(c) * etaOf(c);
    EXPECT_NEAR(a, b, 2e-3f * std::max(a, b) + 1e-6f) << "wo.z " << wo.z << " wi.z " << wi.z;
    compared += a > 0;
  }
  const Bsdf any(c.surface, fromAngle(40), etaOf(c));
  EXPECT_TRUE(compared > 500 || !any.hasSmoothPart());
}

/// What comes back of light that is 1 from everywhere, and its standard error; in units of squared index, so
/// that radiance squeezed into glass does not count as gained.
std::pair<double, double> whiteFurnace(const Bsdf& bsdf, int samples) {
  double sum = 0, squares = 0;
  UniformNumbers u(3);
  for (int i = 0; i < samples; ++i) {
    const float lobe = u();
    const BsdfSample s = bsdf.sample(lobe, u.pair());
    const double w = s.valid ? double(s.weight.r) * s.etaSquared : 0;
    sum += w;
    squares += w * w;
  }
  const double mean = sum / samples;
  return {mean, std::sqrt(std::max(0.0, squares / samples - mean * mean) / samples)};
}

TEST_P(BsdfTest, WhiteLosesNothingAndMakesNothing) {
  const BsdfCase& c = GetParam();
  SurfaceValues white = c.surface;
  white.baseColor = {1, 1, 1};
  for (const double angle : {0.0, 30.0, 60.0, 80.0, 89.0}) {
    const auto [mean, error] = whiteFurnace(Bsdf(white, fromAngle(angle), etaOf(c)), 200000);
    EXPECT_NEAR(mean, 1, 4 * error + 5e-3) << angle << " degrees"; // 5e-3: the albedo tables' interpolation
  }
}

INSTANTIATE_TEST_SUITE_P(Materials, BsdfTest, testing::ValuesIn(kCases));

TEST(Bsdf, NoRoughnessAndNoIndexLosesLight) { // from all sides: mean over cosine-weighted wo
  UniformNumbers u(5);
  const auto check = [&](float roughness, float metallic, float eta) {
    const SurfaceValues white{{1, 1, 1}, roughness, metallic, 0.5f, 1 - metallic, 1.5f};
    constexpr int kSamples = 200000;
    double sum = 0, squares = 0;
    for (int i = 0; i < kSamples; ++i) {
      Vector3f wo = warpToCosineHemisphere(u.pair());
      wo.z = std::max(wo.z, 1e-6f);
      const float lobe = u();
      const BsdfSample s = Bsdf(white, wo, eta).sample(lobe, u.pair());
      const double w = s.valid ? double(s.weight.g * s.etaSquared) : 0;
      sum += w;
      squares += w * w;
    }
    const double mean = sum / kSamples;
    const double error = std::sqrt(std::max(0.0, squares / kSamples - mean * mean) / kSamples);
    // The inside of a solid is met a dozen times where its index is high: one per mille here is one percent
    // there.
    EXPECT_NEAR(mean, 1, 4.5 * error + 1e-3) << "roughness " << roughness << ", index " << eta;
    EXPECT_LT(error, 3e-3);
  };
  for (int r = 0; r <= 10; ++r) {
    const float roughness = float(r) / 10;
    check(roughness, 1, 1.5f);
    for (const float ior : {1.001f, 1.05f, 1.2f, 1.5f, 1.8f, 2.4f, 3.f, 4.f})
      for (const float eta : {ior, 1 / ior})
        check(roughness, 0, eta);
  }
}

TEST(Bsdf, RepeatedReflectionSaturatesMetal) {
  const auto albedo = [](float roughness) {
    Color sum;
    UniformNumbers u(9);
    const Bsdf gold({{0.95f, 0.7f, 0.3f}, roughness, 1, 0.5f, 0, 1.5f}, fromAngle(30), 1.5f);
    for (int i = 0; i < 200000; ++i) {
      const float lobe = u();
      if (const BsdfSample s = gold.sample(lobe, u.pair()); s.valid) sum += s.weight * 5e-6f;
    }
    return sum;
  };
  const Color smooth = albedo(0.1f), rough = albedo(1);
  EXPECT_NEAR(smooth.b, 0.3, 0.01);
  EXPECT_GT(rough.r, 0.85);
  EXPECT_LT(rough.r, 0.95);
  EXPECT_LT(rough.g, smooth.g);
  EXPECT_LT(rough.b / rough.r, smooth.b / smooth.r) << "each reflection takes its share of blue";
  EXPECT_GT(rough.b, 0.13) << "what scatters once alone is 0.125";
}

TEST(Bsdf, MatchedIndicesLetEverythingStraightThrough) {
  for (const float roughness : {0.f, 0.4f, 1.f})
    for (const double angle : {0.0, 60.0, 89.99}) {
      const Vector3f wo = fromAngle(angle);
      const Bsdf bsdf({{1, 1, 1}, roughness, 0, 0.5f, 1, 1.5f}, wo, 1);
      EXPECT_FALSE(bsdf.hasSmoothPart());
      for (const float lobe : {0.f, 0.5f, 0.999f}) {
        const BsdfSample s = bsdf.sample(lobe, {0.3f, 0.6f});
        ASSERT_TRUE(s.valid && s.delta);
        EXPECT_EQ(s.wi, -wo);
        EXPECT_FLOAT_EQ(s.weight.g, 1);
      }
    }
}

TEST(Bsdf, AWhiteBaseUnderAnyCoatReflectsEverything) {
  for (const float roughness : {0.f, 0.2f, 0.5f, 1.f})
    for (const double angle : {0.0, 45.0, 75.0}) {
      const Bsdf bsdf({{1, 1, 1}, roughness, 0, 0.5f, 0, 1.5f}, fromAngle(angle), 1.5f);
      const auto [mean, error] = whiteFurnace(bsdf, 200000);
      EXPECT_NEAR(mean, 1, 4 * error + 4e-3) << "roughness " << roughness << ", " << angle << " degrees";
    }
}

TEST(Bsdf, ClearGlassFollowsSnellAndFresnel) {
  const SurfaceValues glass{{1, 1, 1}, 0, 0, 0.5f, 1, 1.5f};
  const Bsdf outside(glass, fromAngle(30), 1.5f);
  const BsdfSample transmitted = outside.sample(0.999f, {0.3f, 0.3f});
  ASSERT_TRUE(transmitted.delta);
  ASSERT_LT(transmitted.wi.z, 0);
  EXPECT_NEAR(std::hypot(transmitted.wi.x, transmitted.wi.y), 0.5 / 1.5, 1e-6);
  EXPECT_NEAR(transmitted.weight.r, 1 / 2.25, 1e-5);
  EXPECT_NEAR(fresnelDielectric(1, 1.5f), 0.04, 1e-6);
  // Beyond the critical angle, asin(1/1.5) = 41.8 degrees, glass is a perfect mirror from inside.
  const Bsdf inside(glass, fromAngle(45), 1 / 1.5f);
  for (const float lobe : {0.01f, 0.5f, 0.99f}) {
    const BsdfSample s = inside.sample(lobe, {0.3f, 0.3f});
    EXPECT_GT(s.wi.z, 0);
    EXPECT_NEAR(s.weight.r, 1, 1e-6);
  }
}

} // namespace
} // namespace chamfer
