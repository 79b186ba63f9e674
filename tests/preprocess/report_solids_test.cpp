// Small solids after public bug reports of other tools: what each becomes. The files lie beside the project.
#include "preprocess/preprocess.h"

#include <filesystem>
#include <gtest/gtest.h>

namespace chamfer {
namespace {

namespace fs = std::filesystem;

struct ReportCase {
  const char* folder;
  const char* radius;
  double clamp;
  std::size_t facets, edges, spheres;
};
void PrintTo(const ReportCase& c, std::ostream* out) { *out << c.folder << " at " << c.radius; }

class ReportSolids : public testing::TestWithParam<ReportCase> {};

TEST_P(ReportSolids, AreRoundedAsExpected) {
  const ReportCase& c = GetParam();
  const fs::path folder = fs::path(CHAMFER_SOURCE_DIR "/../shared/data/reports") / c.folder;
  if (!fs::is_directory(folder)) GTEST_SKIP() << "the reports are not beside the project";
  unsigned files = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    PreprocessOptions options;
    options.radius = parseRadius(c.radius);
    options.clamp = c.clamp;
    const PreprocessReport report = preprocess(readMesh(entry.path()), options).report;
    EXPECT_EQ(report.solids, 1u) << entry.path().filename();
    EXPECT_EQ(report.facets, c.facets) << entry.path().filename();
    EXPECT_EQ(report.roundedEdges, c.edges) << entry.path().filename();
    EXPECT_EQ(report.spheres, c.spheres) << entry.path().filename();
    ++files;
  }
  EXPECT_GE(files, 3u);
}

INSTANTIATE_TEST_SUITE_P(Reports, ReportSolids,
                         testing::Values(ReportCase{"fillet-size-sweep", "2", 0, 6, 12, 8},
                                         ReportCase{"narrow-wedge", "0.004%", 0, 5, 9, 6},
                                         ReportCase{"narrow-wedge", "2%", 0.9, 5, 9, 6},
                                         ReportCase{"thin-turned-bar", "0.3%", 0, 6, 12, 8}));

} // namespace
} // namespace chamfer
