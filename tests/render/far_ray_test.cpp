// Rays that start far from the scene, or whose directions have extreme lengths: the same hits, and no end of
// the process (Embree asserts that coordinates are below 1.8e18).
#include "preprocess/preprocess.h"
#include "server/render/tracing/tracer.h"
#include "tests/oracle/convex_families.h"
#include "tests/support/mesh_of.h"

#include <gtest/gtest.h>

namespace chamfer {
namespace {

class FarRays : public testing::Test {
protected:
  FarRays() {
    auto mesh = std::make_shared<TriangleMesh>(meshOf(oracle::box(2, 2, 2)));
    PreprocessOptions options;
    options.radius.value = 0.25;
    const auto rounding = preprocess(*mesh, options).rounding;
    const auto traced = makeTracedMesh(mesh);
    tracer_ = makeTracer({{traced, rounding, {}}, {traced, rounding, Transform::translate({8, 0, 0})}});
  }
  std::shared_ptr<const Tracer> tracer_;
};

TEST_F(FarRays, HitWhatNearOnesHit) {
  const Ray near{{-6, 0.4, 0.3}, {1, 0.01, -0.02}};
  const auto expected = tracer_->intersect(near);
  ASSERT_TRUE(expected);
  for (const double away : {1e3, 1e6, 1e9}) {
    const Ray far{near.origin - near.direction * away, near.direction};
    const auto hit = tracer_->intersect(far);
    ASSERT_TRUE(hit) << away;
    const double ulp = 0x1p-52 * away;
    EXPECT_LT(length(hit->position - expected->position), 1e-6 + 16 * ulp) << away;
    EXPECT_NEAR(hit->t, expected->t + away, 1e-6 + 16 * ulp);
    EXPECT_FALSE(tracer_->intersect({far.origin, -far.direction})) << "the scene is behind it";
    const auto second = tracer_->intersect(far, {}, hit->t + 2.5);
    ASSERT_TRUE(second) << "the next solid, beyond tnear";
    EXPECT_EQ(second->instance, 1u);
    EXPECT_FALSE(tracer_->intersect(far, {}, 0, hit->t - 0.1)) << "tfar ends before";
  }
}

TEST_F(FarRays, AnyLengthOfDirectionDoes) {
  const Ray plain{{-6, 0.4, 0.3}, {1, 0.01, -0.02}};
  const auto expected = tracer_->intersect(plain);
  for (const double size : {1e-150, 1e-30, 1e-7, 1e7, 1e20, 1e150}) {
    const auto hit = tracer_->intersect({plain.origin, plain.direction * size});
    ASSERT_TRUE(hit) << size;
    EXPECT_LT(length(hit->position - expected->position), 1e-6) << size;
    EXPECT_NEAR(hit->t * size, expected->t, 1e-6) << size;
  }
}

TEST_F(FarRays, BeginWhereverTnearIs) {
  const Ray ray{{-6, 0.4, 0.3}, {1, 0.01, -0.02}};
  const auto expected = tracer_->intersect(ray);
  ASSERT_TRUE(expected);
  for (const double size : {1e-9, 1.0, 1e9}) {
    const Ray scaled{ray.origin, ray.direction * size};
    const auto second = tracer_->intersect(scaled, {}, (expected->t + 2.5) / size);
    ASSERT_TRUE(second) << size;
    EXPECT_EQ(second->instance, 1u) << "the next solid";
  }
  for (const double tnear : {1e2, 1e4, 1e9, 1e19, 1e30, 1e300}) {
    EXPECT_FALSE(tracer_->intersect(ray, {}, tnear)) << tnear;
    EXPECT_FALSE(tracer_->intersect({ray.origin, ray.direction * 1e30}, {}, tnear)) << tnear;
    EXPECT_FALSE(tracer_->intersect({{-1e12, 0, 0}, {1, 0, 0}}, {}, 2e12 + tnear)) << tnear;
  }
}

TEST_F(FarRays, BeyondAllMeasureIsAMissAndNoHarm) {
  for (const double away : {1e18, 1e30, 1e100})
    for (const Vector3& direction : {Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(-1, 1e-20, 1)})
      tracer_->intersect({{-away, away, 0.5}, direction});
  EXPECT_FALSE(tracer_->intersect({{-1e30, 1e20, 0}, {1, 0, 0}}));
  EXPECT_TRUE(tracer_->stateAt({1e30, 0, 0}).empty());
  EXPECT_FALSE(tracer_->stateAt({0.1, 0.2, 0.3}).empty());
  EXPECT_TRUE(tracer_->intersect({{-6, 0.4, 0.3}, {1, 0, 0}}));
}

TEST_F(FarRays, NothingIsInAnEmptyScene) {
  const auto empty = makeTracer({});
  EXPECT_FALSE(empty->intersect({{0, 0, 5}, {0, 0, -1}}));
}

} // namespace
} // namespace chamfer
