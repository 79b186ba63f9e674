#include "preprocess/preprocess.h"

#include "common/error.h"
#include "tests/oracle/convex_families.h"
#include "tests/oracle/rounded_oracle.h"
#include "tests/support/mesh_of.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace chamfer {
namespace {

PreprocessResult rounded(const TriangleMesh& mesh, double radius) {
  PreprocessOptions options;
  options.radius.value = radius;
  return preprocess(mesh, options);
}

ErrorKind refusal(const TriangleMesh& mesh, const PreprocessOptions& options, std::string& message) {
  try {
    preprocess(mesh, options);
  } catch (const Error& e) {
    message = e.what();
    return e.kind();
  }
  return ErrorKind::Internal;
}

TEST(Preprocess, CubeHasSixFacetsTwelveEdgesEightSpheres) {
  const auto result = rounded(meshOf(oracle::cube()), 0.1);
  EXPECT_EQ(result.report.solids, 1u);
  EXPECT_EQ(result.report.facets, 6u);
  EXPECT_EQ(result.report.roundedEdges, 12u);
  EXPECT_EQ(result.report.spheres, 8u);
  EXPECT_EQ(result.report.cornersOver3, 0u);
  EXPECT_NEAR(result.report.maxRadius, 0.5, 1e-12);
  const RoundingView& view = result.rounding->view();
  for (const SphereRecord& s : view.spheres) {
    const Vector3 c = decodeSphere(s, sphereQuantum(view.solids[0]));
    for (const double x : {c.x, c.y, c.z})
      EXPECT_NEAR(std::abs(x), 0.4, 2e-12);
  }
}

TEST(Preprocess, CoreHasTheOraclesCountsOverTheFamilies) {
  for (const auto& solid : oracle::familyCatalogue()) {
    const double inradius = double(oracle::inball(solid).radius);
    for (const double share : {0.01, 0.3, 0.9}) {
      const auto result = rounded(meshOf(solid), share * inradius);
      EXPECT_NO_THROW(validate(result.rounding->view())) << solid.name << " at " << share;
      EXPECT_NEAR(result.report.maxRadius, inradius, 1e-9 * inradius) << solid.name;
      EXPECT_EQ(result.report.facets, solid.faces.size()) << solid.name;
      const auto& r = result.report;
      // Euler's formula for E: vertices - edges + faces = 2.
      EXPECT_EQ(r.spheres + (r.facets - r.vanishedFacets), r.roundedEdges + 2)
          << solid.name << " at " << share;
    }
  }
}

TEST(Preprocess, RadiusAtTheInradiusIsRefusedWithTheLargestThatWorks) {
  PreprocessOptions options;
  options.radius.value = 0.5;
  try {
    preprocess(meshOf(oracle::cube()), options);
    FAIL() << "accepted";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::RadiusTooLarge);
    EXPECT_THAT(e.what(), testing::HasSubstr("solid 1"));
    EXPECT_THAT(e.details(),
                testing::Contains(testing::Pair("max_radius", testing::DoubleNear(0.4995, 1e-9))));
  }
  EXPECT_NO_THROW(rounded(meshOf(oracle::cube()), 0.4995));
}

TEST(Preprocess, ClampRoundsEachSolidWithItsOwnShare) {
  oracle::ConvexSolid small = oracle::transformed(oracle::cube(), oracle::scaling(0.1, 0.1, 0.1));
  const oracle::ConvexSolid both[] = {oracle::cube(), small};
  PreprocessOptions options;
  options.radius.value = 0.2;
  options.clamp = 0.5;
  const auto result = preprocess(meshOf(both), options);
  EXPECT_EQ(result.report.clampedSolids, 1u);
  EXPECT_FLOAT_EQ(result.rounding->view().solids[0].radius, 0.2f);
  EXPECT_FLOAT_EQ(result.rounding->view().solids[1].radius, 0.025f);
}

TEST(Preprocess, OpenComponentIsNamedAndCanStaySharp) {
  TriangleMesh mesh = meshOf(oracle::cube());
  mesh.triangles.pop_back();
  PreprocessOptions options;
  options.radius.value = 0.1;
  std::string message;
  EXPECT_EQ(refusal(mesh, options, message), ErrorKind::NotConvexSolid);
  EXPECT_THAT(message, testing::HasSubstr("open"));
  options.onNonConvex = OnNonConvex::Sharp;
  const auto result = preprocess(mesh, options);
  EXPECT_EQ(result.report.sharpComponents, 1u);
  EXPECT_THAT(result.rounding->view().facetOfTriangle, testing::Each(kNone));
}

TEST(Preprocess, DentIsMeasuredAndItsHullCanBeRounded) {
  // The top's centre pushed in by 0.05 of the edge: depth 0.05 / sqrt(3) of the diagonal.
  oracle::ConvexSolid cube = oracle::cube();
  TriangleMesh mesh;
  for (const auto& v : cube.vertices)
    mesh.positions.push_back({v.x(), v.y(), v.z()});
  const auto centre = std::uint32_t(mesh.positions.size());
  bool dented = false;
  for (const auto& face : cube.faces) {
    bool top = true;
    for (const std::uint32_t v : face)
      top = top && cube.vertices[v].z() > 0.4;
    if (!top) {
      mesh.triangles.push_back({face[0], face[1], face[2]});
      mesh.triangles.push_back({face[0], face[2], face[3]});
      continue;
    }
    dented = true;
    mesh.positions.push_back({0, 0, 0.45});
    for (std::size_t i = 0; i < 4; ++i)
      mesh.triangles.push_back({centre, face[i], face[(i + 1) % 4]});
  }
  ASSERT_TRUE(dented);
  mesh.faceOfTriangle.resize(mesh.triangles.size());
  PreprocessOptions options;
  options.radius.value = 0.1;
  try {
    preprocess(mesh, options);
    FAIL() << "accepted";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::NotConvexSolid);
    EXPECT_THAT(e.details(), testing::Contains(
                                 testing::Pair("measure", testing::DoubleNear(0.05 / std::sqrt(3.0), 1e-9))));
  }
  options.onNonConvex = OnNonConvex::Hull;
  const auto result = preprocess(mesh, options);
  EXPECT_EQ(result.report.hulledComponents, 1u);
  EXPECT_EQ(result.report.facets, 6u);
}

TEST(Preprocess, RadiusTextIsALengthOrAShare) {
  EXPECT_DOUBLE_EQ(parseRadius("0.25").value, 0.25);
  EXPECT_FALSE(parseRadius("0.25").relative);
  EXPECT_DOUBLE_EQ(parseRadius("2%").value, 0.02);
  EXPECT_TRUE(parseRadius("2%").relative);
  for (const char* bad : {"", "%", "0", "-1", "nan", "inf", "1x", "1 ", "0,5"})
    EXPECT_THROW(parseRadius(bad), Error) << bad;
}

TEST(Preprocess, IsTheSameWithAnyNumberOfThreads) {
  const auto solids = oracle::familyCatalogue();
  const TriangleMesh mesh = meshOf(solids);
  PreprocessOptions options;
  options.radius = parseRadius("1%");
  options.clamp = 0.9;
  options.threads = 1;
  const auto one = preprocess(mesh, options);
  options.threads = 2;
  const auto two = preprocess(mesh, options);
  EXPECT_TRUE(std::ranges::equal(one.rounding->view().spheres, two.rounding->view().spheres));
  EXPECT_TRUE(std::ranges::equal(std::as_bytes(one.rounding->view().packed),
                                 std::as_bytes(two.rounding->view().packed)));
}

} // namespace
} // namespace chamfer
