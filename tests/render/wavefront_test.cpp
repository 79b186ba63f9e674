// The wavefront against the depth-first tracer, path by path and bit by bit, and its lanes against the scalar
// formulas that they stand for.
#include "server/render/path/camera.h"
#include "server/render/path/pixel_filter.h"
#include "server/render/path/prepared_scene.h"
#include "server/render/wavefront/wavefront.h"
#include "tests/render/direction_chi_squared.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstring>

namespace chamfer {
namespace {

using test::UniformNumbers;

std::uint32_t bits(float v) { return std::bit_cast<std::uint32_t>(v + 0.f); } // -0 counts as 0
bool sameBits(const Color& a, const Color& b) {
  return bits(a.r) == bits(b.r) && bits(a.g) == bits(b.g) && bits(a.b) == bits(b.b);
}
bool sameBits(const Vector3f& a, const Vector3f& b) {
  return bits(a.x) == bits(b.x) && bits(a.y) == bits(b.y) && bits(a.z) == bits(b.z);
}

std::shared_ptr<const Scene> bundled(const std::string& name) {
  const std::filesystem::path data = CHAMFER_SOURCE_DIR "/data";
  return loadScene(data / (name + ".scene.json"), data, name);
}

struct CameraPath {
  Sampler sampler;
  Ray ray;
};

std::vector<CameraPath> cameraPaths(const Scene& scene, unsigned width, unsigned height, unsigned samples) {
  const CameraRays camera(scene.camera, width, height);
  std::vector<CameraPath> paths;
  for (unsigned s = 0; s < samples; ++s)
    for (unsigned y = 0; y < height; ++y)
      for (unsigned x = 0; x < width; ++x) {
        const Sampler sampler(x, y, s, 1);
        const Float2 o = PixelFilter::instance().sample(sampler.pair(kPixelPair));
        paths.push_back(
            {sampler, camera.ray(x + 0.5 + double(o.x), y + 0.5 + double(o.y), sampler.pair(kLensPair))});
      }
  return paths;
}

class WavefrontOf : public testing::TestWithParam<const char*> {};

TEST_P(WavefrontOf, GivesEveryPathTheDepthFirstTracersBits) {
  const auto scene = bundled(GetParam());
  for (const RoundingChoice& choice :
       {RoundingChoice{RoundingMode::None, 0, {}}, RoundingChoice{},
        RoundingChoice{RoundingMode::Mesh, 2, {}}, RoundingChoice{RoundingMode::Bevel, 2, {}}}) {
    const auto prepared = prepare(scene, choice);
    const PathTracer tracer(prepared->surfaces(), prepared->tracer(), prepared->lights(), 8);
    const auto paths = cameraPaths(*scene, 40, 30, 2);
    std::vector<PathState> from;
    for (const CameraPath& p : paths)
      from.push_back(prepared->tracer().stateAt(p.ray.origin));
    std::vector<Color> expected;
    RayStatistics alone, together;
    for (std::size_t i = 0; i < paths.size(); ++i)
      expected.push_back(tracer.radiance(paths[i].ray, from[i], paths[i].sampler, alone));
    Wavefront wave(tracer);
    std::size_t different = 0;
    for (const std::size_t size : {std::size_t(1), std::size_t(13), paths.size()})
      for (std::size_t first = 0; first < paths.size(); first += size) {
        wave.clear();
        const std::size_t end = std::min(paths.size(), first + size);
        for (std::size_t i = end; i-- > first;) // other neighbours than a picture's, too
          wave.add(paths[i].ray, from[i], paths[i].sampler);
        wave.follow(together);
        for (std::size_t i = first; i < end; ++i)
          different += !sameBits(wave.light(end - 1 - i), expected[i]);
      }
    EXPECT_EQ(different, 0u) << "of " << 3 * paths.size() << ", rounding " << int(choice.mode);
    EXPECT_EQ(together.camera.traced, 3 * alone.camera.traced);
    EXPECT_EQ(together.camera.hits, 3 * alone.camera.hits);
    EXPECT_EQ(together.bounce.traced, 3 * alone.bounce.traced);
    EXPECT_EQ(together.bounce.hits, 3 * alone.bounce.hits);
    EXPECT_EQ(together.bounce.rounded, 3 * alone.bounce.rounded);
    EXPECT_EQ(together.shadow.hits, 3 * alone.shadow.hits);
  }
}

INSTANTIATE_TEST_SUITE_P(Bundled, WavefrontOf, testing::Values("blocks", "still-life", "room", "dice"),
                         [](const auto& instance) {
                           std::string name = instance.param;
                           std::erase(name, '-');
                           return name;
                         });

OpaqueSurfaces surfacesOf(const std::array<SurfaceValues, kLanes>& values) {
  OpaqueSurfaces s;
  for (std::size_t i = 0; i < kLanes; ++i) {
    s.baseColor.set(i, values[i].baseColor);
    s.roughness[i] = values[i].roughness;
    s.metallic[i] = values[i].metallic;
    s.specular[i] = values[i].specular;
    s.ior[i] = values[i].ior;
  }
  return s;
}

TEST(OpaqueLanes, HaveTheBitsOfTheScalarBsdf) {
  UniformNumbers u(3);
  // Extremes as often as anything between.
  const auto parameter = [&] {
    const float v = 2 * u() - 0.5f;
    return std::clamp(v, 0.f, 1.f);
  };
  std::size_t reflected = 0, mirrored = 0;
  for (int round = 0; round < 4000; ++round) {
    std::array<SurfaceValues, kLanes> values;
    VectorLaneFloats wo, wi;
    LaneFloats lobe, ux, uy;
    for (std::size_t i = 0; i < kLanes; ++i) {
      values[i] = {{parameter(), parameter(), parameter()},
                   parameter(),
                   parameter(),
                   parameter(),
                   0,
                   1 + 2 * parameter()};
      wo.set(i, warpToCosineHemisphere(u.pair()));
      wo.z[i] = std::max(wo.z[i], 1e-6f);
      wi.set(i, u.direction());
      lobe[i] = u();
      ux[i] = u();
      uy[i] = u();
    }
    const OpaqueBsdf lanes(surfacesOf(values), wo);
    const BsdfLanes evaluated = lanes.evaluate(wi);
    const BsdfSampleLanes sampled = lanes.sample(lobe, ux, uy);
    const ColorLaneFloats f(evaluated.f), weight(sampled.weight);
    const VectorLaneFloats next(sampled.wi);
    for (std::size_t i = 0; i < kLanes; ++i) {
      const Bsdf one(values[i], wo[i], 1);
      const BsdfValue value = one.evaluate(wi[i]);
      EXPECT_TRUE(sameBits(f[i], value.f)) << f[i].r << " " << value.f.r << " metal " << values[i].metallic;
      EXPECT_EQ(bits(evaluated.pdf[i]), bits(value.pdf));
      EXPECT_EQ(lanes.hasSmoothPart()[i], one.hasSmoothPart());
      const BsdfSample s = one.sample(lobe[i], {ux[i], uy[i]});
      ASSERT_EQ(sampled.valid[i], s.valid);
      if (!s.valid) continue;
      EXPECT_EQ(sampled.delta[i], s.delta);
      EXPECT_EQ(bits(sampled.pdf[i]), bits(s.pdf));
      EXPECT_TRUE(sameBits(next[i], s.wi));
      EXPECT_TRUE(sameBits(weight[i], s.weight));
      ++(s.delta ? mirrored : reflected);
    }
  }
  EXPECT_GT(reflected, 1000u);
  EXPECT_GT(mirrored, 1000u);
}

TEST(LightLanes, HaveTheBitsOfTheScalarLights) {
  for (const char* name : {"blocks", "still-life", "room", "dice"}) {
    const auto prepared = prepare(bundled(name), {});
    const Lights& lights = prepared->lights();
    if (lights.empty()) continue;
    const LightSampler sampler(lights);
    const Bounds3 bounds = prepared->scene().bounds;
    UniformNumbers u(5);
    std::size_t lit = 0;
    for (int round = 0; round < 2000; ++round) {
      Point3 points[kLanes];
      LaneFloats choice, ux, uy;
      for (std::size_t i = 0; i < kLanes; ++i) {
        for (std::size_t k = 0; k < 3; ++k)
          points[i][k] = bounds.lower[k] + double(2 * u() - 0.5f) * (bounds.upper[k] - bounds.lower[k]);
        choice[i] = u();
        ux[i] = u();
        uy[i] = u();
      }
      LightLanes result;
      const std::size_t count = 1 + std::size_t(round) % kLanes;
      sampler.sample(points, choice, ux, uy, count, result);
      for (std::size_t i = 0; i < count; ++i) {
        const LightSample s = lights.sample(points[i], choice[i], {ux[i], uy[i]});
        ASSERT_EQ(bits(result.pdf[i]), bits(s.pdf)) << name;
        if (!(s.pdf > 0)) continue;
        ++lit;
        EXPECT_EQ(result.toLight[i], s.toLight);
        EXPECT_EQ(result.tfar[i], s.tfar);
        EXPECT_TRUE(sameBits(result.direction[i], s.direction));
        EXPECT_TRUE(sameBits(result.radiance[i], s.radiance));
        EXPECT_EQ(result.delta[i], s.delta);
      }
    }
    EXPECT_GT(lit, 1000u) << name;
  }
}

TEST(Elementary, SinesCosinesAndAnglesAreNearTheLibrarys) {
  UniformNumbers u(9);
  for (int i = 0; i < 100000; ++i) {
    const float angle = 16 * u() - 8;
    float sine, cosine;
    sineCosine(angle, sine, cosine);
    EXPECT_NEAR(sine, std::sin(double(angle)), 1.5e-7);
    EXPECT_NEAR(cosine, std::cos(double(angle)), 1.5e-7);
    const float y = u() * 1e-3f, x = 2 * u() - 1, shown = angleOf(y, x);
    EXPECT_NEAR(shown, std::atan2(double(y), double(x)), 4e-7);
    EXPECT_NEAR(angleOf(x * x, y), std::atan2(double(x * x), double(y)), 4e-7);
  }
}

TEST(SphericalTriangle, InFloatIsThatInDouble) {
  UniformNumbers u(11);
  std::size_t judged = 0;
  for (int i = 0; i < 20000; ++i) {
    Vector3 corner[3];
    for (Vector3& c : corner)
      c = Vector3(Vector3f(u.direction() * 0.3f + Vector3f(0, 0, 1 - 0.7f * u())));
    const SphericalTriangle exact(corner[0], corner[1], corner[2]);
    if (!(exact.solidAngle() > 1e-2 && exact.solidAngle() < 6.2)) continue;
    ++judged;
    const Vector3f a(corner[0]), b(corner[1]), c(corner[2]);
    const double volume = dot(corner[0], cross(corner[1] - corner[0], corner[2] - corner[0]));
    const SphericalTriangleT<float> shown(a, b, c, float(volume));
    EXPECT_NEAR(shown.solidAngle(), exact.solidAngle(), 1e-5 * exact.solidAngle());
    const Float2 at = u.pair();
    const Vector3 d(shown.sample(at)), reference = exact.sample(at);
    EXPECT_NEAR(length(d), 1, 1e-6);
    EXPECT_LT(length(d - reference), 2e-4) << exact.solidAngle();
  }
  EXPECT_GT(judged, 5000u);
}

} // namespace
} // namespace chamfer
