// Warps, tables, filter: each against its density.
#include "server/render/light/distribution.h"
#include "server/render/material/albedo_table.h"
#include "server/render/path/camera.h"
#include "server/render/path/pixel_filter.h"
#include "tests/render/direction_chi_squared.h"

#include <gtest/gtest.h>

namespace chamfer {
namespace {

using test::kSignificance;
using test::UniformNumbers;

TEST(Warp, ConesFollowTheirDensity) {
  for (const float drop : {0.3f, 1.f, 1.9f}) {
    const auto result = test::directionChiSquared(
        [&](UniformNumbers& u) { return std::optional(warpToCone(u.pair(), drop)); },
        [&](const Vector3f& d) { return 1 - d.z <= drop ? 1 / (2 * kPi * drop) : 0; }, 200000, 200, 8);
    EXPECT_GT(result.pValue, kSignificance) << drop << ": " << result.text();
  }
}

TEST(Warp, ANarrowConeKeepsItsWidth) { // half a degree across, the sun's
  const float drop = 9.5e-6f;
  UniformNumbers u(1);
  double square = 0;
  for (int i = 0; i < 10000; ++i) {
    const Vector3f d = warpToCone(u.pair(), drop);
    EXPECT_LE(d.x * d.x + d.y * d.y, 2 * drop * 1.0001f);
    square += double(d.x * d.x + d.y * d.y) / 10000;
  }
  EXPECT_NEAR(square, drop, 0.05 * drop); // uniform over a disk: half of the largest square
}

TEST(Warp, TrianglesAndDisksAreUniform) {
  std::vector<double> triangle(64), disk(64);
  UniformNumbers u(2);
  constexpr int kSamples = 100000;
  for (int i = 0; i < kSamples; ++i) {
    const Float2 b = warpToTriangle(u.pair());
    ASSERT_TRUE(b.x >= 0 && b.y >= 0 && b.x + b.y <= 1.000001f);
    // Folding the unit square on its diagonal gives the triangle: eight strips of equal area by the root of
    // the first coordinate, eight along each.
    const double s = 1 - b.x, t = s > 0 ? b.y / s : 0;
    ++triangle[std::size_t(std::min(int(s * s * 8), 7) * 8 + std::min(int(t * 8), 7))];
    const Float2 d = warpToDisk(u.pair());
    const double r2 = double(d.x) * d.x + double(d.y) * d.y;
    ASSERT_LE(r2, 1.000001);
    const double phi = (std::atan2(d.y, d.x) / std::numbers::pi + 1) / 2;
    ++disk[std::size_t(std::min(int(r2 * 8), 7) * 8 + std::min(int(phi * 8), 7))];
  }
  const std::vector<double> expected(64, kSamples / 64.0);
  EXPECT_GT(test::chiSquared(triangle, expected).pValue, kSignificance);
  EXPECT_GT(test::chiSquared(disk, expected).pValue, kSignificance);
}

TEST(Frame, IsOrthonormalAndRightHandedForAnyNormal) {
  UniformNumbers u(3);
  for (int i = 0; i < 1000; ++i) {
    Vector3f n = u.direction();
    if (i == 0) n = {0, 0, -1};
    if (i == 1) n = {0, 0, 1};
    const Frame f(n);
    EXPECT_NEAR(dot(f.x, f.y), 0, 1e-6);
    EXPECT_NEAR(dot(f.x, f.z), 0, 1e-6);
    EXPECT_NEAR(length(f.x), 1, 1e-6);
    EXPECT_NEAR(length(cross(f.x, f.y) - f.z), 0, 2e-6);
  }
}

TEST(AliasTable, DrawsInProportion) {
  const std::vector<double> weights{1, 0, 5, 0.25, 3, 0.75};
  const AliasTable table(weights);
  constexpr int kSamples = 200000;
  std::vector<double> observed(weights.size()), expected;
  UniformNumbers u(4);
  for (int i = 0; i < kSamples; ++i) {
    const AliasTable::Choice c = table.sample(u());
    ASSERT_FLOAT_EQ(c.probability, float(weights[c.index] / 10));
    ++observed[c.index];
  }
  for (const double w : weights)
    expected.push_back(w / 10 * kSamples);
  const auto result = test::chiSquared(observed, expected);
  EXPECT_GT(result.pValue, kSignificance) << result.text();
}

TEST(Distribution2D, SamplesFollowTheTableAndDensitiesAgree) {
  constexpr unsigned kWidth = 5, kHeight = 3;
  const std::vector<float> values{1, 0, 2, 4, 1, 0, 0, 0, 0, 0, 3, 3, 1, 0.5f, 2};
  const Distribution2D d(kWidth, kHeight, values);
  double sum = 0;
  for (const float v : values)
    sum += v;
  constexpr int kSamples = 100000;
  std::vector<double> observed(values.size()), expected;
  UniformNumbers u(5);
  for (int i = 0; i < kSamples; ++i) {
    const Distribution2D::Point p = d.sample(u.pair());
    const std::size_t cell = std::size_t(p.y * kHeight) * kWidth + std::size_t(p.x * kWidth);
    ++observed[cell];
    ASSERT_NEAR(p.density, values[cell] / sum * kWidth * kHeight, 1e-4);
    ASSERT_NEAR(d.density(p.x, p.y), p.density, 1e-4);
  }
  for (const float v : values)
    expected.push_back(v / sum * kSamples);
  EXPECT_GT(test::chiSquared(observed, expected).pValue, kSignificance);
  EXPECT_EQ(d.density(0.5f, 0.5f), 0) << "an empty row";
  EXPECT_FLOAT_EQ(Distribution2D(4, 4, std::vector<float>(16)).density(0.3f, 0.9f), 1) << "all zero: uniform";
}

TEST(PixelFilter, IsBlackmanHarris) {
  const auto window = [](double x) {
    const double t = std::numbers::pi * (x / PixelFilter::kRadius + 1);
    return 0.35875 - 0.48829 * std::cos(t) + 0.14128 * std::cos(2 * t) - 0.01168 * std::cos(3 * t);
  };
  constexpr int kCells = 30, kSamples = 200000;
  std::vector<double> observed(kCells), expected(kCells);
  UniformNumbers u(6);
  for (int i = 0; i < kSamples; ++i) {
    const float x = PixelFilter::instance().sample(u.pair()).y;
    ASSERT_LE(std::abs(x), PixelFilter::kRadius);
    ++observed[std::min(std::size_t((x / PixelFilter::kRadius + 1) / 2 * kCells), std::size_t(kCells - 1))];
  }
  double sum = 0;
  for (int i = 0; i < kCells; ++i)
    sum += expected[std::size_t(i)] = window(PixelFilter::kRadius * (2 * (i + 0.5) / kCells - 1));
  for (double& e : expected)
    e *= kSamples / sum;
  const auto result = test::chiSquared(observed, expected);
  EXPECT_GT(result.pValue, kSignificance) << result.text();
}

TEST(CameraRays, StartAllOverTheApertureAndMeetInFocus) {
  Camera camera;
  camera.eye = {1, 2, 3};
  camera.target = {1, 7, 3};
  camera.apertureDiameter = 0.5;
  camera.focusDistance = 4;
  const CameraRays rays(camera, 64, 48);
  constexpr int kRings = 12, kSectors = 16, kSamples = 100000;
  std::vector<double> observed(kRings * kSectors);
  UniformNumbers u(13);
  std::optional<Point3> meeting;
  for (int i = 0; i < kSamples; ++i) {
    const Ray ray = rays.ray(20.25, 11.5, u.pair());
    const Vector3 d = ray.origin - camera.eye;
    ASSERT_NEAR(d.y, 0, 1e-12) << "on the lens";
    const double share = (d.x * d.x + d.z * d.z) / (0.25 * 0.25); // of the area within
    ASSERT_LE(share, 1 + 1e-6);
    const double turn = std::atan2(d.z, d.x) / (2 * std::numbers::pi) + 0.5;
    ++observed[std::min(std::size_t(share * kRings), std::size_t(kRings - 1)) * kSectors +
               std::min(std::size_t(turn * kSectors), std::size_t(kSectors - 1))];
    const Point3 inFocus = ray.at((6 - ray.origin.y) / ray.direction.y);
    if (!meeting) meeting = inFocus;
    ASSERT_LT(length(inFocus - *meeting), 1e-6) << "all meet on the focal plane";
  }
  const std::vector<double> expected(observed.size(), double(kSamples) / double(observed.size()));
  const auto result = test::chiSquared(observed, expected);
  EXPECT_GT(result.pValue, kSignificance) << result.text();
}

/// Cosine-weighted mean of `e` by the midpoint rule.
template <class F>
double cosineMean(F&& e) {
  double mean = 0;
  for (int i = 0; i < 10000; ++i) {
    const float mu = (float(i) + 0.5f) / 10000;
    EXPECT_TRUE(e(mu) > 0 && e(mu) <= 1);
    mean += 2.0 * double(mu * e(mu)) / 10000;
  }
  return mean;
}

TEST(AlbedoTable, LimitsAndMeans) {
  EXPECT_NEAR(ReflectionAlbedo(0).directional(1).at(0.04f), 0.04, 1e-6)
      << "a mirror seen head-on reflects f0";
  EXPECT_NEAR(ReflectionAlbedo(0.1f).directional(0.5f).at(1), 1, 1e-3)
      << "smooth metals lose next to nothing";
  for (const float roughness : {0.f, 0.33f, 0.7f, 1.f}) {
    const ReflectionAlbedo coat(roughness);
    EXPECT_NEAR(coat.average().at(0.04f),
                cosineMean([&](float mu) { return coat.directional(mu).at(0.04f); }), 1e-5)
        << roughness;
    for (const float eta : {1.01f, 1.5f, 1 / 1.5f, 4.f, 0.25f}) {
      const GlassAlbedo glass(roughness, eta), back(roughness, 1 / eta);
      EXPECT_NEAR(glass.nearAverage(), cosineMean([&](float mu) { return glass.near(mu); }), 1e-5) << eta;
      EXPECT_NEAR(glass.farAverage(), cosineMean([&](float mu) { return glass.far(mu); }), 1e-5) << eta;
      EXPECT_NEAR(back.near(0.4f), glass.far(0.4f), 1e-5) << "the same surface, seen from behind";
    }
  }
  EXPECT_NEAR(GlassAlbedo(0.5f, 1.5f).thinFresnelAverage(), 0.0918, 5e-4); // in closed form 0.09178
}

} // namespace
} // namespace chamfer
