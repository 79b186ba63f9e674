// The judge itself: right samplers pass, slightly wrong ones are rejected.
#include "tests/render/direction_chi_squared.h"

#include <gtest/gtest.h>

namespace chamfer::test {
namespace {

TEST(ChiSquared, TailMatchesKnownQuantiles) {
  EXPECT_NEAR(chiSquaredTail(3.841459, 1), 0.05, 1e-6);
  EXPECT_NEAR(chiSquaredTail(18.307038, 10), 0.05, 1e-6);
  EXPECT_NEAR(chiSquaredTail(149.449, 100), 0.001, 1e-5);
}

TEST(ChiSquared, RejectsACosineSamplerAgainstAUniformDensity) {
  const auto cosine = [](UniformNumbers& u) { return std::optional(warpToCosineHemisphere(u.pair())); };
  EXPECT_GT(directionChiSquared(cosine, [](const Vector3f& d) { return std::max(0.f, d.z) * kInvPi; }).pValue,
            kSignificance);
  EXPECT_LT(directionChiSquared(cosine, [](const Vector3f& d) { return d.z > 0 ? kInvPi / 2 : 0; }).pValue,
            kSignificance);
}

TEST(ChiSquared, RejectsADensityThatIsTwoPercentOffOverAQuarterOfTheHemisphere) {
  const auto cosine = [](UniformNumbers& u) { return std::optional(warpToCosineHemisphere(u.pair())); };
  const auto wrong = [](const Vector3f& d) {
    const float factor = d.x > 0 ? (d.y > 0 ? 1.03f : 0.97f) : 1.f;
    return std::max(0.f, d.z) * kInvPi * factor;
  };
  EXPECT_LT(directionChiSquared(cosine, wrong).pValue, kSignificance);
}

TEST(ChiSquared, RejectsSamplesWhereTheDensityIsZero) {
  const auto both = [](UniformNumbers& u) { return std::optional(u.direction()); };
  EXPECT_LT(directionChiSquared(both, [](const Vector3f& d) { return d.z > 0 ? kInvPi / 2 : 0; }).pValue,
            kSignificance);
}

} // namespace
} // namespace chamfer::test
