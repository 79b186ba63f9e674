// Solids that are rounded as their hulls get the hull as their mesh: every part of the rounding is behind a
// triangle.
#include "preprocess/rounding/hulled_mesh.h"
#include "tests/oracle/convex_families.h"
#include "tests/oracle/ray_samples.h"
#include "tests/preprocess/chamferprep_fixture.h"
#include "tests/preprocess/mesh_makers.h"
#include "tests/preprocess/rounding_subject.h"

namespace chamfer {
namespace {

using oracle::ConvexSolid;

/// An L: the notch's edge along z, so that two facets of its hull have no triangles or too few.
constexpr char kPrism[] = "v 0 0 0\nv 3 0 0\nv 3 1 0\nv 1 1 0\nv 1 3 0\nv 0 3 0\n"
                          "v 0 0 1\nv 3 0 1\nv 3 1 1\nv 1 1 1\nv 1 3 1\nv 0 3 1\n"
                          "f 1 4 3 2\nf 1 6 5 4\nf 7 8 9 10\nf 7 10 11 12\n"
                          "f 1 2 8 7\nf 2 3 9 8\nf 3 4 10 9\nf 4 5 11 10\nf 5 6 12 11\nf 6 1 7 12\n";

ConvexSolid hullOf(const TriangleMesh& mesh) {
  std::vector<Eigen::Vector3d> points;
  for (const Point3& p : mesh.positions)
    points.emplace_back(p.x, p.y, p.z);
  return oracle::solidFromPoints("hull", points);
}

PreprocessOptions asHull(double radius) {
  PreprocessOptions options;
  options.radius.value = radius;
  options.onNonConvex = OnNonConvex::Hull;
  return options;
}

class HulledMeshes : public Chamferprep {};

void expectRounded(const TriangleMesh& original, const ConvexSolid& hull, double radius) {
  const PreprocessResult result = preprocess(original, asHull(radius));
  ASSERT_TRUE(result.mesh);
  EXPECT_EQ(result.rounding->meshDigest(), geometryDigest(*result.mesh));
  EXPECT_EQ(result.report.hulledComponents, 1u);
  const RoundingView& view = result.rounding->view();
  ASSERT_EQ(view.facetOfTriangle.size(), result.mesh->triangles.size());
  // Its triangles are the hull's: each in the plane of its facet, all facets covered, closed.
  std::vector<bool> covered(view.facets.size());
  for (std::size_t t = 0; t < view.facetOfTriangle.size(); ++t) {
    ASSERT_LT(view.facetOfTriangle[t], view.facets.size());
    covered[view.facetOfTriangle[t]] = true;
  }
  EXPECT_EQ(std::count(covered.begin(), covered.end(), false), 0);
  expectSound(split(*result.mesh), *result.mesh, 1);
  // Any radius of that mesh is then a rounding of a convex solid, and what rays meet is the rounded hull.
  PreprocessOptions options;
  options.radius.value = radius;
  const RoundedSubject subject(*result.mesh, options, {hull});
  const auto truth = std::make_shared<oracle::RoundedOracle>(hull, radius);
  oracle::RaySampler sampler(hull, *truth, 3);
  const auto report =
      compare(subject.firstEnd(), oracle::UnionOracle(truth), sampler.mixed(oracle::rayBudget(1000)));
  EXPECT_TRUE(report.agrees()) << report.complaint();
}

TEST_F(HulledMeshes, AnLPrismIsRoundedAllOver) {
  const TriangleMesh mesh = read("l.obj", kPrism);
  for (const double radius : {0.01, 0.2, 0.45})
    expectRounded(mesh, hullOf(mesh), radius);
}

TEST_F(HulledMeshes, StarsAreRoundedAllOver) {
  // Hulls with a cone over each facet pulled inwards: no triangle of the file lies on any facet.
  for (const ConvexSolid& solid :
       {oracle::dodecahedron(), oracle::hullOnSphere(40, 2), oracle::prism(9, 1)}) {
    std::vector<Eigen::Vector3d> points = solid.vertices;
    TriangleMesh mesh;
    for (const auto& v : solid.vertices)
      mesh.positions.push_back({v.x(), v.y(), v.z()});
    for (const auto& face : solid.faces) {
      Eigen::Vector3d middle(0, 0, 0);
      for (const std::uint32_t v : face)
        middle += solid.vertices[v] / double(face.size());
      middle *= 0.7;
      const auto apex = std::uint32_t(mesh.positions.size());
      mesh.positions.push_back({middle.x(), middle.y(), middle.z()});
      for (std::size_t i = 0; i < face.size(); ++i)
        appendTriangle(mesh, {face[i], face[(i + 1) % face.size()], apex});
    }
    expectRounded(mesh, solid, 0.2 * double(inball(solid).radius));
    expectRounded(unwelded(mesh, true), solid, 0.2 * double(inball(solid).radius));
  }
}

TEST_F(HulledMeshes, OtherComponentsKeepTheirTriangles) {
  TriangleMesh mesh = box();
  const TriangleMesh prism = read("l.obj", kPrism);
  const auto base = std::uint32_t(mesh.positions.size());
  for (const Point3& p : prism.positions)
    mesh.positions.push_back(p + Vector3(5, 0, 0));
  for (const auto& t : prism.triangles)
    appendTriangle(mesh, {base + t[0], base + t[1], base + t[2]});
  const auto plain = mesh.triangles.size();
  appendBox(mesh, {0, 5, 0}, {1, 6, 1});
  const PreprocessResult result = preprocess(mesh, asHull(0.1));
  ASSERT_TRUE(result.mesh);
  EXPECT_EQ(result.report.solids, 3u);
  for (std::size_t t = 0; t < 12; ++t) {
    EXPECT_EQ(result.mesh->triangles[t], mesh.triangles[t]);
    EXPECT_EQ(result.mesh->triangles[12 + t], mesh.triangles[plain + t]);
  }
  // The rounding knows them in their new places.
  EXPECT_EQ(split(*result.mesh).list.size(), 3u);
  const RoundingView& view = result.rounding->view();
  for (std::size_t t = 0; t < view.facetOfTriangle.size(); ++t) {
    const FacetRecord& facet = view.facets[view.facetOfTriangle[t]];
    const auto& origin = view.solids[facet.solid].origin;
    for (const std::uint32_t v : result.mesh->triangles[t]) {
      const Vector3 to = result.mesh->positions[v] - Point3(origin[0], origin[1], origin[2]);
      EXPECT_NEAR(dot(Vector3(facet.normal), to), double(facet.offset), 1e-5);
    }
  }
}

TEST_F(HulledMeshes, ConvexMeshesAreNotReplaced) {
  const TriangleMesh mesh = box();
  EXPECT_FALSE(preprocess(mesh, asHull(0.1)).mesh);
  PreprocessOptions options = asHull(0.1);
  options.keepTriangles = true;
  const TriangleMesh prism = read("l.obj", kPrism);
  const PreprocessResult result = preprocess(prism, options);
  EXPECT_FALSE(result.mesh);
  EXPECT_EQ(result.rounding->view().facetOfTriangle.size(), prism.triangles.size());
}

TEST_F(HulledMeshes, TakeMaterialsAndTextureCoordinatesOfTheirFacet) {
  write("l.mtl", "newmtl floor\nKd 1 0 0\nnewmtl sides\nKd 0 1 0\nnewmtl notch\nKd 0 0 1\n");
  std::string text = "mtllib l.mtl\nvt 0 0\nvt 1 0\nvt 1 1\n" + std::string(kPrism);
  const auto before = [&](const std::string& line, const std::string& add) {
    text.insert(text.find(line), add);
  };
  before("f 1 4 3 2", "usemtl floor\n");
  before("f 7 8 9 10", "usemtl sides\n");
  before("f 3 4 10 9", "usemtl notch\n");
  before("f 5 6 12 11", "usemtl sides\n");
  text.replace(text.find("f 1 4 3 2"), 9, "f 1/1 4/2 3/3 2/2");
  const TriangleMesh mesh = read("l.obj", text);
  const PreprocessResult result = preprocess(mesh, asHull(0.1));
  ASSERT_TRUE(result.mesh);
  const TriangleMesh& hull = *result.mesh;
  ASSERT_EQ(hull.materialOfTriangle.size(), hull.triangles.size());
  ASSERT_EQ(hull.uvTriangles.size(), hull.triangles.size());
  for (std::size_t t = 0; t < hull.triangles.size(); ++t) {
    Vector3 normal;
    const Point3& a = hull.positions[hull.triangles[t][0]];
    normal =
        normalize(cross(hull.positions[hull.triangles[t][1]] - a, hull.positions[hull.triangles[t][2]] - a));
    const std::string& name = hull.materials[hull.materialOfTriangle[t]].name;
    if (normal.z < -0.5) {
      EXPECT_EQ(name, "floor");
    } else if (std::abs(normal.x) < 0.01 || std::abs(normal.y) < 0.01) {
      EXPECT_EQ(name, "sides");
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = hull.triangles[t][k], uv = hull.uvTriangles[t][k];
      if (normal.z < -0.5 && v == 0) {
        EXPECT_EQ(uv, 0u);
      }
      if (normal.z < -0.5 && v == 2) {
        EXPECT_EQ(uv, 2u);
      }
    }
  }
}

TEST_F(HulledMeshes, ChamferprepWritesTheSameBytesEachTime) {
  write("l.obj", kPrism);
  std::string first;
  for (int i = 0; i < 3; ++i) {
    const auto json =
        report({in("l.obj"), "--radius", "0.1", "--on-nonconvex", "hull", "--mesh", in("out.obj")});
    EXPECT_EQ(json.at("hulled_components"), 1);
    const std::string bytes = contentOf(in("l.obj.chamfer")) + contentOf(in("out.obj"));
    if (i > 0) {
      EXPECT_EQ(bytes, first);
    }
    first = bytes;
  }
  // The explicit mesh is the rounded hull: closed, one solid.
  const TriangleMesh rounded = readMesh(in("out.obj"));
  EXPECT_EQ(split(rounded).list.size(), 1u);
  EXPECT_FALSE(split(rounded).list[0].fault);
}

} // namespace
} // namespace chamfer
