// The explicit mesh carries the texture coordinates of the mesh it is made from: each triangle those of the
// facet that it is turned to most, at the points straight above its corners.
#include "preprocess/rounding/explicit_mesh_uv.h"

#include "common/text.h"
#include "preprocess/preprocess.h"
#include "tests/preprocess/chamferprep_fixture.h"

#include <gtest/gtest.h>

namespace chamfer {
namespace {

using ::testing::HasSubstr;

/// A box of edges 2, 1.5 and 1 whose sides share no vertices. Side 2 * axis + (upper ? 1 : 0) is laid out
/// from u = 10 * side on, as large as it is.
struct LaidOutBox {
  std::vector<Point3> positions;
  std::vector<std::array<float, 2>> uvs;
  std::vector<std::array<std::uint32_t, 4>> sides;

  static constexpr double kEdge[3] = {2, 1.5, 1};
  static std::array<double, 2> uvOf(std::size_t side, const Point3& p) {
    const std::size_t axis = side / 2;
    return {10 * double(side) + p[(axis + 1) % 3], p[(axis + 2) % 3]};
  }
  LaidOutBox() {
    for (std::size_t side = 0; side < 6; ++side) {
      const std::size_t axis = side / 2;
      const auto first = std::uint32_t(positions.size());
      for (const auto& [a, b] : {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1), std::pair(0, 1)}) {
        double p[3];
        p[axis] = side % 2 ? kEdge[axis] : 0;
        p[(axis + 1) % 3] = a * kEdge[(axis + 1) % 3];
        p[(axis + 2) % 3] = b * kEdge[(axis + 2) % 3];
        positions.emplace_back(p[0], p[1], p[2]);
        const auto uv = uvOf(side, positions.back());
        uvs.push_back({float(uv[0]), float(uv[1])});
      }
      if (side % 2)
        sides.push_back({first, first + 1, first + 2, first + 3});
      else
        sides.push_back({first, first + 3, first + 2, first + 1});
    }
  }
  std::string rows(const char* word, bool withUv) const {
    std::string text;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const Point3& p = positions[i];
      text += word + exactNumberText(p.x) + ' ' + exactNumberText(p.y) + ' ' + exactNumberText(p.z);
      if (withUv) text += ' ' + exactNumberText(double(uvs[i][0])) + ' ' + exactNumberText(double(uvs[i][1]));
      text += '\n';
    }
    return text;
  }
  std::string faces(const char* word) const {
    std::string text;
    for (const auto& side : sides) {
      text += word;
      for (const std::uint32_t v : side)
        text += ' ' + std::to_string(v);
      text += '\n';
    }
    return text;
  }
  std::string obj() const {
    std::string text = rows("v ", false);
    for (const auto& uv : uvs)
      text += "vt " + exactNumberText(double(uv[0])) + ' ' + exactNumberText(double(uv[1])) + '\n';
    for (const auto& side : sides) {
      text += 'f';
      for (const std::uint32_t v : side)
        text += ' ' + std::to_string(v + 1) + '/' + std::to_string(v + 1);
      text += '\n';
    }
    return text;
  }
  std::string ply() const {
    return "ply\nformat ascii 1.0\nelement vertex 24\nproperty double x\nproperty double y\nproperty double "
           "z\n"
           "property float s\nproperty float t\nelement face 6\nproperty list uchar int vertex_indices\n"
           "end_header\n" +
           rows("", true) + faces("4");
  }
  std::string off() const { return "STOFF\n24 6 0\n" + rows("", true) + faces("4"); }

  TriangleMesh mesh() const {
    TriangleMesh m;
    m.positions = positions;
    m.uvs = uvs;
    for (const auto& side : sides)
      for (const std::size_t k : {1u, 2u}) {
        m.triangles.push_back({side[0], side[k], side[k + 1]});
        m.faceOfTriangle.push_back(std::uint32_t(m.triangles.size() - 1) / 2);
      }
    m.uvTriangles = m.triangles;
    return m;
  }
};

/// Each triangle's coordinates are those of one side, at its corners; and that side is the one that it is
/// turned to most.
void expectLaidOut(const std::vector<Point3>& positions,
                   const std::vector<std::array<std::uint32_t, 3>>& triangles,
                   const std::vector<std::array<float, 2>>& uvs,
                   const std::vector<std::array<std::uint32_t, 3>>& uvTriangles) {
  ASSERT_EQ(uvTriangles.size(), triangles.size());
  std::array<int, 6> found{};
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Point3 p[3] = {positions[triangles[t][0]], positions[triangles[t][1]], positions[triangles[t][2]]};
    ASSERT_NE(uvTriangles[t][0], kNone);
    const std::size_t side = std::size_t((uvs[uvTriangles[t][0]][0] + 1) / 10);
    ASSERT_LT(side, 6u);
    ++found[side];
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_NE(uvTriangles[t][k], kNone);
      const auto expected = LaidOutBox::uvOf(side, p[k]);
      EXPECT_NEAR(double(uvs[uvTriangles[t][k]][0]), expected[0], 1e-5);
      EXPECT_NEAR(double(uvs[uvTriangles[t][k]][1]), expected[1], 1e-5);
    }
    const Vector3 normal = normalize(cross(p[1] - p[0], p[2] - p[0]));
    const double own = normal[side / 2] * (side % 2 ? 1 : -1);
    EXPECT_GT(own, std::sqrt(1.0 / 3) - 1e-3) << "turned to another side";
    EXPECT_GT(own, std::max({std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)}) - 0.2);
  }
  // A corner's middle triangles are turned to all three alike.
  const auto [fewest, most] = std::minmax_element(found.begin(), found.end());
  EXPECT_GE(*fewest, *most * 2 / 3);
}

