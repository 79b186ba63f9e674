#include "tests/preprocess/mesh_makers.h"

#include <gmock/gmock.h>

namespace chamfer {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

TEST(Solids, ClosedByIndexStaysAsItIs) {
  const TriangleMesh mesh = box();
  const Components components = split(mesh);
  expectSound(components, mesh, 1);
  EXPECT_EQ(components.list[0].positions,
            (std::vector<Point3>{
                {0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}));
  EXPECT_FALSE(components.list[0].turned);
  EXPECT_EQ(components.counts.weldedVertices, 0u);
  EXPECT_EQ(components.counts.unusedVertices, 0u);
}

TEST(Solids, InsideOutIsTurnedAndCounted) {
  const TriangleMesh mesh = box(true);
  const Components components = split(mesh);
  expectSound(components, mesh, 1);
  EXPECT_TRUE(components.list[0].turned);
  EXPECT_EQ(components.counts.turned, 1u);
  EXPECT_THAT(components.warnings, IsEmpty());
}

TEST(Solids, MixedOrientationIsTurnedWithAWarning) {
  for (const std::uint32_t flips : {0x1u, 0x813u, 0xffeu}) { // which triangles of the file face the other way
    TriangleMesh mesh = box();
    for (std::uint32_t t = 0; t < 12; ++t)
      if (flips >> t & 1) std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
    const Components components = split(mesh);
    expectSound(components, mesh, 1);
    EXPECT_FALSE(components.list[0].turned);
    EXPECT_EQ(components.counts.turnedTriangles, std::size_t(__builtin_popcount(flips)));
    EXPECT_THAT(components.warnings,
                ElementsAre(HasSubstr(std::to_string(__builtin_popcount(flips)) + " triangles")));
  }
}

TEST(Solids, UnusedVerticesChangeNothing) {
  TriangleMesh mesh = unwelded(box(), false, 3e-8);
  mesh.positions.push_back({1e9, 0, 0}); // were it counted, its tolerance would weld the box into a point
  const Components components = split(mesh);
  expectSound(components, mesh, 1);
  EXPECT_EQ(components.counts.unusedVertices, 1u);
  EXPECT_EQ(components.list[0].positions.size(), 8u);
}

TEST(Solids, OwnVerticesOfEveryFaceAreWelded) {
  for (const bool soup : {false, true}) {
    const TriangleMesh mesh = unwelded(box(), soup);
    const Components components = split(mesh);
    expectSound(components, mesh, 1);
    EXPECT_EQ(components.list[0].positions.size(), 8u);
    EXPECT_EQ(components.counts.weldedVertices, 36u - 8u);
  }
}

TEST(Solids, WeldingToleranceIsRelativeToTheSolid) {
  for (const double size : {1e-6, 1.0, 1e6}) {
    TriangleMesh mesh = unwelded(box(), true, 3e-8);
    for (Point3& p : mesh.positions)
      p = {p.x * size, p.y * size, p.z * size};
    expectSound(split(mesh), mesh, 1);
  }
  // Noise above the tolerance leaves edges open, and a larger tolerance closes them.
  const TriangleMesh mesh = unwelded(box(), true, 1e-4);
  const Components open = split(mesh);
  EXPECT_TRUE(std::any_of(open.list.begin(), open.list.end(),
                          [](const Component& c) { return c.fault.has_value(); }));
  InputTolerances wide;
  wide.weld = 1e-3;
  const Components closed = splitComponents(mesh, wide);
  ASSERT_THAT(closed.list, SizeIs(1));
  EXPECT_FALSE(closed.list[0].fault);
}

TEST(Solids, TouchingSolidsOfTheirOwnIndicesStayApart) {
  TriangleMesh mesh;
  appendBox(mesh, {0, 0, 0}, {1, 1, 1});
  appendBox(mesh, {1, 0, 0}, {2, 1, 1});        // at a face
  appendBox(mesh, {1, 1, 0}, {2, 2, 1});        // along an edge with the first
  appendBox(mesh, {0, 0, 1 + 1e-9}, {1, 1, 2}); // nearer than the welding tolerance
  const Components components = split(mesh);
  expectSound(components, mesh, 4);
  EXPECT_EQ(components.counts.weldedVertices, 0u);
}

TEST(Solids, AnOpenOneIsNotWeldedToAClosedOne) {
  TriangleMesh mesh = box();
  TriangleMesh other;
  appendBox(other, {1, 0, 0}, {2, 1, 1});
  other = unwelded(other, false);
  const auto base = std::uint32_t(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  for (const Corners& t : other.triangles)
    appendTriangle(mesh, {base + t[0], base + t[1], base + t[2]});
  expectSound(split(mesh), mesh, 2);
}

TEST(Solids, TouchingSolidsInASoupComeApart) {
  for (const bool inwards : {false, true}) {
    TriangleMesh mesh;
    for (const Point3& p : {Point3(0, 0, 0), Point3(1, 0, 0), Point3(1, 1, 0), Point3(2, 2, 0),
                            Point3(1, 0, 1), Point3(0, 0, 1), Point3(0, 1, 1), Point3(1, 1, 1)})
      appendBox(mesh, p, p + Vector3(1, 1, 1), inwards);
    const TriangleMesh soup = unwelded(mesh, true);
    const Components components = split(soup);
    expectSound(components, soup, 8);
    EXPECT_EQ(components.counts.turned, inwards ? 8u : 0u);
  }
}

TEST(Solids, TouchingSolidsWithoutSharedTrianglesComeApart) {
  // Wedges around one axis: at the axis all of their edges coincide, and their faces pairwise.
  TriangleMesh mesh;
  constexpr int kWedges = 7;
  const auto rim = [](int i, double z) {
    const double angle = 2 * 3.14159265358979 * i / kWedges;
    return Point3(std::cos(angle), std::sin(angle), z);
  };
  for (int i = 0; i < kWedges; ++i) {
    const auto base = std::uint32_t(mesh.positions.size());
    for (const double z : {0.0, 1.0})
      for (const Point3& p : {Point3(0, 0, z), rim(i, z), rim((i + 1) % kWedges, z)})
        mesh.positions.push_back(p);
    for (const Corners& t : {Corners{0, 2, 1}, Corners{3, 4, 5}, Corners{0, 1, 4}, Corners{0, 4, 3},
                             Corners{1, 2, 5}, Corners{1, 5, 4}, Corners{2, 0, 3}, Corners{2, 3, 5}})
      appendTriangle(mesh, {base + t[0], base + t[1], base + t[2]});
  }
  const TriangleMesh soup = unwelded(mesh, true);
  expectSound(split(soup), soup, kWedges);
}

TEST(Solids, SheetsThatShareOneVertexComeApart) {
  TriangleMesh mesh;
  appendBox(mesh, {0, 0, 0}, {1, 1, 1});
  appendBox(mesh, {1, 1, 1}, {2, 2, 2});
  for (Corners& t : mesh.triangles)
    for (std::uint32_t& v : t)
      v = v == 8 ? 7 : v;
  expectSound(split(mesh), mesh, 2);
}

TEST(Solids, TrianglesThatNameAVertexTwiceAreDropped) {
  for (const bool weld : {false, true}) {
    TriangleMesh mesh = box();
    appendTriangle(mesh, {0, 0, 1});
    appendTriangle(mesh, {2, 3, 2});
    if (weld) mesh = unwelded(mesh, true);
    const Components components = split(mesh);
    expectSound(components, mesh, 1);
    EXPECT_EQ(components.counts.degenerateTriangles, 2u);
    EXPECT_THAT(components.list[0].degenerate, ElementsAre(12, 13));
  }
}

TEST(Solids, ATriangleWithoutAreaThatClosesTheSurfaceStays) {
  // Edge 0-1 of the box gets a vertex in the middle, which only one of its two triangles knows; a cap fills
  // the gap.
  TriangleMesh mesh = box();
  mesh.positions.push_back({0.5, 0, 0});
  const std::uint32_t middle = 8;
  for (std::size_t t = 0; t < 12; ++t) {
    Corners& c = mesh.triangles[t];
    for (std::size_t k = 0; k < 3; ++k)
      if (c[k] == 0 && c[(k + 1) % 3] == 1) {
        const std::uint32_t third = c[(k + 2) % 3];
        c = {0, middle, third};
        appendTriangle(mesh, {middle, 1, third});
        appendTriangle(mesh, {0, 1, middle});
        t = 12;
        break;
      }
  }
  ASSERT_EQ(mesh.triangles.size(), 14u);
  for (const bool soup : {false, true}) {
    const TriangleMesh tested = soup ? unwelded(mesh, true) : mesh;
    expectSound(split(tested), tested, 1);
  }
}

TEST(Solids, DuplicatesOfBrokenSurfacesAreDropped) {
  TriangleMesh mesh = box();
  const std::vector<Corners> again(mesh.triangles.begin() + 3, mesh.triangles.begin() + 6);
  for (const Corners& t : again)
    appendTriangle(mesh, {t[1], t[2], t[0]});
  const Components components = split(mesh);
  expectSound(components, mesh, 1);
  EXPECT_EQ(components.counts.duplicateTriangles, 3u);
  EXPECT_EQ(components.list[0].duplicates,
            (std::vector<std::array<std::uint32_t, 2>>{{12, 3}, {13, 4}, {14, 5}}));
}

TEST(Solids, PolygonsWithCornersOnTheirEdgesKeepTheirDiagonals) {
  // Both faces at an edge with a vertex in its middle draw a diagonal along the whole edge when they are
  // fanned from one of its ends: four triangles between two vertices, and yet a manifold.
  TriangleMesh mesh;
  for (const Point3& p :
       {Point3(0, 0, 0), Point3(1, 0, 0), Point3(2, 0, 0), Point3(1, 2, 0), Point3(1, 1, 2)})
    mesh.positions.push_back(p);
  const std::vector<std::vector<std::uint32_t>> polygons{{0, 3, 2, 1}, {0, 1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  for (std::uint32_t f = 0; f < polygons.size(); ++f)
    for (std::size_t i = 2; i < polygons[f].size(); ++i) {
      mesh.triangles.push_back({polygons[f][0], polygons[f][i - 1], polygons[f][i]});
      mesh.faceOfTriangle.push_back(f);
    }
  expectSound(split(mesh), mesh, 1);
}

TEST(Solids, ComponentsAreInTheFilesOrderWithAnyNumberOfThreads) {
  TriangleMesh mesh;
  for (int i = 0; i < 500; ++i) {
    const Point3 p(i % 10, i / 10 % 10, i / 100);
    TriangleMesh one;
    appendBox(one, p, p + Vector3(1, 1, 1), i % 7 == 0);
    if (i % 3 == 0) one = unwelded(one, false);
    if (i % 11 == 0) one.triangles.pop_back();
    const auto base = std::uint32_t(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), one.positions.begin(), one.positions.end());
    for (const Corners& t : one.triangles)
      appendTriangle(mesh, {base + t[0], base + t[1], base + t[2]});
  }
  const Components one = splitComponents(mesh, {}, 1), two = splitComponents(mesh, {}, 2);
  EXPECT_EQ(partitionDefect(one, mesh), "");
  ASSERT_EQ(one.list.size(), two.list.size());
  for (std::size_t i = 0; i < one.list.size(); ++i) {
    EXPECT_EQ(one.list[i].positions, two.list[i].positions);
    EXPECT_EQ(one.list[i].triangles, two.list[i].triangles);
    EXPECT_EQ(one.list[i].opposite, two.list[i].opposite);
    EXPECT_EQ(one.list[i].meshTriangle, two.list[i].meshTriangle);
    EXPECT_EQ(one.list[i].fault.has_value(), two.list[i].fault.has_value());
  }
}

TEST(Solids, NothingIsNothing) {
  EXPECT_THAT(split({}).list, IsEmpty());
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}};
  appendTriangle(mesh, {0, 1, 0});
  const Components components = split(mesh);
  EXPECT_THAT(components.list, IsEmpty());
  EXPECT_EQ(components.counts.degenerateTriangles, 1u);
}

/// Random triangles over few places: every kind of crowded edge, repeated triangle and shared vertex, in any
/// mixture.
TEST(Solids, RandomTrianglesGiveAPartitionAndOnlySoundSurfaces) {
  std::mt19937 random(1);
  std::size_t sound = 0;
  for (int round = 0; round < 20000; ++round) {
    TriangleMesh mesh;
    mesh.soup = round % 3 == 0;
    const std::size_t places = 3 + random() % 6, count = 1 + random() % 20;
    const auto coordinate = [&] {
      return double(random() % 3) + (round % 2 ? 0 : 1e-8 * double(random() % 5));
    };
    for (std::size_t i = 0; i < places; ++i)
      mesh.positions.push_back({coordinate(), coordinate(), coordinate()});
    for (std::size_t i = 0; i < count; ++i)
      appendTriangle(mesh, {std::uint32_t(random() % places), std::uint32_t(random() % places),
                            std::uint32_t(random() % places)});
    if (round % 5 == 0) mesh = unwelded(mesh, mesh.soup);
    const Components components = split(mesh);
    ASSERT_EQ(partitionDefect(components, mesh), "") << round;
    for (const Component& c : components.list) {
      if (c.fault) {
        ASSERT_FALSE(c.fault->message.empty());
        ASSERT_TRUE(isFinite(c.fault->place));
        continue;
      }
      ++sound;
      ASSERT_EQ(surfaceDefect(c, mesh), "") << round;
    }
  }
  EXPECT_GT(sound, 100u); // the rounds do reach what they are to test
}

} // namespace
} // namespace chamfer
