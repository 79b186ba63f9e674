// GET .../preview.glb, read back by tinygltf: triangles, places, colours.
#include "server/http/routes/preview_glb.h"
#include "server/http/schema/limits.h"
#include "tests/http/service_fixture.h"

#include <gmock/gmock.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace chamfer::http {
namespace {

using testing::HasSubstr;

struct Triangle {
  std::array<Point3, 3> corners;
  std::array<double, 3> color{};
};

tinygltf::Model parsed(const std::string& bytes) {
  tinygltf::Model model;
  std::string error, warning;
  EXPECT_TRUE(tinygltf::TinyGLTF().LoadBinaryFromMemory(&model, &error, &warning,
                                                        reinterpret_cast<const unsigned char*>(bytes.data()),
                                                        static_cast<unsigned>(bytes.size())))
      << error;
  EXPECT_EQ(warning, "");
  return model;
}

Point3 transformed(const std::vector<double>& m, const Point3& p) {
  if (m.empty()) return p;
  return {m[0] * p.x + m[4] * p.y + m[8] * p.z + m[12], m[1] * p.x + m[5] * p.y + m[9] * p.z + m[13],
          m[2] * p.x + m[6] * p.y + m[10] * p.z + m[14]};
}

/// All triangles of the model below its root node, in the coordinates below it or beyond it.
std::vector<Triangle> trianglesOf(const tinygltf::Model& model, bool beyondRoot = false) {
  std::vector<Triangle> triangles;
  const tinygltf::Node& root = model.nodes[static_cast<std::size_t>(model.scenes[0].nodes.at(0))];
  const auto numbers = [&](int accessor) {
    const auto& a = model.accessors[static_cast<std::size_t>(accessor)];
    const auto& view = model.bufferViews[static_cast<std::size_t>(a.bufferView)];
    return model.buffers[0].data.data() + view.byteOffset + a.byteOffset;
  };
  for (const int child : root.children) {
    const tinygltf::Node& node = model.nodes[static_cast<std::size_t>(child)];
    for (const auto& primitive : model.meshes[static_cast<std::size_t>(node.mesh)].primitives) {
      const auto& material = model.materials[static_cast<std::size_t>(primitive.material)];
      const auto& color = material.pbrMetallicRoughness.baseColorFactor;
      const auto& indices = model.accessors[static_cast<std::size_t>(primitive.indices)];
      const int positions = primitive.attributes.at("POSITION");
      for (std::size_t i = 0; i < indices.count; i += 3) {
        Triangle& triangle = triangles.emplace_back();
        triangle.color = {color[0], color[1], color[2]};
        for (std::size_t c = 0; c < 3; ++c) {
          std::uint32_t index = 0;
          std::memcpy(&index, numbers(primitive.indices) + 4 * (i + c), 4);
          EXPECT_LT(index, model.accessors[static_cast<std::size_t>(positions)].count);
          float p[3];
          std::memcpy(p, numbers(positions) + 12 * index, 12);
          const Point3 point = transformed(node.matrix, {p[0], p[1], p[2]});
          triangle.corners[c] = beyondRoot ? transformed(root.matrix, point) : point;
        }
      }
    }
  }
  return triangles;
}

Bounds3 boundsOf(const std::vector<Triangle>& triangles) {
  Bounds3 bounds;
  for (const Triangle& triangle : triangles)
    for (const Point3& corner : triangle.corners)
      bounds.extend(corner);
  return bounds;
}

class Preview : public test::ServiceTest {
protected:
  Response preview(const std::string& name, Headers headers = {}) {
    return get("/v1/scenes/" + idOf(name) + "/preview.glb", std::move(headers));
  }
  /// The scene's triangles in world coordinates, the preview's against them: one to one, to float32.
  void expectSame(const std::string& name) {
    const auto triangles = trianglesOf(parsed(preview(name).body));
    const Scene& scene = *catalogue_->find(name)->scene;
    ASSERT_EQ(triangles.size(), scene.triangles);
    std::vector<Point3> expected;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
      const SceneMesh* mesh = nullptr;
      for (const SceneMesh& m : scene.meshes)
        if (m.traced == scene.instances[i].mesh) mesh = &m;
      for (const auto& t : mesh->mesh->triangles) {
        Point3 centre(0, 0, 0);
        for (const std::uint32_t corner : t) {
          const Point3 p = scene.instances[i].worldFromObject(mesh->mesh->positions[corner]);
          centre = {centre.x + p.x / 3, centre.y + p.y / 3, centre.z + p.z / 3};
        }
        expected.push_back(centre);
      }
    }
    const double tolerance = 1e-6 * scene.bounds.diagonal();
    for (const Triangle& t : triangles) {
      const Point3 centre((t.corners[0].x + t.corners[1].x + t.corners[2].x) / 3,
                          (t.corners[0].y + t.corners[1].y + t.corners[2].y) / 3,
                          (t.corners[0].z + t.corners[1].z + t.corners[2].z) / 3);
      const auto near = std::find_if(expected.begin(), expected.end(),
                                     [&](const Point3& e) { return length(e - centre) < tolerance; });
      ASSERT_NE(near, expected.end());
      expected.erase(near);
    }
  }
};