class ExplicitMeshTextures : public Chamferprep {};

TEST_F(ExplicitMeshTextures, AreWrittenWhereTheInputHasThemWhateverItsFormat) {
  const LaidOutBox box;
  for (const auto& [name, text] :
       {std::pair("box.obj", box.obj()), {"box.ply", box.ply()}, {"box.off", box.off()}})
    for (const char* segments : {"2", "6"}) {
      SCOPED_TRACE(name + std::string(" with ") + segments);
      const auto json =
          report({write(name, text).string(), "-r", "0.2", "--mesh", in("out.obj"), "--segments", segments});
      EXPECT_TRUE(json.at("warnings").empty()) << json.at("warnings");
      const TriangleMesh out = readMesh(in("out.obj"));
      EXPECT_TRUE(out.warnings.empty());
      EXPECT_EQ(out.triangles.size(), json.at("explicit_triangles"));
      expectLaidOut(out.positions, out.triangles, out.uvs, out.uvTriangles);
    }
}

TEST_F(ExplicitMeshTextures, AreNotInventedWhereTheInputHasNone) {
  report({cube(), "-r", "0.1", "--mesh", in("out.obj")});
  EXPECT_TRUE(readMesh(in("out.obj")).uvTriangles.empty());
  EXPECT_EQ(contentOf(in("out.obj")).find("vt"), std::string::npos);
}

TEST_F(ExplicitMeshTextures, OfABareSideLeaveItsTrianglesBare) {
  const LaidOutBox box;
  std::string text = box.obj();
  const std::size_t last = text.rfind("f "); // the side z = 1
  text.replace(last, std::string::npos, "f 21 22 23 24\n");
  report({write("box.obj", text).string(), "-r", "0.2", "--mesh", in("out.obj"), "--segments", "2"});
  const TriangleMesh out = readMesh(in("out.obj"));
  std::size_t bare = 0;
  for (std::size_t t = 0; t < out.triangles.size(); ++t) {
    if (out.uvTriangles[t][0] != kNone) {
      EXPECT_LT(out.uvs[out.uvTriangles[t][0]][0], 45) << "of another side";
      continue;
    }
    ++bare;
    for (const std::uint32_t v : out.triangles[t])
      EXPECT_GT(out.positions[v].z, 0.8 - 1e-6);
  }
  EXPECT_GT(bare * 8, out.triangles.size());
  EXPECT_LT(bare * 5, out.triangles.size());
}

TEST_F(ExplicitMeshTextures, CutWithinAFacetAreCarriedOnAndTold) {
  // The two halves of the side z = 1 lie in different places of the image.
  std::string text = LaidOutBox().obj();
  const std::size_t last = text.rfind("f ");
  text.replace(last, std::string::npos,
               "vt 90 0\nvt 92 1.5\nvt 90 1.5\nf 21/21 22/22 23/23\nf 21/25 23/26 24/27\n");
  const auto json =
      report({write("box.obj", text).string(), "-r", "0.2", "--mesh", in("out.obj"), "--segments", "2"});
  EXPECT_THAT(json.at("warnings").dump(), HasSubstr("texture coordinates end within a flat facet"));
  EXPECT_THAT(json.at("warnings").dump(), HasSubstr("face 6 (line"));
  const TriangleMesh out = readMesh(in("out.obj"));
  std::array<std::size_t, 2> pieces{};
  for (std::size_t t = 0; t < out.triangles.size(); ++t) {
    const float first = out.uvs[out.uvTriangles[t][0]][0];
    if (first < 49) continue;
    ++pieces[first > 70];
    for (std::size_t k = 0; k < 3; ++k) {
      const Point3& p = out.positions[out.triangles[t][k]];
      const auto& uv = out.uvs[out.uvTriangles[t][k]];
      EXPECT_NEAR(double(uv[0]), (first > 70 ? 90 : 50) + p.x, 2e-5) << "smeared over the image";
      EXPECT_NEAR(double(uv[1]), p.y, 2e-5);
    }
  }
  EXPECT_GT(pieces[0], 4u);
  EXPECT_GT(pieces[1], 4u);
}

TEST(ExplicitMeshTexturesOfSharpTriangles, AreTheirOwn) {
  const LaidOutBox box;
  TriangleMesh mesh = box.mesh();
  const auto first = std::uint32_t(mesh.positions.size());
  for (const Point3& p : {Point3(5, 0, 0), Point3(6, 0, 0), Point3(5, 1, 0)})
    mesh.positions.push_back(p);
  mesh.uvs.insert(mesh.uvs.end(), {{0.25f, 1}, {0.5f, 2}, {0.75f, 3}});
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.uvTriangles.push_back(mesh.triangles.back());
  mesh.faceOfTriangle.push_back(6);
  PreprocessOptions options;
  options.radius.value = 0.2;
  options.onNonConvex = OnNonConvex::Sharp;
  const auto shared = std::make_shared<const TriangleMesh>(mesh);
  const PreprocessResult result = preprocess(mesh, options);
  ExplicitMesh out = explicitMesh(result.rounding->view(), mesh, 3);
  EXPECT_EQ(addTextureCoordinates(out, shared, result.rounding).triangles, 0u);
  const auto& uv = out.uvTriangles.back();
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_EQ(out.uvs[uv[k]], mesh.uvs[first + k]);
  out.triangles.pop_back();
  out.uvTriangles.pop_back();
  expectLaidOut(out.positions, out.triangles, out.uvs, out.uvTriangles);
}

} // namespace
} // namespace chamfer
