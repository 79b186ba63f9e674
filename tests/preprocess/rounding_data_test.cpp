// Real meshes, as they lie outside the project: each is rounded, and its rays are compared with the oracle of
// the convex hull of what was read. CHAMFER_RAYS=100 asks for a hundred times the rays.
#include "common/error.h"
#include "common/text.h"
#include "tests/oracle/exact_hull.h"
#include "tests/oracle/ray_samples.h"
#include "tests/preprocess/rounding_subject.h"

#include <filesystem>
#include <gtest/gtest.h>
#include <iostream>
#include <map>

namespace chamfer {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> meshesIn(const fs::path& folder) {
  std::vector<fs::path> files;
  if (!fs::is_directory(folder)) return files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string extension = lowerCase(entry.path().extension().string());
    if (extension == ".obj" || extension == ".stl" || extension == ".ply" || extension == ".off")
      files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Planes nearer than this share of the size are one facet for preprocessing; the truth must not be finer.
constexpr double kSamePlane = 1e-7;

/// Files that cannot be rounded with this radius, and how they are refused.
const std::map<std::string, ErrorKind> kRefused{
    {"anisotropic-1e-4.obj", ErrorKind::RadiusTooLarge},          // its inradius is 0.0035 % of its diagonal
    {"manifold-models-Cray_left.obj", ErrorKind::NotConvexSolid}, // its second shell is a cavity in the first
};

struct Folder {
  const char* name;
  std::size_t files;
  friend void PrintTo(const Folder& folder, std::ostream* out) { *out << folder.name; }
};

PreprocessOptions roundingOptions() {
  PreprocessOptions options;
  options.radius = parseRadius("0.02%");
  options.threads = 1;
  return options;
}

oracle::Tolerances storageTolerances() {
  oracle::Tolerances tolerances;
  // Facets are merged where vertices lie within 1e-6 diagonals of a plane: E moves by that much.
  tolerances.noise = 2e-6;
  tolerances.seam = 5e-5;
  return tolerances;
}

std::vector<oracle::ConvexSolid> hullsOf(const TriangleMesh& mesh, const std::string& name,
                                         const PreprocessOptions& options) {
  std::vector<oracle::ConvexSolid> hulls;
  for (const Component& component : splitComponents(mesh, options.tolerances, 1).list) {
    std::vector<Eigen::Vector3d> points;
    for (const Point3& p : component.positions)
      points.emplace_back(p.x, p.y, p.z);
    hulls.push_back(oracle::exactHull(name, points, kSamePlane));
  }
  return hulls;
}

class RoundingOfRealMeshes : public ::testing::TestWithParam<Folder> {};

TEST_P(RoundingOfRealMeshes, AgreesWithTheOracleOfTheirHulls) {
  const auto files = meshesIn(fs::path(CHAMFER_SOURCE_DIR) / "../shared/data" / GetParam().name);
  if (files.empty()) GTEST_SKIP() << "no such folder beside the project: shared/data/" << GetParam().name;
  EXPECT_EQ(files.size(), GetParam().files);
  const PreprocessOptions options = roundingOptions();
  const oracle::Tolerances tolerances = storageTolerances();
  oracle::AgreementReport sum;
  std::size_t solids = 0;
  for (const fs::path& file : files) {
    SCOPED_TRACE(file.filename().string());
    try {
      const TriangleMesh mesh = readMesh(file);
      if (const auto refused = kRefused.find(file.filename().string()); refused != kRefused.end()) {
        try {
          preprocess(mesh, options);
          ADD_FAILURE() << "was rounded";
        } catch (const Error& e) {
          EXPECT_EQ(e.kind(), refused->second) << e.what();
        }
        continue;
      }
      const auto hulls = hullsOf(mesh, file.filename().string(), options);
      const RoundedSubject subject(mesh, options, hulls);
      ASSERT_EQ(subject.view().solidCount(), hulls.size());
      oracle::UnionOracle truth;
      for (const auto& hull : hulls)
        truth.add(std::make_shared<oracle::RoundedOracle>(hull, options.radius.value * hull.diagonal()));
      oracle::AgreementReport report;
      for (std::size_t s = 0; s < hulls.size(); ++s) {
        oracle::RaySampler sampler(hulls[s], truth.part(s), s);
        report.merge(compare(subject.firstEnd(), truth,
                             sampler.mixed(oracle::rayBudget(600 / hulls.size() + 1)), tolerances));
      }
      // Of a mesh of thin solids up to 2.7 %: their radius is less than what counts as the silhouette.
      EXPECT_TRUE(report.agrees(0.04)) << report.complaint();
      sum.merge(report);
      solids += hulls.size();
    } catch (const std::exception& e) {
      ADD_FAILURE() << e.what();
    }
  }
  EXPECT_TRUE(sum.agrees()) << sum.summary();
  std::cout << GetParam().name << ": " << files.size() << " files, " << solids << " solids, " << sum.summary()
            << "\n";
}

TEST(RoundingOfARealSphere, ARayThatGrazesFromWhereItBeginsIsAnsweredWithinTheNoise) {
  const fs::path file = fs::path(CHAMFER_SOURCE_DIR) / "../shared/data/accepted/real-cgal_sphere966.off";
  if (!fs::is_regular_file(file)) GTEST_SKIP() << "no such file beside the project: shared/data/accepted";
  const PreprocessOptions options = roundingOptions();
  const TriangleMesh mesh = readMesh(file);
  const auto hulls = hullsOf(mesh, "sphere", options);
  ASSERT_EQ(hulls.size(), 1u);
  const RoundedSubject subject(mesh, options, hulls);
  const auto solid =
      std::make_shared<oracle::RoundedOracle>(hulls[0], options.radius.value * hulls[0].diagonal());
  const oracle::UnionOracle truth(solid);
  // It begins 4.8e-8 diagonals outside R and leaves it at an angle of 0.2 degrees; of the stored rounding the
  // same point is within, so that the ray meets the surface at once.
  const oracle::Ray ray{{7.3653410137315056, 4.020213791766281, 5.4064013655544407},
                        {-0.48559602261259394, 0.87398355068774847, 0.018688390783189401}};
  EXPECT_FALSE(truth.firstHit(ray));
  EXPECT_NEAR(double(truth.nearest(0, ray.at(0)).offSurface), 4.8e-8, 1e-9);
  if (const auto answer = subject.firstEnd()(ray)) {
    EXPECT_LT(double(std::abs(truth.nearest(0, ray.at(answer->t)).offSurface)), 2e-7);
  }
  const auto report = compare(subject.firstEnd(), truth, std::span(&ray, 1), storageTolerances());
  EXPECT_TRUE(report.agrees()) << report.complaint();
}

INSTANTIATE_TEST_SUITE_P(Folders, RoundingOfRealMeshes,
                         ::testing::Values(Folder{"catalogue", 133}, Folder{"pieces", 402},
                                           Folder{"accepted", 46}),
                         [](const auto& folder) { return std::string(folder.param.name); });

} // namespace
} // namespace chamfer