TEST_F(Preview, MeshHasItsTrianglesWhereTheSceneHasThem) {
  folder_.addCube("cube.obj");
  serve();
  const Response response = preview("cube");
  EXPECT_EQ(response.status, 200);
  EXPECT_EQ(response.contentType, "model/gltf-binary");
  expectSame("cube");
  const auto triangles = trianglesOf(parsed(response.body), true);
  EXPECT_EQ(triangles.size(), 12u) << "not the studio's ground";
}

TEST_F(Preview, InstancesAreNodesThatShareTheirMesh) {
  folder_.write("cube.obj", test::cubeObj());
  folder_.write("many.scene.json", R"({
    "meshes": [{"name": "m", "file": "cube.obj", "radius": 0.1}],
    "materials": [{"name": "red", "base_color": [0.5, 0, 0]}, {"name": "dim", "emission": [4, 2, 0]}],
    "instances": [{"mesh": "m", "material": "red", "translate": [3, 0, 0], "rotate": {"axis": [0, 0, 1], "degrees": 30}},
                  {"mesh": "m", "material": "red", "scale": [-2, 1, 0.5]},
                  {"mesh": "m", "material": "dim", "translate": [0, 7, 0]},
                  {"mesh": "m", "matrix": [1, 0.5, 0, 0, 0, 1, 0, -4, 0, 0, 1, 0, 0, 0, 0, 1]}]})");
  serve();
  ASSERT_TRUE(catalogue_->find("many")->scene) << catalogue_->find("many")->error;
  expectSame("many");
  const tinygltf::Model model = parsed(preview("many").body);
  ASSERT_EQ(model.nodes.size(), 5u);
  EXPECT_EQ(model.nodes[1].mesh, model.nodes[2].mesh);
  EXPECT_NE(model.nodes[1].mesh, model.nodes[3].mesh) << "another material";
  EXPECT_TRUE(model.nodes[4].matrix.empty()) << "a shear is no node's";
  EXPECT_EQ(model.accessors.size(), 2u + 3u) << "positions of two, indices of each mesh";
  const auto triangles = trianglesOf(model);
  EXPECT_EQ(triangles.front().color, (std::array<double, 3>{0.5, 0, 0}));
  const auto& dim = model.materials.back();
  EXPECT_EQ(dim.emissiveFactor, (std::vector<double>{1, 0.5, 0})) << "a factor is at most 1";
}

TEST_F(Preview, MeshesAtMapCoordinatesKeepTheirShape) {
  // A cube of 8 mm at millions of metres: float32 alone would put its corners a quarter of a metre off.
  std::string obj;
  for (int i = 0; i < 8; ++i)
    obj += "v " + std::string(i & 1 ? "3500000.008" : "3500000") + ' ' + (i & 2 ? "5800000.008" : "5800000") +
           ' ' + (i & 4 ? "0.008" : "0") + '\n';
  obj += "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  folder_.write("far.obj", obj);
  folder_.write("far.scene.json", R"({"meshes":[{"name":"m","file":"far.obj"}],"instances":[{"mesh":"m"},
      {"mesh":"m","matrix":[1,0.5,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}]})");
  serve();
  const tinygltf::Model model = parsed(get("/v1/scenes/" + idOf("far") + "/preview.glb").body);
  ASSERT_EQ(model.accessors.size(), 4u);
  for (const std::size_t accessor : {0u, 2u})
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(model.accessors[accessor].maxValues[c] - model.accessors[accessor].minValues[c],
                  accessor == 2 && c == 0 ? 0.012 : 0.008, 1e-6);
  ASSERT_EQ(model.nodes.size(), 3u);
  EXPECT_NEAR(model.nodes[1].matrix[12], 3500000.004, 1e-6);
  EXPECT_NEAR(model.nodes[2].matrix[12], 3500000.004 + 0.5 * 5800000.004, 1e-6);
  EXPECT_NEAR(model.nodes[2].matrix[13], 5800000.004, 1e-6);
}

