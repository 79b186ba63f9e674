// The real program on good input: reports, files, options.
#include "common/sidecar.h"
#include "tests/oracle/convex_families.h"
#include "tests/oracle/rounded_oracle.h"
#include "tests/preprocess/chamferprep_fixture.h"
#include "tests/preprocess/mesh_makers.h"
#include "tests/support/mesh_of.h"

#include <bit>
#include <cstring>

namespace chamfer {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Box whose top's centre is pushed in by a tenth of its height.
TriangleMesh dentedBox() {
  TriangleMesh mesh = box();
  std::erase_if(mesh.triangles, [&](const Corners& t) {
    return mesh.positions[t[0]].z == 1 && mesh.positions[t[1]].z == 1 && mesh.positions[t[2]].z == 1;
  });
  mesh.positions.push_back({0.5, 0.5, 0.9});
  const std::uint32_t rim[] = {4, 5, 7, 6};
  for (std::size_t k = 0; k < 4; ++k)
    mesh.triangles.push_back({8, rim[k], rim[(k + 1) % 4]});
  return mesh;
}

std::string binaryStl(const TriangleMesh& mesh) {
  static_assert(std::endian::native == std::endian::little);
  std::string bytes(80, ' ');
  const auto put = [&](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  put(std::uint32_t(mesh.triangles.size()));
  for (const Corners& t : mesh.triangles) {
    put(Float3{}); // a normal of zero: readers compute their own
    for (const std::uint32_t v : t)
      put(toFloat3(mesh.positions[v]));
    put(std::uint16_t(0));
  }
  return bytes;
}

TEST_F(Chamferprep, ReportsTheCube) {
  const std::string mesh = cube();
  const auto r = run({mesh, "--radius", "0.1"});
  EXPECT_EQ(r.status, 0);
  EXPECT_EQ(r.err, "");
  EXPECT_THAT(r.out, HasSubstr("1 solids, 6 facets, 12 rounded edges, 8 spheres"));
  EXPECT_THAT(r.out, HasSubstr(mesh + ".chamfer: "));
  EXPECT_THAT(names(), ElementsAre("cube.obj", "cube.obj.chamfer"));
  const Digest digest = geometryDigest(readMesh(mesh));
  const auto rounding = readSidecar(mesh + ".chamfer", &digest);
  EXPECT_EQ(rounding->view().spheres.size(), 8u);
  EXPECT_EQ(rounding->view().solids[0].radius, 0.1f);
}

TEST_F(Chamferprep, ReportsTheCubeAsJson) {
  const std::string mesh = cube();
  const auto json = report({mesh, "--radius", "0.1"});
  EXPECT_EQ(json.at("solids"), 1);
  EXPECT_EQ(json.at("facets"), 6);
  EXPECT_EQ(json.at("rounded_edges"), 12);
  EXPECT_EQ(json.at("spheres"), 8);
  EXPECT_EQ(json.at("corners_over_3"), 0);
  EXPECT_NEAR(json.at("max_radius").get<double>(), 0.5, 1e-12);
  EXPECT_EQ(json.at("sidecar_bytes"), std::filesystem::file_size(mesh + ".chamfer"));
  EXPECT_GT(json.at("seconds").get<double>(), 0);
  EXPECT_LT(json.at("seconds").get<double>(), 10);
}

TEST_F(Chamferprep, ReportsCornersOfMoreThanThreeFacets) {
  const auto octahedron = write("o.obj", contentOf(CHAMFER_SOURCE_DIR "/data/solids/octahedron.obj"));
  const auto json = report({octahedron.string(), "--radius", "1%"});
  EXPECT_EQ(json.at("facets"), 8);
  EXPECT_EQ(json.at("corners_over_3"), 6);
}

TEST_F(Chamferprep, TwoMeshesGiveAnArrayInTheirOrder) {
  const std::string a = cube("a.obj"), b = write("b.obj", objText(box())).string();
  const auto json = report({b, a, "-r", "2%"});
  ASSERT_EQ(json.size(), 2u);
  EXPECT_EQ(json[0].at("mesh"), b);
  EXPECT_EQ(json[1].at("mesh"), a);
  EXPECT_EQ(json[0].at("spheres"), 8);
  EXPECT_THAT(names(), ElementsAre("a.obj", "a.obj.chamfer", "b.obj", "b.obj.chamfer"));
}

TEST_F(Chamferprep, WritesWhereItIsTold) {
  const std::string mesh = cube();
  std::filesystem::create_directory(folder_ / "out");
  EXPECT_EQ(report({mesh, "-r", "0.1", "-o", in("named")}).at("sidecar"), in("named"));
  EXPECT_EQ(report({mesh, "-r", "0.1", "-o", in("out")}).at("sidecar"), in("out/cube.obj.chamfer"));
  EXPECT_THAT(names(), ElementsAre("cube.obj", "named", "out", "out/cube.obj.chamfer"));
  EXPECT_EQ(contentOf(in("named")), contentOf(in("out/cube.obj.chamfer")));
}

TEST_F(Chamferprep, DryRunAndQuietWriteAndSayNothing) {
  const std::string mesh = cube();
  const auto json = report({mesh, "-r", "0.1", "--dry-run", "--mesh", in("rounded.obj")});
  EXPECT_EQ(json.at("spheres"), 8);
  EXPECT_TRUE(json.at("sidecar").is_null());
  EXPECT_GT(json.at("explicit_triangles"), 12);
  EXPECT_THAT(names(), ElementsAre("cube.obj"));
  const auto quiet = run({mesh, "-r", "0.1", "--quiet"});
  EXPECT_EQ(quiet.status, 0);
  EXPECT_EQ(quiet.out + quiet.err, "");
  EXPECT_EQ(json.at("sidecar_bytes"), std::filesystem::file_size(mesh + ".chamfer"));
}

TEST_F(Chamferprep, WritesTheSameBytesWithAnyThreads) {
  const auto solids = oracle::familyCatalogue();
  const std::string mesh = write("many.obj", objText(meshOf(solids))).string();
  std::vector<std::string> sidecars;
  for (const char* threads : {"1", "1", "2", "0"}) {
    EXPECT_EQ(report({mesh, "-r", "1%", "--clamp", "0.9", "-j", threads}).at("solids"), solids.size());
    sidecars.push_back(contentOf(mesh + ".chamfer"));
    EXPECT_EQ(sidecars.back(), sidecars.front()) << "-j " << threads;
  }
}

TEST_F(Chamferprep, KeepsNonConvexComponentsSharpOrRoundsTheirHulls) {
  TriangleMesh dented = dentedBox();
  appendBox(dented, {3, 0, 0}, {4, 1, 1});
  const std::string mesh = write("two.obj", objText(dented)).string();
  const auto sharp = report({mesh, "-r", "0.1", "--on-nonconvex", "sharp"});
  EXPECT_EQ(sharp.at("solids"), 1);
  EXPECT_EQ(sharp.at("sharp_components"), 1);
  EXPECT_THAT(sharp.at("warnings").dump(), HasSubstr("component 1 stays sharp (concave)"));
  const auto rounding = readSidecar(mesh + ".chamfer");
  const auto facetOfTriangle = rounding->view().facetOfTriangle;
  ASSERT_EQ(facetOfTriangle.size(), dented.triangles.size());
  EXPECT_EQ(std::count(facetOfTriangle.begin(), facetOfTriangle.end(), kNone), 14);

  const auto hull = report({mesh, "-r", "0.1", "--on-nonconvex", "hull"});
  EXPECT_EQ(hull.at("solids"), 2);
  EXPECT_EQ(hull.at("hulled_components"), 1);
  EXPECT_EQ(hull.at("sharp_components"), 0);
  EXPECT_EQ(hull.at("facets"), 12);
}

TEST_F(Chamferprep, ClampsTheRadiusToAShareOfTheInradius) {
  const std::string mesh = cube();
  EXPECT_EQ(report({mesh, "-r", "2", "--clamp", "0.5"}).at("clamped_solids"), 1);
  EXPECT_FLOAT_EQ(readSidecar(mesh + ".chamfer")->view().solids[0].radius, 0.25f);
  EXPECT_EQ(report({mesh, "-r", "0.2", "--clamp", "0.5"}).at("clamped_solids"), 0);
  EXPECT_FLOAT_EQ(readSidecar(mesh + ".chamfer")->view().solids[0].radius, 0.2f);
}

TEST_F(Chamferprep, WritesTheSameBytesWithAnyNumberOfThreads) {
  const std::filesystem::path reports = CHAMFER_SOURCE_DIR "/../shared/data/reports/repeatable";
  if (!std::filesystem::is_directory(reports)) GTEST_SKIP() << "the reports are not beside the project";
  for (const char* name : {"part.obj", "tray.obj"}) {
    const std::string mesh = write(name, contentOf(reports / name)).string();
    std::vector<std::string> sidecars, meshes;
    for (const char* threads : {"1", "2", "1", "7", "0"}) {
      EXPECT_GT(report({mesh, "-r", "2%", "-j", threads, "--mesh", in("out.obj")}).at("solids"), 0);
      sidecars.push_back(contentOf(mesh + ".chamfer"));
      meshes.push_back(contentOf(in("out.obj")));
      EXPECT_EQ(sidecars.back(), sidecars.front()) << name << " -j " << threads;
      EXPECT_EQ(meshes.back(), meshes.front()) << name << " -j " << threads;
    }
    EXPECT_FALSE(meshes.front().empty());
  }
}

TEST_F(Chamferprep, WritesAClosedExplicitMesh) {
  const std::string mesh = cube();
  const auto json = report({mesh, "-r", "0.1", "--mesh", in("out.obj"), "--segments", "4"});
  EXPECT_THAT(names(), ElementsAre("cube.obj", "cube.obj.chamfer", "out.obj"));
  const TriangleMesh rounded = readMesh(in("out.obj"));
  EXPECT_EQ(rounded.triangles.size(), json.at("explicit_triangles"));
  expectSound(split(rounded), rounded, 1);
  double volume = 0;
  Bounds3 bounds;
  for (const Corners& t : rounded.triangles) {
    const Vector3 a(rounded.positions[t[0]]), b(rounded.positions[t[1]]), c(rounded.positions[t[2]]);
    volume += dot(a, cross(b, c)) / 6;
    bounds.extend(rounded.positions[t[0]]);
  }
  const double exact = double(oracle::RoundedOracle(oracle::cube(), 0.1).volume());
  EXPECT_LT(volume, exact);
  EXPECT_GT(volume, 0.99 * exact);
  EXPECT_NEAR(bounds.diagonal(), std::sqrt(3.0), 1e-6);
}

TEST_F(Chamferprep, ReadsCarriageReturnsAndNegativeIndices) {
  const std::string text = contentOf(cube());
  std::string crlf, relative;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    crlf += line + "\r\n";
    if (!line.starts_with("f ")) {
      relative += line + '\n';
      continue;
    }
    std::istringstream corners(line.substr(2));
    relative += 'f';
    for (int v; corners >> v;)
      relative += ' ' + std::to_string(v - 9); // the eighth vertex is -1
    relative += '\n';
  }
  report({cube(), "-r", "0.1"});
  const std::string expected = contentOf(in("cube.obj.chamfer"));
  report({write("crlf.obj", crlf).string(), "-r", "0.1"});
  EXPECT_EQ(contentOf(in("crlf.obj.chamfer")), expected);
  report({write("relative.OBJ", relative).string(), "-r", "0.1"});
  EXPECT_EQ(contentOf(in("relative.OBJ.chamfer")), expected);
}

TEST_F(Chamferprep, ReadsABinaryStl) {
  const auto json = report({write("cube.stl", binaryStl(box())).string(), "-r", "0.1"});
  EXPECT_EQ(json.at("facets"), 6);
  EXPECT_EQ(json.at("rounded_edges"), 12);
  EXPECT_EQ(json.at("spheres"), 8);
  EXPECT_EQ(json.at("welded_vertices"), 36 - 8);
}

TEST_F(Chamferprep, TurnsWhatIsInsideOutAndSaysSo) {
  const std::string mesh = write("in.obj", objText(box(true))).string();
  EXPECT_EQ(report({mesh, "-r", "0.1"}).at("turned_components"), 1);
  EXPECT_THAT(run({mesh, "-r", "0.1"}).out, HasSubstr("turned 1 components outward"));
}

TEST_F(Chamferprep, ExplainsItself) {
  const auto help = run({"--help"});
  EXPECT_EQ(help.status, 0);
  for (const char* words :
       {"--radius", "--output", "--json", "--mesh", "--segments", "--clamp", "--on-nonconvex", "--weld",
        "--planarity", "--convexity", "--threads", "--dry-run", "--quiet", "Exit status"})
    EXPECT_THAT(help.out, HasSubstr(words));
  const auto version = run({"--version"});
  EXPECT_EQ(version.status, 0);
  EXPECT_THAT(version.out, testing::StartsWith("chamferprep "));
}

TEST_F(Chamferprep, WhatReadingWarnsOfIsInEveryReport) {
  const std::string text = "l 1 2\ncall more.obj\n" + objText(box());
  const std::string mesh = write("warned.obj", text).string();
  const std::vector<std::string> expected{
      "line 1: \"l\" is no part of a surface and not read",
      "line 2: \"call\" is not followed: no other file is read for it and no command run"};
  EXPECT_EQ(report({mesh, "--radius", "2%"}).at("warnings"), expected);
  EXPECT_THAT(run({mesh, "--radius", "2%"}).out, HasSubstr("warning: " + expected[1]));
  // A mesh that is refused, too: what was not read may be why.
  TriangleMesh open = box();
  open.triangles.pop_back();
  const std::string refused = write("open.obj", "call more.obj\n" + objText(open)).string();
  const test::ProgramRun r = run({refused, "--radius", "2%", "--json"});
  EXPECT_EQ(r.status, 4);
  EXPECT_THAT(nlohmann::json::parse(r.out).at("warnings").dump(), HasSubstr("call"));
  EXPECT_THAT(r.err, HasSubstr("warning: line 1: \"call\""));
  EXPECT_EQ(run({refused, "--radius", "2%", "--quiet"}).err.find("warning"), std::string::npos);
}

} // namespace
} // namespace chamfer
