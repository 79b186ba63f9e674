// Faults that exporters leave in solids which are convex all the same, over generated families and in every
// format: vertices on edges (T-junctions), faces and solids given twice, warped polygons. The rounding is
// judged by the brute-force oracle.
#include "tests/oracle/convex_families.h"
#include "tests/oracle/ray_samples.h"
#include "tests/preprocess/mesh_files.h"
#include "tests/preprocess/polygon_solid.h"
#include "tests/preprocess/rounding_subject.h"
#include "tests/preprocess/surface_check.h"

#include <gmock/gmock.h>

namespace chamfer {
namespace {

using oracle::ConvexSolid;
using testing::HasSubstr;

const std::filesystem::path kReports = CHAMFER_SOURCE_DIR "/../shared/data/reports";

std::vector<ConvexSolid> families() {
  std::vector<ConvexSolid> solids{oracle::box(4, 2, 1),        oracle::prism(5, 1.5),
                                  oracle::dodecahedron(),      oracle::octahedron(),
                                  oracle::wedge(25),           oracle::frustum(7, 0.4, 1),
                                  oracle::hullOnSphere(20, 3), oracle::voronoiCell(30, 8)};
  std::vector<ConvexSolid> turned;
  for (std::size_t i = 0; i < solids.size(); ++i)
    turned.push_back(oracle::placed(solids[i], 1 + double(i), 2, i + 1));
  solids.insert(solids.end(), turned.begin(), turned.end());
  return solids;
}

class MendedSolids : public MeshFiles {
protected:
  /// The file must give the solid's own rounding; warnings of the result.
  std::vector<std::string> expectRounded(const ConvexSolid& solid, const std::string& format,
                                         const std::string& text, std::size_t rays = 60) {
    SCOPED_TRACE(solid.name + "." + format);
    std::vector<std::string> warnings;
    try {
      const TriangleMesh mesh = read("mesh." + format, text);
      const Components components = splitComponents(mesh, {});
      EXPECT_EQ(partitionDefect(components, mesh), "");
      for (const Component& c : components.list) {
        EXPECT_FALSE(c.fault) << c.fault->message;
        if (!c.fault) {
          EXPECT_EQ(surfaceDefect(c, mesh), "");
        }
      }
      PreprocessOptions options;
      options.radius.value = 0.3 * double(inball(solid).radius);
      options.threads = 1;
      const RoundedSubject subject(mesh, options, {solid});
      EXPECT_EQ(subject.report().solids, 1u);
      EXPECT_EQ(subject.report().facets, solid.faces.size());
      EXPECT_LE(subject.report().nonConvexity, 1e-6);
      const auto& facets = subject.view().facetOfTriangle;
      EXPECT_EQ(std::count(facets.begin(), facets.end(), kNone), 0);
      const auto truth = std::make_shared<oracle::RoundedOracle>(solid, options.radius.value);
      oracle::RaySampler sampler(solid, *truth, 7);
      oracle::Tolerances tolerances;
      tolerances.noise = 4e-7; // vertices within the weld tolerance of an edge
      const auto report = compare(subject.firstEnd(), oracle::UnionOracle(truth),
                                  sampler.mixed(oracle::rayBudget(rays)), tolerances);
      EXPECT_TRUE(report.agrees()) << report.complaint();
      warnings = subject.report().warnings;
    } catch (const Error& error) {
      ADD_FAILURE() << error.what();
    }
    return warnings;
  }