TEST_F(Preview, TrianglesHaveTheirOwnMaterials) {
  folder_.write("two.mtl", "newmtl a\nKd 1 0 0\nnewmtl b\xff\nKd 0 0 1\n");
  folder_.write("two.obj",
                "mtllib two.mtl\nv -1 -1 -1\nv 1 -1 -1\nv 0 1 -1\nv 0 0 1\nusemtl a\nf 1 3 2\nusemtl "
                "b\xff\nf 1 2 4\nf 2 3 4\nusemtl a\nf 3 1 4\n");
  folder_.round("two.obj", 0.05);
  serve();
  const tinygltf::Model model = parsed(preview("two").body);
  ASSERT_EQ(model.meshes.at(0).primitives.size(), 2u);
  int red = 0, blue = 0;
  for (const Triangle& triangle : trianglesOf(model)) {
    red += triangle.color == std::array<double, 3>{1, 0, 0};
    blue += triangle.color == std::array<double, 3>{0, 0, 1};
  }
  EXPECT_EQ(red, 2);
  EXPECT_EQ(blue, 2);
}

TEST_F(Preview, RootTurnsTheScenesUpToGltfs) {
  folder_.write("cube.obj", test::cubeObj());
  for (const auto& [name, up] : {std::pair("x", "[1, 0, 0]"), std::pair("y", "[0.1, 1, 0]"),
                                 std::pair("z", "[0, 0, 1]"), std::pair("down", "[0, 0.1, -1]")})
    folder_.write(std::string(name) + ".scene.json",
                  R"({"meshes": [{"name": "m", "file": "cube.obj"}],
                      "instances": [{"mesh": "m", "scale": [1, 2, 3]}],
                      "camera": {"eye": [5, 6, 7], "target": [0, 0, 0], "vfov_degrees": 40, "up": )" +
                      std::string(up) + "}}");
  serve();
  for (const auto& [name, height] :
       {std::pair("x", 1.0), std::pair("y", 2.0), std::pair("z", 3.0), std::pair("down", 3.0)}) {
    const tinygltf::Model model = parsed(preview(name).body);
    const Bounds3 bounds = boundsOf(trianglesOf(model, true));
    EXPECT_NEAR(bounds.upper.y - bounds.lower.y, height, 1e-6) << name;
    const auto& m = model.nodes[0].matrix;
    const Vector3 x(m[0], m[1], m[2]), y(m[4], m[5], m[6]), z(m[8], m[9], m[10]);
    EXPECT_EQ(dot(cross(x, y), z), 1) << name << ": a rotation";
  }
  const tinygltf::Model down = parsed(preview("down").body);
  EXPECT_EQ(transformed(down.nodes[0].matrix, Point3(0, 0, -1)).y, 1);
}

TEST_F(Preview, IsAFunctionOfTheScenesId) {
  folder_.addCube("cube.obj");
  serve();
  const Response byName = get("/v1/scenes/cube/preview.glb");
  EXPECT_EQ(byName.status, 307);
  EXPECT_EQ(*byName.header("Location"), "/v1/scenes/" + idOf("cube") + "/preview.glb");
  const Response first = preview("cube");
  EXPECT_EQ(*first.header("Cache-Control"), "public, max-age=31536000, immutable");
  EXPECT_EQ(preview("cube", {{"if-none-match", *first.header("ETag")}}).status, 304);
  EXPECT_EQ(get("/v1/scenes/" + idOf("cube") + "/preview.glb?a=1").status, 400);
  const std::string bytes = first.body;
  serve();
  EXPECT_EQ(preview("cube").body, bytes);
}

TEST_F(Preview, IsNotMadeBeyondItsLimit) {
  folder_.addCube("cube.obj");
  serve();
  const auto scene = catalogue_->find("cube")->scene;
  try {
    previewGlb(*scene, 1000);
    FAIL() << "nothing was refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::OutOfRange);
    EXPECT_THAT(error.what(), HasSubstr("1000"));
  }
  EXPECT_LE(previewGlb(*scene, 10'000).size(), 10'000u);
}

} // namespace
} // namespace chamfer::http
