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
  const auto flats = flatMargins(view, mesh);
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

TEST(FlatMargins, HoldForASmallSolidOfALargeMeshWhereFloat32PutsIt) {
  // A brick and a far one: float32 about the mesh's centre has the brick's vertices elsewhere.
  std::vector<oracle::ConvexSolid> bricks{oracle::box(0.24, 0.115, 0.071), oracle::box(0.24, 0.115, 0.071)};
  for (const double distance : {20.0, 60.0, 500.0}) {
    bricks[1] =
        oracle::transformed(bricks[0], {Eigen::Matrix3d::Identity(), {distance, 0.3 * distance, 0.7}});
    const TriangleMesh mesh = meshOf(bricks);
    PreprocessOptions options;
    options.radius = {0.004, false};
    const auto rounding = preprocess(mesh, options).rounding;
    const RoundingView& view = rounding->view();
    const auto flats = flatMargins(view, mesh);
    Bounds3 bounds;
    for (const Point3& p : mesh.positions)
      bounds.extend(p);
    const Point3 centre = bounds.centre();
    const auto rounded = [&](const Point3& p) {
      return Point3(centre.x + double(float(p.x - centre.x)), centre.y + double(float(p.y - centre.y)),
                    centre.z + double(float(p.z - centre.z)));
    };
    const float doubt = float(0x1p-22 * 0.5 * bounds.diagonal());
    std::mt19937_64 random(11);
    std::uniform_real_distribution<float> uniform(0, 1);
    std::size_t steep = 0, held = 0, wrong = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const FacetRecord& facet = view.facets[flats[t].facet];
      const SolidRecord& solid = view.solids[facet.solid];
      const Point3 origin(solid.origin[0], solid.origin[1], solid.origin[2]);
      const Vector3 normal(facet.normal);
      Point3 corner[3];
      for (std::size_t k = 0; k < 3; ++k)
        corner[k] = rounded(mesh.positions[mesh.triangles[t][k]]);
      for (int i = 0; i < 2000; ++i) {
        const float x = std::sqrt(uniform(random)), y = uniform(random), u = x * (1 - y), v = x * y;
        const Point3 met =
            corner[0] + (corner[1] - corner[0]) * double(u) + (corner[2] - corner[0]) * double(v);
        const double sine = std::exp2(-6.5 * double(uniform(random))), angle = 7 * double(uniform(random));
        const Vector3 along = normalize(cross(normal, Vector3(0.3, 0.5, 0.8))), across = cross(normal, along);
        const Vector3 direction = normal * -sine + (along * std::cos(angle) + across * std::sin(angle)) *
                                                       std::sqrt(std::max(0.0, 1 - sine * sine));
        const bool holds = flats[t].holds(u, v, doubt, float(sine * sine));
        steep += sine > 0.5;
        held += holds && sine > 0.5;
        if (!holds) continue;
        // Where the ray meets the plane in truth.
        const double t0 = (double(facet.offset) - dot(normal, met - origin)) / dot(normal, direction);
        const Point3 there = met + direction * t0;
        wrong += detect(view, facet.solid, flats[t].facet, Point3(there - origin)).inZone;
      }
    }
    EXPECT_EQ(wrong, 0u) << distance;
    // A fifth of a brick's faces is rounding and what is near it.
    if (distance < 100) {
      EXPECT_GT(double(held), 0.6 * double(steep)) << distance;
    }
  }
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
