#include "tests/preprocess/mesh_makers.h"

#include <gmock/gmock.h>

namespace chamfer {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::SizeIs;

/// The fault that `mesh`'s only component must have.
Fault faultOf(const TriangleMesh& mesh) {
  const Components components = split(mesh);
  EXPECT_THAT(components.list, SizeIs(1));
  if (components.list.empty() || !components.list[0].fault) {
    ADD_FAILURE() << "no fault";
    return {FaultKind::Concave, "", 0, {}, 0};
  }
  return *components.list[0].fault;
}

TEST(SolidsFaults, WhatTheFileSharesIsAFaultOutsideSoups) {
  TriangleMesh mesh;
  appendBox(mesh, {0, 0, 0}, {1, 1, 1});
  appendBox(mesh, {1, 1, 0}, {2, 2, 1});
  for (Corners& t : mesh.triangles)
    for (std::uint32_t& v : t)
      v = v == 8 ? 3 : v == 12 ? 7 : v; // the common edge's vertices
  const Fault fault = faultOf(mesh);
  EXPECT_EQ(fault.kind, FaultKind::NonManifold);
  EXPECT_EQ(fault.measure, 1);
  EXPECT_EQ(fault.place, Point3(1, 1, 0.5));
  EXPECT_THAT(fault.message, AllOf(HasSubstr("1 edge "), HasSubstr("4 at the first")));
}

TEST(SolidsFaults, OpenSurfacesNameTheirEdges) {
  TriangleMesh mesh = box();
  mesh.triangles.pop_back();
  mesh.lineOfFace.assign(12, 0);
  for (std::uint32_t f = 0; f < 12; ++f)
    mesh.lineOfFace[f] = 100 + f;
  const Fault fault = faultOf(mesh);
  EXPECT_EQ(fault.kind, FaultKind::Open);
  EXPECT_EQ(fault.measure, 3);
  EXPECT_LT(fault.triangle, 11u);
  EXPECT_THAT(fault.message, AllOf(HasSubstr("3 edges"), HasSubstr("line 10"), HasSubstr("--weld")));
}

TEST(SolidsFaults, AnInnerWallIsNonManifold) {
  TriangleMesh mesh = box();
  appendTriangle(mesh, {0, 3, 7}); // through the box, along one diagonal of a face and two edges of others
  appendTriangle(mesh, {0, 7, 4});
  const Fault fault = faultOf(mesh);
  EXPECT_EQ(fault.kind, FaultKind::NonManifold);
  EXPECT_THAT(fault.message, HasSubstr("more than two triangles"));
}

TEST(SolidsFaults, TooFewTrianglesAreNoSolid) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  appendTriangle(mesh, {0, 1, 2});
  EXPECT_EQ(faultOf(mesh).kind, FaultKind::TooFew);
  appendTriangle(mesh, {0, 2, 1});
  EXPECT_EQ(faultOf(mesh).kind, FaultKind::TooFew);
  EXPECT_EQ(faultOf(mesh).measure, 2);
}

TEST(SolidsFaults, FlatIsMeasuredAgainstThePlanarityTolerance) {
  const auto plate = [](double thickness) {
    TriangleMesh mesh;
    appendBox(mesh, {0, 0, 0}, {1, 1, thickness});
    return mesh;
  };
  EXPECT_EQ(faultOf(plate(0)).kind, FaultKind::Flat);
  const Fault fault = faultOf(plate(1e-7));
  EXPECT_EQ(fault.kind, FaultKind::Flat);
  EXPECT_NEAR(fault.measure, 1e-7 / std::sqrt(2), 1e-12);
  expectSound(split(plate(1e-4)), plate(1e-4), 1);
}

TEST(SolidsFaults, HandlesAreCounted) {
  // A frame: a box with a square hole, as a ring of four corners with rectangular section.
  TriangleMesh mesh;
  for (int i = 0; i < 4; ++i)
    for (const double r : {1.0, 2.0})
      for (const double z : {0.0, 1.0})
        mesh.positions.push_back({(i == 0 || i == 3) ? r : -r, i < 2 ? r : -r, z});
  const auto at = [](int corner, int k) { return std::uint32_t(4 * (corner % 4) + k); };
  constexpr int kSection[4] = {0, 1, 3, 2}; // around the rectangle
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 4; ++k) {
      const int p = kSection[k], q = kSection[(k + 1) % 4];
      appendTriangle(mesh, {at(i, p), at(i + 1, p), at(i + 1, q)});
      appendTriangle(mesh, {at(i, p), at(i + 1, q), at(i, q)});
    }
  const Fault fault = faultOf(mesh);
  EXPECT_EQ(fault.kind, FaultKind::Genus);
  EXPECT_EQ(fault.measure, 1);
  EXPECT_EQ(faultOf(unwelded(mesh, true)).kind, FaultKind::Genus);
}

TEST(SolidsFaults, OneSidedSurfacesAreRefused) {
  // The projective plane over six vertices: closed, two triangles at each edge, no inside.
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0.3}, {0.3, 1, 1}};
  for (const Corners& t :
       {Corners{0, 1, 2}, Corners{0, 2, 3}, Corners{0, 3, 4}, Corners{0, 4, 5}, Corners{0, 5, 1},
        Corners{1, 2, 4}, Corners{2, 3, 5}, Corners{3, 4, 1}, Corners{4, 5, 2}, Corners{5, 1, 3}})
    appendTriangle(mesh, t);
  EXPECT_EQ(faultOf(mesh).kind, FaultKind::Misoriented);
}

TEST(SolidsFaults, ScalesThatSinglePrecisionCannotSquareAreRefused) {
  for (const double size : {1e-30, 1e150}) {
    TriangleMesh mesh = box();
    for (Point3& p : mesh.positions)
      p = {p.x * size, p.y * size, p.z * size};
    EXPECT_EQ(faultOf(mesh).kind, FaultKind::NotFinite) << size;
  }
}

TEST(SolidsFaults, CavitiesAreFaultsAndNestedSolidsAreNot) {
  const auto nested = [](bool outerInwards, bool innerInwards, const Point3& innerLower = {1, 1, 1}) {
    TriangleMesh mesh;
    appendBox(mesh, innerLower, innerLower + Vector3(1, 1, 1), innerInwards);
    appendBox(mesh, {0, 0, 0}, {3, 3, 3}, outerInwards);
    return mesh;
  };
  const Components cavity = split(nested(false, true));
  ASSERT_TRUE(cavity.list[0].fault);
  EXPECT_EQ(cavity.list[0].fault->kind, FaultKind::InsideOut);
  EXPECT_THAT(cavity.list[0].fault->message, HasSubstr("component 2"));
  EXPECT_FALSE(cavity.list[1].fault);
  for (const auto& mesh :
       {nested(false, false), nested(true, true), nested(true, false), nested(false, true, {4, 1, 1})})
    expectSound(split(mesh), mesh, 2);
}

TEST(SolidsFaults, InTheBoxOfAnotherSolidIsNotInsideIt) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {0, 0, 9}};
  for (const Corners& t : {Corners{0, 2, 1}, Corners{0, 1, 3}, Corners{0, 3, 2}, Corners{1, 2, 3}})
    appendTriangle(mesh, t);
  appendBox(mesh, {6, 6, 6}, {7, 7, 7}, true);
  expectSound(split(mesh), mesh, 2);
}

} // namespace
} // namespace chamfer
