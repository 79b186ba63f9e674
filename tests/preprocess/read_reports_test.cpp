// Files as people's tools wrote them, beside the project: what their folder's README says is right.
#include "common/error.h"
#include "preprocess/preprocess.h"

#include <filesystem>
#include <gmock/gmock.h>

namespace chamfer {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Matcher;

namespace fs = std::filesystem;
using Warnings = std::vector<std::string>;

const fs::path kReports = CHAMFER_SOURCE_DIR "/../shared/data/reports";

struct Row {
  const char* file;
  std::size_t solids, facets;
  Matcher<Warnings> warnings;
};

const Row kRows[] = {
    {"bad-texture-coordinates/nan.obj", 1, 6, ElementsAre(HasSubstr("line 9: "))},
    {"bad-texture-coordinates/four.obj", 1, 6, ElementsAre(HasSubstr("of 4 numbers"))},
    {"bad-texture-coordinates/huge.obj", 1, 6, ElementsAre(HasSubstr("line 10: "))},
    {"bom/bom-in-obj.obj", 2, 12, IsEmpty()},
    {"bom/bom-in-mtl.obj", 2, 12, IsEmpty()},
    {"continued-lines/plain.obj", 1, 10, IsEmpty()},
    {"continued-lines/crlf.obj", 1, 10, IsEmpty()},
    {"continued-lines/blanks-behind-backslash.obj", 1, 10, IsEmpty()},
    {"exporters-real/real/cube_with_edges.obj", 1, 6,
     ElementsAre(HasSubstr("\"l\" is no part of a surface"), HasSubstr("Ks"))},
    {"exporters-real/real/cube with white spaces.obj", 1, 6, ElementsAre(HasSubstr("Ks"))},
    {"exporters-real/real/hundred_cubes.obj", 100, 600, ElementsAre(HasSubstr("Ks"))},
    {"exporters-real/real/icosahedron.obj", 1, 20, ElementsAre(HasSubstr("newmtl"), HasSubstr("\"Blue\""))},
    {"exporters-real/real/cube_meshlab_ascii.stl", 1, 6, IsEmpty()},
    {"exporters-real/real/cube_meshlab_binary.stl", 1, 6, IsEmpty()},
    {"exporters-real/real/Cube.off", 1, 6, IsEmpty()},
    {"file-names/K\xc3\xbc"
     "che+Flur #3.obj",
     1, 6, IsEmpty()},
    {"file-names/sub dir/Gr\xc3\xb6\xc3\x9f"
     "e 2,5 m.obj",
     1, 6, IsEmpty()},
    {"ply-binary-header/cr.ply", 1, 6, IsEmpty()},
    {"ply-binary-header/cr-body-begins-with-lf.ply", 1, 6, IsEmpty()},
    {"ply-binary-header/crlf-body-begins-with-lf.ply", 1, 6, IsEmpty()},
    {"ply-binary-header/lf-body-begins-with-lf.ply", 1, 6, IsEmpty()},
    {"ply-binary-header/real/cube_binary_starts_with_nl.ply", 1, 6, IsEmpty()},
    {"ply-binary-header/real/cube_rgb_binary.ply", 1, 6,
     ElementsAre(HasSubstr("\"red\", \"green\", \"blue\""))},
    {"ply-values-over-lines/one-line.ply", 1, 6, IsEmpty()},
    {"ply-values-over-lines/scan.ply", 1, 6, ElementsAre(HasSubstr("\"red\""))},
    {"repeated-corners/repeated.obj", 1, 7,
     ElementsAre(HasSubstr("line 11: a face names the same vertex twice"))},
    {"stl-binary-as-written/colour-in-attribute.stl", 1, 8, ElementsAre(HasSubstr("attribute"))},
    {"stl-binary-as-written/count-zero.stl", 1, 8, ElementsAre(HasSubstr("declares 0 facets"))},
    {"stl-binary-as-written/solid-header-trailing.stl", 1, 8, ElementsAre(HasSubstr("2 bytes behind"))},
    {"stl-binary-as-written/trailing-block.stl", 1, 8, ElementsAre(HasSubstr("512 bytes behind"))},
    {"stl-binary-as-written/trailing-newline.stl", 1, 8, ElementsAre(HasSubstr("1 bytes behind"))},
    {"mtl-texture-options/mixed.obj", 1, 6, IsEmpty()},
    {"mtl-texture-options/option-behind.obj", 1, 6, ElementsAre(HasSubstr("-bm has no effect"))},
    {"transparency-keys/d-and-Tr-equal.obj", 1, 6, ElementsAre(HasSubstr("contradict"))},
    {"transparency-keys/halo.obj", 1, 6, ElementsAre(HasSubstr("-halo"))},
    {"transparency-keys/max-d1-Tr0.obj", 1, 6, IsEmpty()},
    {"transparency-keys/Tf.obj", 1, 6, ElementsAre(HasSubstr("Tf (line 5), illum (line 6)"))},
};

TEST(ReadReports, FilesAsToolsWriteThemAreRoundedAndWhatIsDroppedIsNamed) {
  if (!fs::is_directory(kReports)) GTEST_SKIP() << "the reports are not beside the project";
  PreprocessOptions options;
  options.radius = parseRadius("2%");
  for (const Row& row : kRows) {
    SCOPED_TRACE(row.file);
    try {
      const PreprocessReport report = preprocess(readMesh(kReports / row.file), options).report;
      EXPECT_EQ(report.solids, row.solids);
      EXPECT_EQ(report.facets, row.facets);
      EXPECT_THAT(report.warnings, row.warnings);
    } catch (const Error& e) {
      ADD_FAILURE() << e.what();
    }
  }
}

} // namespace
} // namespace chamfer
