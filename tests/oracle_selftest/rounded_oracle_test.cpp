// The oracle against closed forms and against itself by other ways.
#include "tests/oracle/convex_families.h"
#include "tests/oracle/ray_samples.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <numbers>

namespace chamfer::oracle {
namespace {

using Eigen::Vector3d;

/// Distance from the centred box of half lengths `half`.
Real boxDistance(const Vec3& p, Real half) {
  Vec3 outside = (p.cwiseAbs() - Vec3::Constant(half)).cwiseMax(Vec3::Zero());
  return outside.norm();
}

TEST(RoundedOracle, CubeByHand) {
  const RoundedOracle oracle(cube(), 0.1);
  EXPECT_EQ(oracle.core().vertices.size(), 8u);
  EXPECT_EQ(oracle.core().edges.size(), 12u);
  // A flat, an edge's cylinder at 45 degrees, a corner's sphere along the diagonal.
  auto hit = oracle.interval({{0.2, 0.1, 5}, {0, 0, -2}});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(double(hit->in.t), 2.25, 1e-17);
  EXPECT_NEAR(double(hit->out.t), 2.75, 1e-17);
  EXPECT_EQ(hit->in.feature, Feature::Flat);
  EXPECT_EQ(hit->in.normal, Vec3(0, 0, 1));
  EXPECT_EQ(hit->out.normal, Vec3(0, 0, -1));

  hit = oracle.interval({{5, 0.1, 5}, {-1, 0, -1}});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(double(hit->in.t), 4.6 - 0.1 / std::sqrt(2.0), 1e-15);
  EXPECT_EQ(hit->in.feature, Feature::Cylinder);
  EXPECT_NEAR(double(hit->in.normal.dot(Vec3(1, 0, 1).normalized())), 1, 1e-17);

  hit = oracle.interval({{5, 5, 5}, {-1, -1, -1}});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(double(hit->in.t), 4.6 - 0.1 / std::sqrt(3.0), 1e-15);
  EXPECT_EQ(hit->in.feature, Feature::Sphere);

  // Meets the cube, misses the rounded cube: 0.01 inside the edge, where the rounding is 0.0414 deep.
  EXPECT_FALSE(oracle.interval({{0.5, -3, 0.48}, {0, 1, 0}}));
  EXPECT_NEAR(double(oracle.silhouetteMargin({{0.5, -3, 0.48}, {0, 1, 0}})), std::hypot(0.1, 0.08) - 0.1,
              1e-16);
  EXPECT_NEAR(double(oracle.silhouetteMargin({{0.45, -3, 0.42}, {0, 1, 0}})), std::hypot(0.05, 0.02) - 0.1,
              1e-16);
  EXPECT_NEAR(double(oracle.silhouetteMargin({{0, -3, 0}, {0, 1, 0}})), -0.1, 1e-17);
}

TEST(RoundedOracle, CubeDistancesAndFeatures) {
  const RoundedOracle oracle(cube(), 0.15);
  Random random(1);
  for (int i = 0; i < 20000; ++i) {
    const Vec3 p = (random.direction() * random.uniform(0, 1.5)).cast<Real>();
    const Nearest near = oracle.nearest(p);
    const Real truth = boxDistance(p, 0.35L);
    if (truth > 0)
      EXPECT_NEAR(double(near.distance - truth), 0, 1e-16);
    else
      EXPECT_LE(near.distance, 0);
    const int outside = int((p.cwiseAbs().array() > 0.35L).count());
    if (outside > 0) {
      EXPECT_EQ(int(near.feature), outside - 1);
    }
  }
}

TEST(RoundedOracle, CubeRaysAgainstMarchingTheDistance) {
  // Sphere tracing over the closed-form distance knows nothing of capsules.
  const ConvexSolid solid = cube();
  const RoundedOracle oracle(solid, 0.2);
  RaySampler sampler(solid, oracle, 3);
  int hits = 0;
  for (const Ray& ray : sampler.mixed(6000)) {
    if (std::abs(oracle.silhouetteMargin(ray)) < 1e-4) continue; // marching is slow where it grazes
    const Real speed = ray.direction.norm();
    Real t = -200 / speed, gap = 1;
    for (int step = 0; step < 200000 && gap > 1e-16L && t < 200 / speed; ++step) {
      gap = boxDistance(ray.at(t), 0.3L) - 0.2L;
      t += gap / speed;
    }
    const auto hit = oracle.interval(ray);
    ASSERT_EQ(hit.has_value(), gap <= 1e-16L);
    if (!hit) continue;
    ++hits;
    EXPECT_NEAR(double((hit->in.t - t) * speed), 0, 1e-11);
  }
  EXPECT_GT(hits, 2000);
}

TEST(RoundedOracle, NearTheInradiusIsNearlyABall) {
  const ConvexSolid solid = dodecahedron();
  const double r = double(inball(solid).radius) * (1 - 1e-9);
  const RoundedOracle oracle(solid, r);
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const Vector3d from = random.direction() * 7, aim = random.direction() * random.uniform(0, 1.2);
    const Vector3d direction = (aim - from).normalized();
    const double miss = from.cross(direction).norm();
    const auto hit = oracle.interval({from, direction});
    if (std::abs(miss - r) < 1e-6) continue;
    ASSERT_EQ(hit.has_value(), miss < r);
    if (!hit) continue;
    EXPECT_NEAR(double(hit->out.t - hit->in.t), 2 * std::sqrt(r * r - miss * miss), 1e-5);
  }
  EXPECT_NEAR(double(oracle.volume()), 4 * std::numbers::pi / 3 * r * r * r, 1e-7);
  EXPECT_THROW(RoundedOracle(solid, double(inball(solid).radius) * (1 + 1e-9)), std::runtime_error);
}

TEST(RoundedOracle, SteinerOfTheBox) {
  const double a = 1, b = 2, c = 3, r = 0.25;
  const RoundedOracle oracle(box(a, b, c), r);
  const double x = a - 2 * r, y = b - 2 * r, z = c - 2 * r, pi = std::numbers::pi;
  EXPECT_NEAR(double(oracle.volume()),
              x * y * z + 2 * r * (x * y + y * z + z * x) + pi * r * r * (x + y + z) + 4 * pi / 3 * r * r * r,
              1e-14);
  EXPECT_NEAR(double(oracle.area()), 2 * (x * y + y * z + z * x) + 2 * pi * r * (x + y + z) + 4 * pi * r * r,
              1e-14);
}

TEST(RoundedOracle, SteinerByMonteCarlo) {
  for (const ConvexSolid& solid : {icosahedron(), hullOnSphere(20, 120), wedge(30), bipyramid(30, 0.7)}) {
    const double r = 0.4 * double(inball(solid).radius);
    const RoundedOracle oracle(solid, r);
    Vector3d low = solid.vertices.front(), high = low;
    for (const Vector3d& v : solid.vertices)
      low = low.cwiseMin(v), high = high.cwiseMax(v);
    const double boxVolume = (high - low).prod();
    Random random(4);
    const int count = 20000;
    int inside = 0;
    for (int i = 0; i < count; ++i) {
      Vector3d p;
      for (int k = 0; k < 3; ++k)
        p[k] = random.uniform(low[k], high[k]);
      inside += oracle.nearest(p.cast<Real>()).distance <= r;
    }
    const double share = double(oracle.volume()) / boxVolume;
    const double deviation = std::sqrt(share * (1 - share) / count);
    EXPECT_NEAR(double(inside) / count, share, 4 * deviation) << solid.name;
  }
}

class RoundedOracleFamilies : public ::testing::TestWithParam<double> {};

TEST_P(RoundedOracleFamilies, EndsLieOnTheSurfaceAndFeaturesFit) {
  std::vector<ConvexSolid> solids = familyCatalogue();
  solids.push_back(placed(hullInBall(40, 5), 1e-6, 1e4, 5));
  for (const ConvexSolid& solid : solids) {
    const double r = GetParam() * double(inball(solid).radius);
    const RoundedOracle oracle(solid, r);
    EXPECT_TRUE(oracle.core().closed) << solid.name;
    RaySampler sampler(solid, oracle, 6);
    const Real tiny = 1e-15L * oracle.diagonal();
    for (const Ray& ray : sampler.mixed(rayBudget(120))) {
      const Real margin = oracle.silhouetteMargin(ray);
      const auto hit = oracle.interval(ray);
      if (std::abs(margin) > 1e-9 * oracle.diagonal()) {
        EXPECT_EQ(hit.has_value(), margin < 0) << solid.name;
      }
      if (!hit) continue;
      for (const End& end : {hit->in, hit->out}) {
        const Nearest near = oracle.nearest(ray.at(end.t));
        EXPECT_NEAR(double(near.distance - r), 0, double(100 * tiny)) << solid.name;
        EXPECT_LT((near.normal - end.normal).norm(), 1e-6) << solid.name;
        if (near.seamDistance > 1e-9 * oracle.diagonal()) {
          EXPECT_EQ(near.feature, end.feature) << solid.name;
        }
      }
      EXPECT_LE(hit->in.normal.dot(ray.direction.cast<Real>()), 0) << solid.name;
      EXPECT_GE(hit->out.normal.dot(ray.direction.cast<Real>()), 0) << solid.name;
      const Real middle = (hit->in.t + hit->out.t) / 2;
      EXPECT_LE(oracle.nearest(ray.at(middle)).distance, r + tiny) << solid.name;
    }
  }
}

TEST_P(RoundedOracleFamilies, SurfaceSamplesLieOnTheSurface) {
  for (const ConvexSolid& solid : familyCatalogue()) {
    const double r = GetParam() * double(inball(solid).radius);
    const RoundedOracle oracle(solid, r);
    RaySampler sampler(solid, oracle, 7);
    for (int i = 0; i < 20; ++i) {
      const SurfacePoint p = i % 2 ? sampler.onSurface() : sampler.onSeam();
      const Nearest near = oracle.nearest(p.position.cast<Real>());
      EXPECT_NEAR(double(near.distance) - r, 0, 1e-14 * oracle.diagonal()) << solid.name;
      EXPECT_LT((near.normal.cast<double>() - p.normal).norm(), 1e-12 * oracle.diagonal() / r + 1e-9)
          << solid.name;
      if (i % 2 == 0) {
        EXPECT_LT(near.seamDistance, 1e-9 * oracle.diagonal()) << solid.name;
      }
    }
  }
}

TEST_P(RoundedOracleFamilies, FlatMarginIsTheDistanceOfTheFlat) {
  for (const ConvexSolid& solid : familyCatalogue()) {
    const double r = GetParam() * double(inball(solid).radius);
    const RoundedOracle oracle(solid, r);
    RaySampler sampler(solid, oracle, 8);
    std::size_t judged = 0;
    for (std::uint32_t f = 0; f < solid.faces.size(); ++f) {
      const Vec3 p = sampler.onFacet(f).cast<Real>();
      const Real margin = oracle.flatMargin(f, p);
      if (std::abs(margin) < 1e-9 * oracle.diagonal()) continue;
      ++judged;
      // A point of P's surface is on R's exactly where it is on a flat.
      const Real gap = oracle.nearest(p).distance - r;
      const Real noise = 1e-14 * oracle.diagonal();
      if (margin > 0)
        EXPECT_NEAR(double(gap), 0, double(noise)) << solid.name;
      else
        EXPECT_GT(gap, -noise) << solid.name;
      // Off a flat that is there it is outside, no farther than the flat's border lets it be.
      if (margin < -1e-6 * oracle.diagonal() && std::isfinite(margin)) {
        EXPECT_GT(gap, noise) << solid.name;
        EXPECT_LE(gap, std::hypot(Real(r), margin) - r + noise) << solid.name;
      }
    }
    EXPECT_GE(judged, 0.9 * double(solid.faces.size())) << solid.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Radii, RoundedOracleFamilies, ::testing::Values(1e-4, 0.1, 0.6, 0.999));

TEST(RoundedOracle, SliverStartsAreInSlivers) {
  const ConvexSolid solid = hullOnSphere(20, 120);
  const RoundedOracle oracle(solid, 0.3 * double(inball(solid).radius));
  RaySampler sampler(solid, oracle, 9);
  const std::vector<Ray> rays = sampler.sample(RayKind::Sliver, 500);
  ASSERT_EQ(rays.size(), 500u);
  for (const Ray& ray : rays) {
    const Vec3 start = ray.origin.cast<Real>();
    EXPECT_GE(oracle.nearest(start).distance, oracle.radius() * (1 - 1e-12));
    for (const Plane& plane : oracle.planes())
      EXPECT_LE(plane.normal.dot(start - oracle.centre().cast<Real>()), plane.offset + 1e-13);
  }
}

} // namespace
} // namespace chamfer::oracle