  oracle::Random random_{1};
};

constexpr const char* kFormats[] = {"obj", "off", "ply", "stl"};

TEST_F(MendedSolids, VerticesOnEdgesCloseNothingAndOpenNothing) {
  for (const ConvexSolid& solid : families())
    for (const double chance : {0.15, 1.0}) {
      PolygonSolid polygons(solid);
      polygons.insertEdgeVertices(chance, random_);
      polygons.beginFacesAnywhere(random_);
      for (const char* format : kFormats)
        expectRounded(solid, format, polygons.text(format));
    }
}

TEST_F(MendedSolids, VerticesThatSinglePrecisionMovesOffTheirEdges) {
  const auto rounded = [](std::vector<Eigen::Vector3d>& vertices) {
    for (auto& v : vertices)
      v = v.cast<float>().cast<double>().eval();
  };
  std::uint64_t seed = 20;
  for (const ConvexSolid& family : families()) {
    ConvexSolid solid = oracle::placed(family, 1, 0, ++seed);
    const Eigen::Vector3d middle = solid.centroid();
    for (auto& v : solid.vertices)
      v -= middle;
    rounded(solid.vertices);
    PolygonSolid polygons(solid);
    polygons.insertEdgeVertices(0.5, random_);
    rounded(polygons.vertices);
    for (const char* format : kFormats)
      expectRounded(solid, format, polygons.text(format));
  }
}

TEST_F(MendedSolids, VerticesOnEdgesOfFacesThatAreGivenTwice) {
  for (const ConvexSolid& solid : {oracle::box(4, 2, 1), oracle::prism(6, 1)})
    for (const bool otherSide : {false, true}) {
      PolygonSolid polygons(solid);
      polygons.insertEdgeVertices(0.3, random_);
      polygons.repeatFaces(false, otherSide, false, random_);
      for (const char* format : {"obj", "off", "ply"})
        expectRounded(solid, format, polygons.text(format));
    }
}

TEST_F(MendedSolids, FacesThatAreGivenTwiceAreDroppedWithAWarning) {
  for (const ConvexSolid& solid : families())
    for (const bool all : {false, true})
      for (const bool otherSide : {false, true})
        for (const bool ownVertices : {false, true}) {
          PolygonSolid polygons(solid);
          polygons.repeatFaces(all, otherSide, ownVertices, random_);
          SCOPED_TRACE(testing::Message()
                       << "all " << all << " other side " << otherSide << " own " << ownVertices);
          for (const char* format : kFormats) {
            const auto warnings = expectRounded(solid, format, polygons.text(format), 20);
            EXPECT_THAT(warnings, testing::Contains(testing::AnyOf(HasSubstr("faces are given twice"),
                                                                   HasSubstr("there a second time"))));
          }
        }
}

TEST_F(MendedSolids, ThreeCopiesAreOneSolid) {
  const ConvexSolid solid = oracle::placed(oracle::box(1, 2, 3), 1, 1, 5);
  for (const bool ownVertices : {false, true}) {
    PolygonSolid polygons(solid);
    const auto once = polygons.faces;
    polygons.repeatFaces(true, true, ownVertices, random_);
    for (const auto& loop : once)
      polygons.faces.push_back(loop);
    for (const char* format : kFormats)
      expectRounded(solid, format, polygons.text(format));
  }
}

TEST_F(MendedSolids, WarpedPolygonsTakeTheirConvexTriangulation) {
  std::size_t warped = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed)
    for (const std::size_t most : {4u, 5u, 7u}) {
      const ConvexSolid solid = oracle::hullOnSphere(14 + 3 * unsigned(seed), seed);
      PolygonSolid polygons(solid);
      polygons.joinFaces(most, random_);
      if (seed % 2) // whichever way the file's faces look
        for (auto& loop : polygons.faces)
          std::reverse(loop.begin(), loop.end());
      for (int listing = 0; listing < 2; ++listing) {
        polygons.beginFacesAnywhere(random_);
        for (const char* format : {"obj", "off", "ply"}) {
          const auto warnings = expectRounded(solid, format, polygons.text(format), 30);
          if (polygons.faces.size() == solid.faces.size()) continue;
          ++warped;
          EXPECT_THAT(warnings, testing::Contains(HasSubstr("warped: its corners lie up to")));
        }
      }
    }
  EXPECT_GT(warped, 100u);
}

TEST_F(MendedSolids, TextureCoordinatesStayAtTheirCorners) {
  const TriangleMesh mesh =
      read("quad.obj", "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 4 4 0\nv 0 0 2\nv 4 0 2\nv 0 4 2\nv 4 4 1.92\n"
                       "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1 3 4 2\nf 5/1 6/2 8/3 7/4\n"
                       "f 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n");
  std::size_t seen = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t uv = mesh.uvTriangles[t][k];
      if (uv == kNone) continue;
      const Point3& p = mesh.positions[mesh.triangles[t][k]];
      EXPECT_EQ(mesh.uvs[uv], (std::array{float(p.x / 4), float(p.y / 4)}));
      ++seen;
    }
  EXPECT_EQ(seen, 6u);
}

TEST_F(MendedSolids, ARefusalNamesTheWarp) {
  // A notch in one side refuses the solid; its warped top keeps the file's fan and is named where it is the
  // deepest.
  const std::string text =
      "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 4 4 0\nv 0 0 2\nv 4 0 2\nv 0 4 2\nv 4 4 1.5\nv 2 0.1 1\n"
      "f 1 3 4 2\nf 5 6 8 7\nf 1 2 9\nf 2 6 9\nf 6 5 9\nf 5 1 9\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  try {
    PreprocessOptions options;
    options.radius = parseRadius("2%");
    preprocess(read("notch.obj", text), options);
    FAIL() << "was rounded";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("face 2 (line 11), which is warped: its 4 corners lie up to 0.12"));
  }
}

