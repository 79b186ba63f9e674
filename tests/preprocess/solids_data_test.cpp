// The real meshes beside the project, folder by folder, up to the point where convexity is decided.
#include "tests/preprocess/surface_check.h"

#include "common/error.h"

#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

namespace chamfer {
namespace {

const std::filesystem::path kData = CHAMFER_SOURCE_DIR "/../shared/data";

struct Entry {
  std::string file, note;
  std::size_t components = 0;
  std::vector<bool> insideOut; ///< of each solid
};

class RealMeshes : public testing::Test {
protected:
  void SetUp() override {
    std::ifstream index(kData / "index.json");
    if (!index) GTEST_SKIP() << "the real meshes are not beside the project";
    for (const auto& item : nlohmann::json::parse(index)) {
      Entry entry{item.at("file"), item.at("note"), item.at("components"), {}};
      for (const auto& solid : item.at("solids"))
        entry.insideOut.push_back(solid.at("inside_out"));
      const std::string folder = entry.file.substr(0, entry.file.find('/'));
      entries_[folder].push_back(std::move(entry));
    }
  }

  void expectSound(const std::string& folder, std::size_t files) {
    EXPECT_EQ(entries_[folder].size(), files);
    for (const Entry& entry : entries_[folder]) {
      SCOPED_TRACE(entry.file);
      const TriangleMesh mesh = readMesh(kData / entry.file);
      const Components components = splitComponents(mesh, {});
      EXPECT_EQ(partitionDefect(components, mesh), "");
      // One file holds a cube twice in one place; the second is dropped.
      EXPECT_EQ(components.counts.duplicateSolids, entry.file == "pieces/bullet3-toys-cube.obj" ||
                                                       entry.file == "either/two-cubes-identical.obj");
      ASSERT_EQ(components.list.size() + components.counts.duplicateSolids, entry.components);
      std::size_t turned = 0;
      for (const Component& c : components.list) {
        turned += c.turned;
        // A cavity, byte for byte the mesh that either/ has as real-manifold_Cray_left.obj with this note;
        // what holds for refused/cube-in-cube.obj holds for it.
        if (entry.file == "pieces/manifold-models-Cray_left.obj" && c.turned) {
          ASSERT_TRUE(c.fault);
          EXPECT_EQ(c.fault->kind, FaultKind::InsideOut);
          continue;
        }
        EXPECT_FALSE(c.fault) << c.fault->message;
        EXPECT_EQ(surfaceDefect(c, mesh), "");
      }
      EXPECT_EQ(turned, std::size_t(std::count(entry.insideOut.begin(), entry.insideOut.end(), true)));
    }
  }

  std::map<std::string, std::vector<Entry>> entries_;
};

TEST_F(RealMeshes, CatalogueIsSound) { expectSound("catalogue", 133); }
TEST_F(RealMeshes, PiecesAreSound) { expectSound("pieces", 402); }
TEST_F(RealMeshes, NearConvexOnesAreSound) { expectSound("near", 47); }
TEST_F(RealMeshes, NastyLegalOnesAreSound) { expectSound("accepted", 46); }

TEST_F(RealMeshes, EitherOnesAreSoundOrSayWhyNot) {
  EXPECT_EQ(entries_["either"].size(), 30u);
  for (const Entry& entry : entries_["either"]) {
    SCOPED_TRACE(entry.file);
    const TriangleMesh mesh = readMesh(kData / entry.file);
    const Components components = splitComponents(mesh, {});
    EXPECT_EQ(partitionDefect(components, mesh), "");
    for (const Component& c : components.list) {
      const std::string defect = c.fault ? "" : surfaceDefect(c, mesh);
      EXPECT_EQ(defect, "");
      EXPECT_TRUE(!c.fault || c.fault->message.size() > 20);
    }
  }
}

TEST_F(RealMeshes, RefusedOnesFailHereOrAreClosedAndConcave) {
  EXPECT_EQ(entries_["refused"].size(), 60u);
  std::vector<std::string> left;
  for (const Entry& entry : entries_["refused"]) {
    SCOPED_TRACE(entry.file);
    try {
      const Components components = splitComponents(readMesh(kData / entry.file), {});
      bool faulty = false;
      for (const Component& c : components.list) {
        faulty = faulty || c.fault;
        EXPECT_TRUE(!c.fault || (isFinite(c.fault->place) && c.fault->triangle != 0xffffffffu));
      }
      if (faulty) continue;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::Malformed);
      EXPECT_THAT(error.what(), testing::HasSubstr(std::filesystem::path(entry.file).filename().string()));
      continue;
    }
    left.push_back(entry.file);
    // What passes is a closed surface, and only its shape is wrong.
    const std::string note = entry.note;
    const bool byShape = note.find("concave") != std::string::npos ||
                         note.find("non-convex") != std::string::npos ||
                         note.find("bunny") != std::string::npos;
    EXPECT_TRUE(byShape) << note;
  }
  EXPECT_THAT(left, testing::SizeIs(testing::AllOf(testing::Ge(4u), testing::Le(10u))))
      << "files left to the convexity step";
}

TEST_F(RealMeshes, FaultsAreTheNotesFaults) {
  const auto kindOf = [](const std::string& file) {
    for (const Component& c : splitComponents(readMesh(kData / "refused" / file), {}).list)
      if (c.fault) return c.fault->kind;
    return FaultKind::Concave;
  };
  const std::map<std::string, FaultKind> expected{
      {"cube-in-cube.obj", FaultKind::InsideOut},
      {"flat-two-sided-square.obj", FaultKind::Flat},
      {"one-face-missing.obj", FaultKind::Open},
      {"ldraw-3005.obj", FaultKind::Open},
      {"real-cgal_cube-ouvert.off", FaultKind::Open},
      {"real-cgal_quads_to_stitch.off", FaultKind::Open},
      {"real-trimesh_teapot.stl", FaultKind::Open},
      {"real-trimesh_suzanne.ply", FaultKind::Open},
      {"real-parry_poly_cylinder.obj", FaultKind::Open},
      {"real-cgal_3torus.off", FaultKind::Genus},
      {"real-cgal_P.off", FaultKind::Genus},
      {"real-cgal_torus_quad.off", FaultKind::Genus},
      {"real-cgal_triangle.off", FaultKind::TooFew},
      {"real-trimesh_polygonfaces.obj", FaultKind::TooFew},
      {"real-trimesh_not_convex.obj", FaultKind::NonManifold},
      {"real-bullet_pan_tefal-collision01.obj", FaultKind::NonManifold},
      {"real-bullet_plate-collision01.obj", FaultKind::NonManifold},
      {"real-openscad_issue1580-back-to-back.stl", FaultKind::NonManifold},
  };
  for (const auto& [file, kind] : expected)
    EXPECT_STREQ(faultWord(kindOf(file)), faultWord(kind)) << file;
}

} // namespace
} // namespace chamfer
