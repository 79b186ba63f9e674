// Environments and lights: samples against densities, and what they add up to against closed forms.
#include "server/render/light/lights.h"
#include "server/render/light/spherical_triangle.h"
#include "tests/render/direction_chi_squared.h"

#include <gtest/gtest.h>

namespace chamfer {
namespace {

using test::UniformNumbers;

std::shared_ptr<const Texture> smallImage() {
  std::vector<Color> pixels;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 16; ++x)
      pixels.push_back(x == 3 && y == 2 ? Color{40, 40, 40} : Color{0.1f * float(x), 0.5f, 0.1f * float(y)});
  return std::make_shared<Texture>(16, 8, std::move(pixels));
}

std::vector<std::pair<const char*, Environment>> environments() {
  return {{"constant", Environment::constant({1, 1, 1})},
          {"sky", Environment::sky({{0.2f, 0.4f, 1}, {1, 1, 1}, {0.1f, 0.1f, 0.1f}}, {0, 0, 1})},
          {"tilted sky", Environment::sky({{0.2f, 0.4f, 1}, {1, 1, 1}, {0, 0, 0}}, {1, 2, 0.5})},
          {"image", Environment::image(smallImage(), 2, 30, {0, 0, 1})},
          {"tilted image", Environment::image(smallImage(), 2, -75, {0, 1, 0})}};
}

TEST(Environment, SamplesFollowTheDensity) {
  for (const auto& [name, environment] : environments()) {
    const Environment& e = environment;
    const auto result = test::directionChiSquared(
        [&](UniformNumbers& u) -> std::optional<Vector3f> {
          const Environment::Sample s = e.sample(u.pair());
          if (!(s.pdf > 0)) return {};
          EXPECT_NEAR(length(s.direction), 1, 1e-5);
          return s.direction;
        },
        [&](const Vector3f& d) { return e.pdf(d); }, 100000, 24, 32, 32);
    EXPECT_GT(result.pValue, test::kSignificance) << name << ": " << result.text();
  }
}

TEST(Environment, MeanLuminanceIsTheMeanOverTheSphere) {
  for (const auto& [name, environment] : environments()) {
    double sum = 0;
    UniformNumbers u(1);
    constexpr int kSamples = 400000;
    for (int i = 0; i < kSamples; ++i)
      sum += luminance(environment.radiance(u.direction()));
    EXPECT_NEAR(environment.meanLuminance(), sum / kSamples, 0.015 * sum / kSamples) << name;
  }
}

TEST(Environment,
     ImagesLieAsDocumented) { // row 0 is up, the centre column faces x, columns run counter-clockwise
  std::vector<Color> pixels(8 * 4, grey(0));
  pixels[0 * 8 + 5] = grey(1);
  pixels[2 * 8 + 4] = {1, 0, 0}; // just counter-clockwise of x, just below the horizon
  const auto e = Environment::image(std::make_shared<Texture>(8, 4, pixels), 1, 0, {0, 0, 1});
  const auto towards = [](double azimuth, double height) {
    const double a = azimuth * std::numbers::pi / 180, h = height * std::numbers::pi / 180;
    return Vector3f(float(std::cos(a) * std::cos(h)), float(std::sin(a) * std::cos(h)), float(std::sin(h)));
  };
  EXPECT_NEAR(e.radiance(towards(22.5, -22.5)).r, 1, 1e-4);
  EXPECT_NEAR(e.radiance(towards(22.5, -22.5)).g, 0, 1e-4);
  EXPECT_NEAR(e.radiance(towards(67.5, 67.5)).g, 1, 1e-4);
  const auto turned = Environment::image(std::make_shared<Texture>(8, 4, pixels), 1, 90, {0, 0, 1});
  EXPECT_NEAR(turned.radiance(towards(112.5, -22.5)).r, 1, 1e-4);
}

Bounds3 unitBounds() {
  Bounds3 b;
  b.extend(Point3(-1, -1, -1));
  b.extend(Point3(1, 1, 1));
  return b;
}

/// Irradiance at the origin on a surface that faces z, by light sampling alone; and its standard error.
std::pair<double, double> irradiance(const Lights& lights, int samples = 200000) {
  double sum = 0, squares = 0;
  UniformNumbers u(2);
  for (int i = 0; i < samples; ++i) {
    const float choice = u();
    const LightSample s = lights.sample({0, 0, 0}, choice, u.pair());
    double e = 0;
    const double cosine = s.toLight.z / length(s.toLight);
    if (s.pdf > 0 && cosine > 0) e = s.radiance.g * cosine / (s.delta ? 1 : s.pdf);
    sum += e;
    squares += e * e;
  }
  const double mean = sum / samples;
  return {mean, std::sqrt(std::max(0.0, squares / samples - mean * mean) / samples)};
}

/// The quad [-1, 1]^2 at height 1 that emits.
Emitters quad(float radiance) {
  return Emitters({{{-1, -1, 1}, {2, 0, 0}, {0, 2, 0}, grey(radiance), 0, 0},
                   {{1, 1, 1}, {-2, 0, 0}, {0, -2, 0}, grey(radiance), 0, 1}});
}
/// The same in 128 triangles: too many to be weighed one by one.
Emitters tiles(float radiance) {
  std::vector<EmissiveTriangle> list;
  for (int i = 0; i < 64; ++i) {
    const double x = -1 + i % 8 * 0.25, y = -1 + i / 8 * 0.25;
    list.push_back({{x, y, 1}, {0.25, 0, 0}, {0, 0.25, 0}, grey(radiance), 0, std::uint32_t(2 * i)});
    list.push_back(
        {{x + 0.25, y + 0.25, 1}, {-0.25, 0, 0}, {0, -0.25, 0}, grey(radiance), 0, std::uint32_t(2 * i + 1)});
  }
  return Emitters(std::move(list));
}
/// Irradiance below its centre, of four corners each 1 x 1 at distance 1 (form factor of a parallel
/// rectangle).
double quadIrradiance() { return 4 * (1 / std::sqrt(2.0)) * std::atan(1 / std::sqrt(2.0)); }

TEST(Lights, SamplingAddsUpToClosedForms) {
  const auto expectMean = [](const char* what, const Lights& lights, double truth) {
    const auto [mean, error] = irradiance(lights);
    EXPECT_NEAR(mean, truth, 4.5 * error + 1e-4 * truth) << what;
  };
  const auto image = std::make_shared<Environment>(Environment::image(smallImage(), 1, 0, {0, 0, 1}));
  const double imageTruth = test::integrate(
      [&](double z, double phi) {
        const double s = std::sqrt(1 - z * z);
        return z * image->radiance({float(s * std::cos(phi)), float(s * std::sin(phi)), float(z)}).g;
      },
      0, 1, 0, 2 * std::numbers::pi, 1000);
  const DistantLight sun{normalize(Vector3(0, 1, 1)), grey(3), 0},
      wideSun{normalize(Vector3(0, 1, 1)), grey(3), 2};
  const PointLight point{{0, 3, 4}, grey(50)};
  const double slanted = 3 / std::sqrt(2.0), pointTruth = 50.0 / 25 * 4 / 5;
  expectMean("image", Lights(image, {}, {}, {}, unitBounds(), 4), imageTruth);
  expectMean("sun", Lights(nullptr, {sun}, {}, {}, unitBounds(), 4), slanted);
  expectMean("wide sun", Lights(nullptr, {wideSun}, {}, {}, unitBounds(), 4), slanted);
  expectMean("point", Lights(nullptr, {}, {point}, {}, unitBounds(), 4), pointTruth);
  expectMean("quad", Lights(nullptr, {}, {}, quad(2), unitBounds(), 4), 2 * quadIrradiance());
  expectMean("tiles", Lights(nullptr, {}, {}, tiles(2), unitBounds(), 4), 2 * quadIrradiance());
  expectMean("all", Lights(image, {sun, wideSun}, {point}, quad(2), unitBounds(), 4),
             imageTruth + 2 * slanted + pointTruth + 2 * quadIrradiance());
}

TEST(Lights, TheIrradianceJudgeRejectsALightOneHundredthTooBright) {
  const auto [mean, error] = irradiance(Lights(nullptr, {}, {}, quad(2.02f), unitBounds(), 4));
  EXPECT_GT(std::abs(mean - 2 * quadIrradiance()), 4.5 * error + 1e-4 * mean);
}

TEST(Lights, DensitiesOfFoundAndOfSampledLightsAgree) {
  const auto image = std::make_shared<Environment>(Environment::image(smallImage(), 1, 0, {0, 0, 1}));
  const DistantLight wideSun{normalize(Vector3(0, 1, 1)), grey(3), 2};
  const Lights lights(image, {wideSun}, {}, quad(2), unitBounds(), 4);
  UniformNumbers u(3);
  for (const Point3& p :
       {Point3(0, 0, 0), Point3(0.3, 0.8, 0.95), Point3(4, -7, 30)}) { // near, very near, far
    int quads = 0;
    for (int i = 0; i < 20000; ++i) {
      const float choice = u();
      const LightSample s = lights.sample(p, choice, u.pair());
      ASSERT_GT(s.pdf, 0);
      if (std::isinf(s.tfar)) continue;
      ++quads;
      const double distance = length(s.toLight);
      TraceHit hit{};
      hit.t = distance;
      hit.position = p + s.toLight;
      hit.normal = {0, 0, 1};
      hit.solid = kNone;
      EXPECT_NEAR(hit.position.z, 1, 1e-9);
      EXPECT_LE(std::max(std::abs(hit.position.x), std::abs(hit.position.y)), 1 + 1e-6);
      hit.triangle = hit.position.x + hit.position.y < 0 ? 0 : 1;
      if (std::abs(hit.position.x + hit.position.y) < 1e-6) continue; // either
      EXPECT_NEAR(lights.foundPdf(hit, {p, s.toLight / distance}), s.pdf, 1e-4 * s.pdf);
      EXPECT_GT(s.tfar, 0.99);
      EXPECT_LT(s.tfar, 1);
    }
    EXPECT_GT(quads, 1000);
  }
  // escaped() weighs by the density of the same technique: with both weights the parts add up to one.
  const Environment& e = *image;
  const Lights alone(image, {}, {}, {}, unitBounds(), 4);
  for (int i = 0; i < 1000; ++i) {
    const Vector3f d = u.direction();
    const float bsdfPdf = 0.3f, lightPdf = e.pdf(d);
    const Color seen = alone.escaped(d, bsdfPdf), all = alone.escaped(d, 0);
    EXPECT_NEAR(seen.g, all.g * powerHeuristic(bsdfPdf, lightPdf), 1e-4 * all.g);
  }
}

TEST(TriangleLights, DirectionsFollowTheDensity) {
  // Near (a spherical triangle), nearer than its size, and so far that points are drawn by area; few
  // triangles, each weighed at the point, and many.
  for (const bool many : {false, true})
    for (const Point3& p : {Point3(0, 0, 0), Point3(0.3, 0.5, 0.8), Point3(2.5, -1, -3.5)}) {
      const TriangleLights lights(many ? tiles(2) : quad(2), 4);
      const auto density = [&](const Vector3f& w) {
        const Vector3 d = normalize(Vector3(w));
        TraceHit hit{};
        hit.t = (1 - p.z) / d.z;
        hit.position = p + d * hit.t;
        const double x = hit.position.x, y = hit.position.y;
        if (!(hit.t > 0) || std::max(std::abs(x), std::abs(y)) > 1) return 0.f;
        hit.normal = {0, 0, 1};
        hit.solid = kNone;
        hit.triangle = x + y < 0 ? 0 : 1;
        if (many) {
          const double i = std::min(std::floor((x + 1) * 4), 7.0), j = std::min(std::floor((y + 1) * 4), 7.0);
          hit.triangle = std::uint32_t(2 * (8 * j + i)) + ((x + 1) * 4 - i + (y + 1) * 4 - j < 1 ? 0 : 1);
        }
        return lights.foundPdf(hit, {p, d});
      };
      // Cells divide a cone about the light: 1 - cosine within it is stretched over the sphere.
      const Vector3 middle = Point3(0, 0, 1) - p;
      const Frame frame{Vector3f(normalize(middle))};
      const auto opening = float(1 - std::cos(std::min(1.6, 2.4 / length(middle))));
      const auto withCosine = [](const Vector3f& v, float z) {
        const float s = std::sqrt(std::max(0.f, 1 - z * z)) / std::max(std::hypot(v.x, v.y), 1e-20f);
        return Vector3f(v.x * s, v.y * s, z);
      };
      const auto result = test::directionChiSquared(
          [&](UniformNumbers& u) -> std::optional<Vector3f> {
            const float choice = u();
            const LightSample s = lights.sample(p, choice, u.pair());
            const Vector3f local = frame.toLocal(Vector3f(normalize(s.toLight)));
            if (1 - local.z > opening) return {};
            return withCosine(local, 1 - (1 - local.z) * 2 / opening);
          },
          [&](const Vector3f& v) {
            return density(frame.toWorld(withCosine(v, 1 - (1 - v.z) / 2 * opening))) * opening / 2;
          },
          100000, 20, 20, 64);
      EXPECT_GT(result.pValue, test::kSignificance) << many << " at " << p.z << ": " << result.text();
      EXPECT_GT(result.cells, 30u);
    }
}

TEST(SphericalTriangle, DirectionsAreUniformOverItsSolidAngle) {
  const Vector3 octant[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  EXPECT_NEAR(SphericalTriangle(octant[0], octant[1], octant[2]).solidAngle(), std::numbers::pi / 2, 1e-12);
  const Vector3 cases[][3] = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                              {{3, 1, 0.2}, {-1, 2, 0.2}, {-1, -2, 0.3}}, // nearly a hemisphere
                              {{1, 0.1, 4}, {0, 1, 4}, {-1, 0, 3}},
                              {{5, 0, 1}, {5, 0.5, 1.3}, {-2, 3, 4}}};
  for (const auto& [a, b, c] : cases) {
    const SphericalTriangle triangle(a, b, c);
    const Vector3 ab = cross(a, b), bc = cross(b, c), ca = cross(c, a);
    const double side = dot(ab, c) > 0 ? 1 : -1;
    const auto result = test::directionChiSquared(
        [&](UniformNumbers& u) { return std::optional(Vector3f(triangle.sample(u.pair()))); },
        [&, v = 1 / triangle.solidAngle()](const Vector3f& d) {
          const Vector3 w(d);
          // A hair wider than the triangle: cells that it only just misses must not count as impossible.
          return dot(ab, w) * side > -1e-5 && dot(bc, w) * side > -1e-5 && dot(ca, w) * side > -1e-5 ? v : 0;
        },
        100000, 24, 24, 96);
    EXPECT_GT(result.pValue, test::kSignificance) << result.text();
  }
}

TEST(Lights, HeuristicWeightsSumToOne) {
  for (const auto& [a, b] : {std::pair(1.f, 2.f), {1e-30f, 1e-30f}, {1e30f, 1.f}, {0.f, 3.f}, {3e38f, 2e38f}})
    EXPECT_FLOAT_EQ(powerHeuristic(a, b) + powerHeuristic(b, a), 1);
  EXPECT_EQ(powerHeuristic(0, 0), 0);
}

TEST(Lights, EvenSkiesAreLeftToScatteredRays) {
  const Lights even(std::make_shared<Environment>(Environment::constant(grey(2))), {}, {}, {}, unitBounds(),
                    4);
  EXPECT_TRUE(even.empty());
  EXPECT_EQ(even.escaped({0, 0, 1}, 0.3f), grey(2)) << "their whole light counts where it is found";
  const Lights uneven(std::make_shared<Environment>(Environment::image(smallImage(), 1, 0, {0, 0, 1})), {},
                      {}, {}, unitBounds(), 4);
  EXPECT_FALSE(uneven.empty());
}

TEST(Lights, NoLightsIsEmpty) {
  EXPECT_TRUE(Lights(nullptr, {}, {}, {}, unitBounds(), 4).empty());
  EXPECT_TRUE(
      Lights(std::make_shared<Environment>(Environment::constant({})), {}, {}, {}, unitBounds(), 4).empty());
  EXPECT_FALSE(Lights(nullptr, {}, {{{0, 0, 1}, grey(1)}}, {}, unitBounds(), 4).empty());
}

} // namespace
} // namespace chamfer