TEST_F(MendedSolids, WhatOnlyLooksLikeThemIsRefused) {
  const ConvexSolid solid = oracle::box(4, 2, 1);
  // A vertex off the edge by more than the tolerance: a slit.
  PolygonSolid slit(solid);
  slit.vertices.push_back(0.5 * (slit.vertices[slit.faces[0][0]] + slit.vertices[slit.faces[0][1]]) +
                          Eigen::Vector3d(1e-3, 1e-3, 1e-3));
  slit.faces[0].insert(slit.faces[0].begin() + 1, std::uint32_t(slit.vertices.size() - 1));
  // A hole beside a vertex on an edge.
  PolygonSolid hole(solid);
  hole.insertEdgeVertices(1, random_);
  hole.faces.pop_back();
  // A wall through the solid, and the same wall twice.
  PolygonSolid wall(solid);
  const auto& f = wall.faces[0];
  const auto opposite = std::find_if(wall.faces.begin(), wall.faces.end(), [&](const auto& loop) {
    return std::none_of(loop.begin(), loop.end(),
                        [&](auto v) { return std::count(f.begin(), f.end(), v) > 0; });
  });
  ASSERT_NE(opposite, wall.faces.end());
  const auto below = [&](std::uint32_t v) { // the neighbour on the opposite face
    return *std::min_element(opposite->begin(), opposite->end(), [&](auto a, auto b) {
      return (wall.vertices[a] - wall.vertices[v]).norm() < (wall.vertices[b] - wall.vertices[v]).norm();
    });
  };
  wall.faces.push_back({f[0], f[2], below(f[2]), below(f[0])});
  PolygonSolid walls = wall;
  walls.faces.push_back(walls.faces.back());
  for (const PolygonSolid* polygons : {&slit, &hole, &wall, &walls})
    for (const char* format : kFormats) {
      PreprocessOptions options;
      options.radius = parseRadius("2%");
      try {
        preprocess(read(std::string("mesh.") + format, polygons->text(format)), options);
        ADD_FAILURE() << format << " was rounded";
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::NotConvexSolid) << error.what();
      }
    }
}

TEST(ReportedMeshes, AreRoundedAsTheirReadmeSays) {
  if (!std::filesystem::exists(kReports)) GTEST_SKIP() << "the reports are not beside the project";
  const auto rounded = [](const char* file, const char* radius) {
    PreprocessOptions options;
    options.radius = parseRadius(radius);
    return preprocess(readMesh(kReports / file), options).report;
  };
  for (const char* file : {"t-junction/box.obj", "t-junction/box.stl", "t-junction/box-turned.stl"}) {
    const PreprocessReport report = rounded(file, "0.05");
    EXPECT_EQ(report.facets, 6u) << file;
    EXPECT_EQ(report.roundedEdges, 12u) << file;
    EXPECT_EQ(report.spheres, 8u) << file;
  }
  for (const char* file : {"one-face-twice.obj", "same-side.obj", "two-sided.obj",
                           "two-sided-own-vertices.obj", "two-sided.stl"}) {
    const PreprocessReport report = rounded((std::string("doubled-faces/") + file).c_str(), "2%");
    EXPECT_EQ(report.solids, 1u) << file;
    EXPECT_EQ(report.counts.duplicateTriangles, std::string(file) == "one-face-twice.obj" ? 2u : 12u) << file;
    EXPECT_EQ(report.warnings.size(), 1u) << file;
  }
  const PreprocessReport one = rounded("warped-quad/quad-listed-the-convex-way.obj", "2%"),
                         other = rounded("warped-quad/quad-listed-the-concave-way.obj", "2%");
  EXPECT_EQ(one.facets, 7u);
  EXPECT_EQ(other.facets, 7u);
  EXPECT_EQ(one.maxRadius, other.maxRadius);
  EXPECT_EQ(one.warnings, other.warnings);
  ASSERT_EQ(one.warnings.size(), 1u);
  EXPECT_THAT(one.warnings[0],
              HasSubstr("face 2 (line 10) is warped: its corners lie up to 0.02 off one plane"));
  EXPECT_NO_THROW(rounded("warped-quad/triangles-convex.obj", "2%"));
  EXPECT_THROW(rounded("warped-quad/triangles-concave.obj", "2%"), Error);
}

} // namespace
} // namespace chamfer
