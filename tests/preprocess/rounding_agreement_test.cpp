// The whole rounding, from the mesh to the answers of rays, against the independent oracle: every family of
// solids, radii from 1e-4 to 0.999 of the inradius, scales from 1e-6 to 1e6, up to 1e4 diagonals from the
// origin. CHAMFER_RAYS=100 multiplies the number of rays.
#include "tests/oracle/convex_families.h"
#include "tests/oracle/ray_samples.h"
#include "tests/preprocess/rounding_subject.h"

#include <gtest/gtest.h>
#include <iostream>
#include <limits>

namespace chamfer {
namespace {

using oracle::AgreementReport;
using oracle::ConvexSolid;
using oracle::RaySampler;
using oracle::RoundedOracle;
using oracle::UnionOracle;

constexpr double kRadii[] = {1e-4, 0.01, 0.1, 0.3, 0.6, 0.9, 0.99, 0.999};

struct Placement {
  double scale, offsetDiagonals;
};
constexpr Placement kPlacements[] = {{1, 0}, {1e-6, 0}, {1e6, 3}, {1, 1e4}};

std::string at(const ConvexSolid& solid, double share) {
  return solid.name + ", radius " + std::to_string(share) + " of the inradius: ";
}

struct Case {
  Case(const ConvexSolid& s, double share)
      : solid(s), radius(share * double(inball(s).radius)), truth(std::make_shared<RoundedOracle>(s, radius)),
        all(truth), subject(s, radius) {}
  const ConvexSolid& solid;
  double radius;
  std::shared_ptr<const RoundedOracle> truth;
  UnionOracle all;
  RoundedSubject subject;
};

/// Rays whose tnear lies before everything: the line's entry is the truth.
std::vector<oracle::Ray> asLines(std::vector<oracle::Ray> rays) {
  for (oracle::Ray& ray : rays)
    ray.tnear = -std::numeric_limits<double>::infinity();
  return rays;
}

/// Of the rays at one solid. Where it is thin and its radius small, the rays that aim within some radii of an
/// edge or a corner are nearer to it than what counts as the silhouette: up to 2.8 % are excused. Of all
/// solids together it is 0.05 %.
constexpr double kExcusedOfOne = 0.04, kExcusedOfAll = 0.001;

/// The parameter is an index in kPlacements.
class RoundingAgreement : public ::testing::TestWithParam<int> {
protected:
  const Placement placement = kPlacements[GetParam()];
  std::uint64_t seed = 1000 * std::uint64_t(GetParam()); ///< each placement sees other rays
};

TEST_P(RoundingAgreement, EntryAndExitOfLines) {
  AgreementReport entries, exits;
  for (const ConvexSolid& family : oracle::familyCatalogue()) {
    const ConvexSolid solid = oracle::placed(family, placement.scale, placement.offsetDiagonals, ++seed);
    for (const double share : kRadii) {
      const Case c(solid, share);
      RaySampler sampler(solid, *c.truth, ++seed);
      const auto lines = asLines(sampler.mixed(oracle::rayBudget(600)));
      const AgreementReport in = compare(c.subject.entryOfLine(), c.all, lines);
      EXPECT_TRUE(in.agrees(kExcusedOfOne)) << at(solid, share) << "entry: " << in.complaint();
      const AgreementReport out = compare(c.subject.exitOfReversedLine(), c.all, lines);
      EXPECT_TRUE(out.agrees(kExcusedOfOne)) << at(solid, share) << "exit: " << out.complaint();
      entries.merge(in);
      exits.merge(out);
    }
  }
  EXPECT_TRUE(entries.agrees(kExcusedOfAll)) << entries.summary();
  EXPECT_TRUE(exits.agrees(kExcusedOfAll)) << exits.summary();
  std::cout << "entry: " << entries.summary() << "\nexit:  " << exits.summary() << "\n";
}

TEST_P(RoundingAgreement, FirstEndBeyondTheRaysStart) {
  AgreementReport sum;
  for (const ConvexSolid& family : oracle::familyCatalogue()) {
    const ConvexSolid solid = oracle::placed(family, placement.scale, placement.offsetDiagonals, ++seed);
    for (const double share : kRadii) {
      const Case c(solid, share);
      RaySampler sampler(solid, *c.truth, ++seed);
      const AgreementReport report =
          compare(c.subject.firstEnd(), c.all, sampler.mixed(oracle::rayBudget(600)));
      EXPECT_TRUE(report.agrees(kExcusedOfOne)) << at(solid, share) << report.complaint();
      sum.merge(report);
    }
  }
  EXPECT_TRUE(sum.agrees(kExcusedOfAll)) << sum.summary();
  std::cout << "first end: " << sum.summary() << "\n";
}

INSTANTIATE_TEST_SUITE_P(Placements, RoundingAgreement, ::testing::Range(0, int(std::size(kPlacements))));

TEST(RoundingAgreementLarge, ManySidesAndPoints) {
  AgreementReport sum;
  oracle::Tolerances tolerances;
  // Among thousands of facets some neighbours are coplanar to 1e-6 diagonals: preprocessing makes one of
  // them.
  tolerances.noise = 1e-6;
  for (const ConvexSolid& solid : oracle::largeFamilies())
    for (const double share : {0.01, 0.3, 0.9}) {
      const Case c(solid, share);
      RaySampler sampler(solid, *c.truth, 5);
      const auto rays = sampler.mixed(oracle::rayBudget(2000));
      const AgreementReport first = compare(c.subject.firstEnd(), c.all, rays, tolerances);
      EXPECT_TRUE(first.agrees()) << at(solid, share) << "first end: " << first.complaint();
      const AgreementReport in = compare(c.subject.entryOfLine(), c.all, asLines(rays), tolerances);
      // Lines along the axis of the prism with 200 sides graze its edges: 0.65 %.
      EXPECT_TRUE(in.agrees(0.01)) << at(solid, share) << "entry: " << in.complaint();
      sum.merge(first);
      sum.merge(in);
    }
  std::cout << "large: " << sum.summary() << "\n";
}

TEST(RoundingAgreementSeams, NormalsAndSurfaceAreContinuous) {
  std::size_t pairs = 0, excused = 0;
  std::uint64_t seed = 50;
  for (const ConvexSolid& solid : oracle::familyCatalogue())
    for (const double share : kRadii) {
      const Case c(solid, share);
      RaySampler sampler(solid, *c.truth, ++seed);
      const auto rays = asLines(sampler.sample(oracle::RayKind::Seam, oracle::rayBudget(300)));
      for (const double step : {1e-8, 1e-6}) {
        const auto report = checkContinuity(c.subject.entryOfLine(), *c.truth, rays, step);
        pairs += report.pairs;
        excused += report.excused;
        EXPECT_EQ(report.cracks, 0u) << at(solid, share) << report.examples.front();
        EXPECT_EQ(report.creases, 0u) << at(solid, share) << report.examples.front();
      }
    }
  EXPECT_LE(excused, 0.02 * double(pairs)) << "1.5 % are at the silhouette";
  std::cout << "seams: " << pairs << " pairs of rays, " << excused << " excused\n";
}

TEST(RoundingAgreementInterval, IsEntryAndExit) {
  std::size_t both = 0;
  for (const ConvexSolid& solid : {oracle::cube(), oracle::hullOnSphere(20, 120), oracle::pyramid(24, 1.5)}) {
    const Case c(solid, 0.4);
    RaySampler sampler(solid, *c.truth, 9);
    for (const oracle::Ray& ray : sampler.mixed(3000)) {
      const double* o = c.subject.view().solids[0].origin;
      const Ray local{{ray.origin.x() - o[0], ray.origin.y() - o[1], ray.origin.z() - o[2]},
                      {ray.direction.x(), ray.direction.y(), ray.direction.z()}};
      const auto whole = interval(c.subject.view(), 0, local, 0);
      const auto in = entry(c.subject.view(), 0, local, 0), out = exit(c.subject.view(), 0, local, 0);
      if (std::abs(c.truth->silhouetteMargin(ray)) < 1e-6) continue;
      ASSERT_EQ(whole.has_value(), in.has_value());
      ASSERT_EQ(whole.has_value(), out.has_value());
      if (!whole) continue;
      ++both;
      EXPECT_NEAR(whole->in.t, in->t, 1e-6);
      EXPECT_NEAR(whole->out.t, out->t, 1e-6);
      EXPECT_LT(whole->in.t, whole->out.t);
    }
  }
  EXPECT_GT(both, 2000u);
}

TEST(RoundingAgreementUnion, SolidsThatTouchOrInterpenetrate) {
  oracle::Affine up, into;
  up.offset = {0.2, 0, 1};
  into = oracle::randomRotation(4);
  into.offset = {0.5, 0.3, 0.2};
  const ConvexSolid solids[] = {oracle::cube(), transformed(oracle::cube(), up),
                                transformed(oracle::icosahedron(), into)};
  const double radius = 0.12;
  UnionOracle truth;
  for (const ConvexSolid& solid : solids)
    truth.add(std::make_shared<RoundedOracle>(solid, radius));
  const RoundedSubject subject(solids, radius);
  AgreementReport sum;
  for (std::size_t i = 0; i < 3; ++i) {
    RaySampler sampler(solids[i], truth.part(i), 30 + i);
    const AgreementReport report =
        compare(subject.firstEnd(), truth, sampler.mixed(oracle::rayBudget(20000)));
    // Where solids touch, one's end is the other's start, and either may come first: 1.1 %.
    EXPECT_TRUE(report.agrees(0.015)) << report.complaint();
    sum.merge(report);
  }
  std::cout << "union: " << sum.summary() << "\n";
}

TEST(RoundingAgreementPrecision, CubeFromTenEdgeLengths) {
  for (const double r : {0.01, 0.001}) {
    const ConvexSolid solid = oracle::cube();
    const RoundedOracle truth(solid, r);
    const UnionOracle all(std::make_shared<RoundedOracle>(truth));
    const RoundedSubject subject(solid, r);
    RaySampler sampler(solid, truth, 3);
    oracle::Random random(4);
    std::vector<oracle::Ray> rays;
    for (std::size_t i = 0; i < oracle::rayBudget(100000); ++i) {
      const auto target = i % 2 ? sampler.onCylinder() : sampler.onSphere();
      // The eye is ten edge lengths away; from the target's normal it is spread as the pixels of a picture
      // are: by the cosine.
      const Eigen::Vector3d from = (target.normal + random.direction() * 0.999999).normalized();
      const oracle::Ray ray{target.position + 10 * from, -from};
      rays.push_back(ray);
    }
    const AgreementReport report = compare(subject.firstEnd(), all, rays);
    std::cout << "r/L = " << r << " from 10 L: " << report.summary() << "\n";
    EXPECT_TRUE(report.agrees()) << report.complaint();
    EXPECT_EQ(report.excused, 0u) << report.complaint();
    EXPECT_LE(report.acrossOfRadius.quantile(0.99), r == 0.01 ? 1e-4 : 1e-3);
    EXPECT_LE(report.alongOfRadius.quantile(0.99), r == 0.01 ? 1e-4 : 1e-3);
  }
}

double shortestEdge(const oracle::Polytope& core, std::uint32_t face) {
  double shortest = std::numeric_limits<double>::infinity();
  const auto& loop = core.faces[face];
  for (std::size_t i = 0; i < loop.size(); ++i)
    shortest = std::min(shortest,
                        double((core.vertices[loop[i]] - core.vertices[loop[(i + 1) % loop.size()]]).norm()));
  return shortest;
}

/// Points on every facet: in the zone for the detection exactly where the oracle says so.
TEST(DetectionAgreement, ZoneIsWhatTheFlatsLeave) {
  std::size_t points = 0, inZone = 0, border = 0;
  std::uint64_t seed = 500;
  std::vector<ConvexSolid> solids = oracle::familyCatalogue();
  for (ConvexSolid& solid : oracle::largeFamilies())
    solids.push_back(std::move(solid));
  for (const ConvexSolid& solid : solids) {
    const bool large = solid.faces.size() > 150;
    for (const double share : kRadii) {
      if (large && share != 0.1 && share != 0.6) continue;
      const Case c(solid, share);
      RaySampler sampler(solid, *c.truth, ++seed);
      const std::size_t each =
          std::max<std::size_t>(3, oracle::rayBudget(large ? 2000 : 600) / solid.faces.size());
      std::size_t missed = 0, caught = 0;
      double worst = 0;
      for (std::uint32_t f = 0; f < solid.faces.size(); ++f) {
        // The direction of a short edge of E is known to its ends' rounding over its length, and its
        // detection cylinder is endless: it may catch flat points, which costs a search but is not wrong.
        const double blur = 1e-10 * c.truth->diagonal() / shortestEdge(c.truth->core(), f);
        for (std::size_t i = 0; i < each; ++i) {
          const Eigen::Vector3d p = sampler.onFacet(f);
          const double margin = double(c.truth->flatMargin(f, p.cast<oracle::Real>())) / c.truth->diagonal();
          ++points;
          inZone += margin < 0;
          if (margin < 0 ? margin >= -1e-6 : margin <= 1e-6 + blur) {
            ++border;
            continue;
          }
          const bool zone = c.subject.detectAt(0, f, p).inZone;
          if (zone == (margin < 0)) continue;
          worst = std::max(worst, std::abs(margin));
          ++(zone ? caught : missed);
        }
      }
      EXPECT_EQ(missed, 0u) << at(solid, share) << "zone points taken for flats; worst " << worst
                            << " diagonals inside";
      EXPECT_EQ(caught, 0u) << at(solid, share) << "flat points taken for zone; worst " << worst
                            << " diagonals inside";
    }
  }
  std::cout << "detection: " << points << " points, " << inZone << " in zones, " << border
            << " within 1e-6 of a border\n";
  EXPECT_LT(border, points / 10);
}

} // namespace
} // namespace chamfer
