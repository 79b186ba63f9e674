// The judge must pass the right answers and fail each kind of wrong one.
#include "tests/oracle/agreement.h"
#include "tests/oracle/convex_families.h"
#include "tests/oracle/exact_hull.h"
#include "tests/oracle/random.h"
#include "tests/oracle/ray_samples.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <limits>

namespace chamfer::oracle {
namespace {

Answer answerOf(const Hit& hit) { return {double(hit.t), hit.normal.cast<double>(), hit.feature}; }

Subject subjectOf(const UnionOracle& truth) {
  return [&truth](const Ray& ray) -> std::optional<Answer> {
    if (const auto hit = truth.firstHit(ray)) return answerOf(*hit);
    return {};
  };
}

class Agreement : public ::testing::Test {
protected:
  const ConvexSolid solid = hullOnSphere(12, 77);
  const double r = 0.3 * double(inball(solid).radius);
  const std::shared_ptr<const RoundedOracle> oracle = std::make_shared<RoundedOracle>(solid, r);
  const UnionOracle truth{oracle};
  RaySampler sampler{solid, *oracle, 1};
  const std::vector<Ray> rays = sampler.mixed(12000);

  AgreementReport judge(const std::function<void(const Ray&, std::optional<Answer>&)>& spoil) const {
    const Subject right = subjectOf(truth);
    return compare(
        [&](const Ray& ray) {
          auto answer = right(ray);
          spoil(ray, answer);
          return answer;
        },
        truth, rays);
  }
};

TEST_F(Agreement, TheOracleAgreesWithItself) {
  const AgreementReport report = judge([](const Ray&, auto&) {});
  EXPECT_TRUE(report.agrees()) << report.complaint();
  EXPECT_EQ(report.rays, rays.size());
  EXPECT_GT(report.roundedHits, rays.size() / 5);
  EXPECT_GT(report.hits - report.roundedHits, rays.size() / 10);
  EXPECT_LT(report.across.largest(), 1e-13);
  EXPECT_EQ(report.excused, 0u);
}

TEST_F(Agreement, ExcusesHaveABound) {
  AgreementReport report = judge([](const Ray&, auto&) {});
  report.rays = 1000;
  report.excused = 5;
  EXPECT_TRUE(report.agrees());
  report.excused = 6;
  EXPECT_FALSE(report.agrees());
  EXPECT_NE(report.complaint().find("too many of the rays are excused"), std::string::npos);
  EXPECT_TRUE(report.agrees(0.01));
  report.faults[std::size_t(Fault::Normal)] = 1;
  EXPECT_FALSE(report.agrees(0.01));
  EXPECT_FALSE(AgreementReport{}.agrees()) << "nothing was judged";
}

TEST_F(Agreement, ThreadsDoNotChangeTheReport) {
  Tolerances one;
  one.threads = 1;
  Tolerances four;
  four.threads = 4;
  const Subject right = subjectOf(truth);
  EXPECT_EQ(compare(right, truth, rays, one).summary(), compare(right, truth, rays, four).summary());
}

TEST_F(Agreement, ARadiusOffByOnePercentIsSeen) {
  const UnionOracle wrong(std::make_shared<RoundedOracle>(solid, r * 1.01));
  const AgreementReport report = compare(subjectOf(wrong), truth, rays);
  EXPECT_GT(report.faults[std::size_t(Fault::Position)], rays.size() / 20) << report.summary();
  EXPECT_GT(report.faults[std::size_t(Fault::HitMiss)], 0u) << report.summary();
}

TEST_F(Agreement, MissingCornerSpheresAreSeen) {
  const auto report = judge([](const Ray&, std::optional<Answer>& answer) {
    if (answer && answer->feature == Feature::Sphere) answer.reset();
  });
  EXPECT_GT(report.faults[std::size_t(Fault::HitMiss)], rays.size() / 50) << report.summary();
}

TEST_F(Agreement, TheSharpMeshIsSeen) {
  // Sharp: the line's interval inside P.
  const AgreementReport report = compare(
      [&](const Ray& ray) -> std::optional<Answer> {
        Real in = -std::numeric_limits<Real>::infinity(), out = -in;
        Vec3 nIn = Vec3::Zero(), nOut = Vec3::Zero();
        for (const Plane& plane : oracle->planes()) {
          const Real rate = plane.normal.dot(ray.direction.cast<Real>());
          const Real t =
              (plane.offset - plane.normal.dot((ray.origin - oracle->centre()).cast<Real>())) / rate;
          if (rate < 0 && t > in) in = t, nIn = plane.normal;
          if (rate > 0 && t < out) out = t, nOut = plane.normal;
        }
        if (in > out || out < ray.tnear) return {};
        return in > ray.tnear ? Answer{double(in), nIn.cast<double>(), Feature::Flat}
                              : Answer{double(out), nOut.cast<double>(), Feature::Flat};
      },
      truth, rays);
  EXPECT_GT(report.faults[std::size_t(Fault::HitMiss)], rays.size() / 100) << report.summary();
  EXPECT_GT(report.faults[std::size_t(Fault::Position)], rays.size() / 10) << report.summary();
}

TEST_F(Agreement, FlippedAndTiltedNormalsAreSeen) {
  auto report = judge([](const Ray&, std::optional<Answer>& a) {
    if (a) a->normal = -a->normal;
  });
  EXPECT_EQ(report.faults[std::size_t(Fault::Normal)], report.hits) << report.summary();
  report = judge([](const Ray&, std::optional<Answer>& a) {
    if (a) a->normal = Eigen::AngleAxisd(0.005, a->normal.unitOrthogonal()) * a->normal;
  });
  EXPECT_EQ(report.faults[std::size_t(Fault::Normal)], report.hits) << report.summary();
  report = judge([](const Ray&, std::optional<Answer>& a) {
    if (a) a->normal *= 1.001;
  });
  EXPECT_EQ(report.faults[std::size_t(Fault::Normal)], report.hits) << report.summary();
}

TEST_F(Agreement, WrongFeaturesEndsAndNumbersAreSeen) {
  auto report = judge([](const Ray&, std::optional<Answer>& a) {
    if (a) a->feature = a->feature == Feature::Sphere ? Feature::Cylinder : Feature::Sphere;
  });
  EXPECT_GT(report.faults[std::size_t(Fault::Feature)], report.hits / 2) << report.summary();
  // The right surface, the wrong end of the interval.
  report = judge([&](const Ray& ray, std::optional<Answer>& a) {
    const auto inside = oracle->interval(ray);
    if (a && double(inside->in.t) == a->t)
      a = Answer{double(inside->out.t), inside->out.normal.cast<double>(), inside->out.feature};
  });
  EXPECT_GT(report.faults[std::size_t(Fault::Position)], report.hits / 4) << report.summary();
  report = judge([](const Ray&, std::optional<Answer>& a) {
    if (a) a->t = std::numeric_limits<double>::quiet_NaN();
  });
  EXPECT_EQ(report.faults[std::size_t(Fault::NotFinite)], report.hits);
  EXPECT_FALSE(report.examples.empty());
  EXPECT_NE(report.complaint().find("not finite"), std::string::npos);
}

TEST_F(Agreement, CracksAndCreasesAreSeen) {
  const std::vector<Ray> seams = sampler.sample(RayKind::Seam, 3000);
  const Subject right = subjectOf(truth);
  ContinuityReport report = checkContinuity(right, *oracle, seams, 1e-6);
  EXPECT_EQ(report.pairs, seams.size());
  EXPECT_EQ(report.cracks, 0u);
  EXPECT_EQ(report.creases, 0u);
  report = checkContinuity(
      [&](const Ray& ray) {
        auto a = right(ray);
        if (a && a->feature == Feature::Sphere) a.reset();
        return a;
      },
      *oracle, seams, 1e-6);
  EXPECT_GT(report.cracks, seams.size() / 10);
  report = checkContinuity(
      [&](const Ray& ray) {
        auto a = right(ray);
        if (a && a->feature == Feature::Cylinder)
          a->normal = Eigen::AngleAxisd(0.01, a->normal.unitOrthogonal()) * a->normal;
        return a;
      },
      *oracle, seams, 1e-6);
  EXPECT_GT(report.creases, seams.size() / 10);
}

TEST(UnionOracle, StackedBlocksOpenTheirGroove) {
  // Two unit cubes, one on the other: their touching faces are inside, the groove between their edges is
  // open.
  const auto block = std::make_shared<RoundedOracle>(cube(), 0.1);
  UnionOracle stack(block);
  Affine up;
  up.offset = {0, 0, 1};
  stack.add(block, up);
  // Along the groove's bottom, where both roundings are farthest away: the line in the touching plane enters
  // the solids where the roundings meet, 0.1 behind the faces.
  auto hit = stack.firstHit({{5, 0.1, 0.5 + 1e-9}, {-1, 0, 0}});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(double(hit->t), 4.6, 1e-4);
  EXPECT_EQ(hit->part, 1u);
  hit = stack.firstHit({{5, 0.1, 0.6}, {-1, 0, 0}});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(double(hit->t), 4.5, 1e-15);
  // From inside the lower block upwards: its own top comes first.
  hit = stack.firstHit({{0, 0, 0}, {0, 0, 1}});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(double(hit->t), 0.5, 1e-15);
  EXPECT_LT(stack.ambiguity({{0, 0, 0}, {0, 0, 1}}), 1e-12);
  // Out of the lower block's sliver, into the upper block.
  hit = stack.firstHit({{0.495, 0.1, 0.495}, {-1, 0, 3}});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->part, 1u);
}

TEST(UnionOracle, AStartIsAsAmbiguousAsItIsNearTheSurface) {
  // Above the top of a cube, along it but for one part in a thousand: how far away the end along the ray is
  // says nothing of it.
  const auto block = std::make_shared<RoundedOracle>(cube(), 0.1);
  const UnionOracle one(block);
  for (const double height : {-1e-6, 1e-6, 1e-5}) {
    SCOPED_TRACE(height);
    const Ray ray{{0.1, 0, 0.5 + height}, {1, 0, 1e-3}};
    EXPECT_NEAR(double(one.ambiguity(ray)), std::abs(height) / block->diagonal(), 1e-12);
  }
  EXPECT_GT(double(one.ambiguity({{0.1, 0, 0.3}, {0, 0, 1}})), 0.05) << "well inside, straight out";
}

TEST(ExactHull, DoesNotDependOnTheOrderOfThePoints) {
  // Full of ties: a grid whose facets hold many points that are no corners, and a prism of equal sides.
  std::vector<Eigen::Vector3d> grid, prism;
  for (int i = 0; i < 64; ++i)
    grid.emplace_back(i % 4, i / 4 % 4, i / 16);
  for (int k = 0; k < 24; ++k)
    prism.emplace_back(std::round(1e6 * std::cos(k * 0.2617993877991494)),
                       std::round(1e6 * std::sin(k * 0.2617993877991494)), 0);
  for (int k = 0; k < 24; ++k)
    prism.emplace_back(prism[std::size_t(k)].x(), prism[std::size_t(k)].y(), 7e5);
  Random random(5);
  for (auto* points : {&grid, &prism}) {
    const ConvexSolid first = exactHull("hull", *points, 1e-7);
    EXPECT_EQ(first.faces.size(), points == &grid ? 6u : 26u);
    for (int run = 0; run < 20; ++run) {
      for (std::size_t i = points->size(); i > 1; --i)
        std::swap((*points)[i - 1], (*points)[random.below(i)]);
      const ConvexSolid again = exactHull("hull", *points, 1e-7);
      ASSERT_EQ(again.vertices, first.vertices);
      ASSERT_EQ(again.faces, first.faces);
    }
  }
}

TEST(UnionOracle, NonUniformScaleMapsTheRounding) {
  UnionOracle scene;
  Affine map = scaling(2, -1, 0.5);
  map.offset = {1, 2, 3};
  scene.add(std::make_shared<RoundedOracle>(cube(), 0.1), map);
  const auto hit = scene.firstHit({{1 + 2 * 5, 2, 3 + 0.5 * 5}, {-2, 0, -0.5}});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(double(hit->t), 4.6 - 0.1 / std::sqrt(2.0), 1e-15);
  EXPECT_NEAR(double(hit->normal.dot(Vec3(0.5, 0, 2).normalized())), 1, 1e-15);
  EXPECT_NEAR(double(scene.nearest(0, Vec3(1 + 1.2, 2, 3)).offSurface), 0.1 / std::sqrt(3.0), 1e-15);
}

} // namespace
} // namespace chamfer::oracle
