// The margins answer for most of a flat, and never wrongly: the point, and all around it that the ray may
// have meant, are outside every detection cylinder.
#include "server/render/tracing/flat_margins.h"

#include "common/ray_query.h"
#include "preprocess/preprocess.h"
#include "tests/oracle/convex_families.h"
#include "tests/oracle/rounded_oracle.h"
#include "tests/support/mesh_of.h"

#include <gtest/gtest.h>
#include <random>

namespace chamfer {
namespace {

struct Counted {
  std::size_t points = 0, onFlat = 0, held = 0, wrong = 0;
};

Counted throwPoints(const oracle::ConvexSolid& solid, double radius, std::size_t perTriangle) {
  const TriangleMesh mesh = meshOf(solid);
  PreprocessOptions options;
  options.radius = {radius, false};
  const auto rounding = preprocess(mesh, options).rounding;
  const RoundingView& view = rounding->view();
  const auto flats = flatMargins(view, mesh, 1);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<float> uniform(0, 1);
  Counted counted;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const TriangleFlat& flat = flats[t];
    EXPECT_EQ(flat.facet, view.facetOfTriangle[t]);
    const SolidRecord& record = view.solids[view.facets[flat.facet].solid];
    const Vector3 origin(record.origin[0], record.origin[1], record.origin[2]);
    const Point3 a = mesh.positions[mesh.triangles[t][0]];
    const Vector3 ab = mesh.positions[mesh.triangles[t][1]] - a,
                  ac = mesh.positions[mesh.triangles[t][2]] - a;
    const Vector3 along = normalize(ab), across = normalize(cross(cross(ab, ac), ab));
    for (std::size_t i = 0; i < perTriangle; ++i) {
      const float x = std::sqrt(uniform(random)), y = uniform(random), u = x * (1 - y), v = x * y;
      const Point3 p = a + ab * double(u) + ac * double(v);
      const auto inZone = [&](const Point3& q) {
        return detect(view, 0, flat.facet, Point3(q - Point3(origin))).inZone;
      };
      const float slack = std::exp2(float(flat.slack));
      const bool holds = flat.holds(u, v, 0.5f * slack, 0.25f);
      ++counted.points;
      counted.onFlat += !inZone(p);
      counted.held += holds;
      if (!holds) continue;
      for (int k = 0; k < 8; ++k) { // off by as much as the ray was said to be
        const double angle = k * M_PI / 4;
        counted.wrong += inZone(p + (along * std::cos(angle) + across * std::sin(angle)) * double(slack));
      }
    }
  }
  return counted;
}

TEST(FlatMargins, NeverHoldInAZone) {
  for (const oracle::ConvexSolid& solid : oracle::familyCatalogue())
    for (const double share : {1e-4, 0.03, 0.3, 0.8}) {
      const double radius = share * double(oracle::inball(solid).radius);
      const Counted c = throwPoints(solid, radius, 40);
      EXPECT_EQ(c.wrong, 0u) << solid.name << ", radius " << radius;
    }
}

TEST(FlatMargins, HoldForMostOfABoxesFlats) {
  const Counted c = throwPoints(oracle::box(2, 1, 0.5), 0.02, 4000);
  EXPECT_GT(double(c.held), 0.9 * double(c.onFlat)) << c.held << " of " << c.onFlat;
}

TEST(FlatMargins, LeaveFlatRaysAndImpreciseOnesToTheSearch) {
  TriangleFlat flat;
  flat.margins = {1, 1, 1};
  flat.slack = -10;
  EXPECT_TRUE(flat.holds(0.3f, 0.3f, 0x1p-12f, 1));
  EXPECT_FALSE(flat.holds(0.3f, 0.3f, 0x1p-9f, 1));
  EXPECT_FALSE(flat.holds(0.3f, 0.3f, 0x1p-12f, 0x1p-6f));
  EXPECT_FALSE(flat.holds(0.3f, 0.3f, 0, 0x1p-14f));
  EXPECT_FALSE(flat.holds(0.001f, 0.3f, 0, 1));
  EXPECT_FALSE(TriangleFlat().holds(0.3f, 0.3f, 0, 1));
}

} // namespace
} // namespace chamfer
