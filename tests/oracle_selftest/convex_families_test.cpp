// The tests' solids are what they claim: closed, convex, planar, and of known size.
#include "tests/oracle/convex_families.h"
#include "tests/oracle/inradius.h"
#include "tests/oracle/random.h"
#include "tests/oracle/rounded_oracle.h"

#include <gtest/gtest.h>
#include <map>
#include <numbers>

namespace chamfer::oracle {
namespace {

void expectConvex(const ConvexSolid& solid) {
  const double diagonal = solid.diagonal();
  const Eigen::Vector3d centre = solid.centroid();
  const std::vector<Plane> planes = solid.planes(centre);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
  for (std::size_t f = 0; f < solid.faces.size(); ++f) {
    const auto& face = solid.faces[f];
    ASSERT_GE(face.size(), 3u) << solid.name;
    EXPECT_GT(planes[f].offset, 0) << solid.name << ": face " << f << " looks inward";
    for (std::size_t i = 0; i < face.size(); ++i) {
      ++sides[{face[i], face[(i + 1) % face.size()]}];
      const Vec3 at = (solid.vertices[face[i]] - centre).cast<Real>();
      EXPECT_LE(std::abs(planes[f].normal.dot(at) - planes[f].offset), 1e-14 * diagonal) << solid.name;
    }
    for (const auto& v : solid.vertices)
      ASSERT_LE(planes[f].normal.dot((v - centre).cast<Real>()) - planes[f].offset, 1e-14 * diagonal)
          << solid.name;
  }
  for (const auto& [side, count] : sides) {
    EXPECT_EQ(count, 1) << solid.name;
    EXPECT_EQ(sides.count({side.second, side.first}), 1u) << solid.name << " is open";
  }
  EXPECT_EQ(solid.vertices.size() + solid.faces.size(), sides.size() / 2 + 2) << solid.name;
}

TEST(ConvexFamilies, AreClosedConvexAndPlanar) {
  for (const ConvexSolid& solid : familyCatalogue())
    expectConvex(solid);
}

TEST(ConvexFamilies, LargeOnesToo) {
  for (const ConvexSolid& solid : largeFamilies())
    expectConvex(solid);
}

TEST(ConvexFamilies, HaveTheirKnownFacesAndInradii) {
  const double phi = std::numbers::phi;
  struct Row {
    ConvexSolid solid;
    std::size_t vertices, faces;
    double inradius;
  };
  const Row rows[] = {
      {cube(), 8, 6, 0.5},
      {box(1, 2, 3), 8, 6, 0.5},
      {tetrahedron(), 4, 4, 1 / std::sqrt(3.0)},
      {octahedron(), 6, 8, 1 / std::sqrt(3.0)},
      {dodecahedron(), 20, 12, phi * phi / std::sqrt(1 + phi * phi)},
      {icosahedron(), 12, 20, phi * phi / std::sqrt(3.0)},
      {prism(200, 1), 400, 202, 0.5},
      {prism(6, 4), 12, 8, std::sqrt(3.0) / 2},
      {antiprism(7, 0.5), 14, 16, 0.25},
  };
  for (const Row& row : rows) {
    EXPECT_EQ(row.solid.vertices.size(), row.vertices) << row.solid.name;
    EXPECT_EQ(row.solid.faces.size(), row.faces) << row.solid.name;
    EXPECT_NEAR(double(inball(row.solid).radius) / row.inradius, 1, 1e-14) << row.solid.name;
  }
}

TEST(ConvexFamilies, InradiusCarriesItsCertificate) {
  std::vector<ConvexSolid> solids = familyCatalogue();
  for (const ConvexSolid& solid : largeFamilies())
    solids.push_back(solid);
  for (const ConvexSolid& solid : solids) {
    for (const ConvexSolid& moved : {solid, placed(solid, 1e-6, 1e4, 3), placed(solid, 1e6, 0, 4)}) {
      const Inball ball = inball(moved);
      EXPECT_LE(ball.gap, 1e-12L * ball.radius) << solid.name;
      EXPECT_GT(ball.radius, 0) << solid.name;
    }
  }
}

TEST(ConvexFamilies, MapsKeepFacesOutward) {
  const ConvexSolid mirrored = transformed(hullOnSphere(30, 9), scaling(-1, 2, 0.5));
  expectConvex(mirrored);
  expectConvex(placed(dodecahedron(), 1e6, 0, 5));
}

TEST(ConvexFamilies, WedgeHasItsAngle) {
  const ConvexSolid solid = wedge(30);
  const auto planes = solid.planes(Eigen::Vector3d::Zero());
  Real sharpest = 180;
  for (const Plane& a : planes)
    for (const Plane& b : planes)
      if (&a != &b && a.normal.dot(b.normal) > -0.999L) // the caps are parallel
        sharpest =
            std::min(sharpest, 180 - std::acos(a.normal.dot(b.normal)) * 180 / std::numbers::pi_v<Real>);
  EXPECT_NEAR(double(sharpest), 30, 1e-10);
}

TEST(ConvexFamilies, ObjHasEveryCornerAndFace) {
  EXPECT_EQ(toObj(transformed(tetrahedron(), scaling(0.1, 1, 1)), ObjFaces::Polygons).substr(0, 45),
            "o tetrahedron\nv 0.10000000000000001 1 1\nv 0.1");
  const ConvexSolid two[] = {cube(), cube()};
  const auto lines = [&](ObjFaces faces, char first) {
    const std::string text = "\n" + toObj(two, faces);
    std::size_t count = 0;
    for (std::size_t i = 0; i + 1 < text.size(); ++i)
      count += text[i] == '\n' && text[i + 1] == first;
    return count;
  };
  EXPECT_EQ(lines(ObjFaces::Polygons, 'v'), 16u);
  EXPECT_EQ(lines(ObjFaces::Polygons, 'f'), 12u);
  EXPECT_EQ(lines(ObjFaces::Triangles, 'f'), 24u);
}

} // namespace
} // namespace chamfer::oracle
