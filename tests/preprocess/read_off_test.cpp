#include "tests/preprocess/mesh_files.h"

#include "common/rounding.h"

#include <gmock/gmock.h>

namespace chamfer {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

using ReadOff = MeshFiles;
using Corners = std::array<std::uint32_t, 3>;

const std::string kVertices = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";

TEST_F(ReadOff, TakesItsManyForms) {
  for (const std::string& text : std::initializer_list<std::string>{
           "OFF\n4 2 0\n" + kVertices + "3 0 1 2\n3 0 2 3\n",
           "OFF 4 2\n" + kVertices + "3 0 1 2\n3 0 2 3",
           "# first\n\n  OFF4 2 6 # counts\n\n" + kVertices +
               "# faces\n3 0 1 2 # one\n3 0 2 3 1 0 0 .5\n\n#end\n",
           "COFF\r\n4 2 0\r\n0 0 0 1 0 0 1\r\n1 0 0 1 0 0 1\r\n0 1 0 nan 0 0 1\r\n0 0 1 1 0 0 1\r\n"
           "3 0 1 2\r\n3 0 2 3 7\r\n",
       }) {
    const TriangleMesh mesh = read("a.off", text);
    EXPECT_THAT(mesh.positions,
                ElementsAre(Point3(0, 0, 0), Point3(1, 0, 0), Point3(0, 1, 0), Point3(0, 0, 1)))
        << text;
    EXPECT_THAT(mesh.triangles, ElementsAre(Corners{0, 1, 2}, Corners{0, 2, 3})) << text;
    EXPECT_FALSE(mesh.soup);
  }
}

TEST_F(ReadOff, TextureAndNormalFormsKeepThePositions) {
  const TriangleMesh st = read("a.off", "STOFF\n3 1 0\n0 0 0 .1 .2\n1 0 0 .1 .2\n0 1 0 .1 .2\n3 0 1 2\n");
  const TriangleMesh stcn =
      read("a.off", "STCNOFF\n3 1 0\n0 0 0 0 0 1 1 1 1 1 .1 .2\n1 0 0 0 0 1 1 1 1 1 .1 .2\n"
                    "0 1 0 0 0 1 1 1 1 1 .1 .2\n3 0 1 2\n");
  EXPECT_EQ(st.positions, stcn.positions);
  EXPECT_EQ(st.positions[1], Point3(1, 0, 0));
}

TEST_F(ReadOff, RefusesOtherSpacesAndBlocks) {
  EXPECT_THAT(malformed("a.off", "4OFF\n"), HasSubstr("three coordinates"));
  EXPECT_THAT(malformed("a.off", "nOFF\n3\n"), HasSubstr("three coordinates"));
  EXPECT_THAT(malformed("a.off", "appearance {\n"),
              AllOf(StartsWith("a.off:1: "), HasSubstr("\"appearance\"")));
  EXPECT_THAT(malformed("a.off", "OFF BINARY\n"), HasSubstr("binary"));
  EXPECT_THAT(malformed("a.off", ""), HasSubstr("empty"));
}

TEST_F(ReadOff, RefusesCountsThatTheFileCannotHoldBeforeItAllocates) {
  EXPECT_THAT(malformed("a.off", "OFF\n353535235358 6 0\n" + kVertices), HasSubstr("\"353535235358\""));
  EXPECT_THAT(malformed("a.off", "OFF\n4 3000000000 0\n" + kVertices), HasSubstr("\"3000000000\""));
  EXPECT_THAT(malformed("a.off", "OFF\n-4 2 0\n" + kVertices), HasSubstr("\"-4\""));
  EXPECT_THAT(malformed("a.off", "OFF\n4\n" + kVertices), HasSubstr("counts"));
}

TEST_F(ReadOff, RefusesBodiesThatAreNotAsCounted) {
  const auto message = [&](const std::string& body) { return malformed("a.off", "OFF\n4 2 0\n" + body); };
  EXPECT_THAT(message("0 0 0\n1 0 0\n"), HasSubstr("after 2 of 4 vertices"));
  EXPECT_THAT(message("0 0 0\n1 0\n"), AllOf(StartsWith("a.off:4: "), HasSubstr("2 numbers")));
  EXPECT_THAT(message("0 0 0 1 0 0\n"), HasSubstr("6 numbers"));
  EXPECT_THAT(message("0 0 0\n1 0,5 0\n"), HasSubstr("\"0,5\""));
  EXPECT_THAT(message("0 0 0\n1 nan 0\n"), HasSubstr("not finite"));
  EXPECT_THAT(message(kVertices + "3 0 1 2\n"), HasSubstr("after 1 of 2 faces"));
  EXPECT_THAT(message(kVertices + "2 0 1\n3 0 1 2\n"), HasSubstr("at least 3 corners"));
  EXPECT_THAT(message(kVertices + "4 0 1 2\n3 0 1 2\n"), HasSubstr("4 corners, but 3 indices"));
  EXPECT_THAT(message(kVertices + "3 0 1 4\n3 0 1 2\n"), AllOf(StartsWith("a.off:7: "), HasSubstr("\"4\"")));
  EXPECT_THAT(message(kVertices + "3 0 1 -2\n3 0 1 2\n"), HasSubstr("\"-2\""));
  EXPECT_THAT(message(kVertices + "3 0 1 2 1 2 3 4 5\n"), HasSubstr("5 numbers behind"));
  EXPECT_THAT(message(kVertices + "3 0 1 2\n3 0 2 3\n3 0 1 3\n"), HasSubstr("behind the last of 2 faces"));
}

TEST_F(ReadOff, TheKeywordMayBeMissing) {
  const TriangleMesh mesh = read("a.off", "4 2 0\n" + kVertices + "3 0 1 2\n3 0 2 3\n");
  EXPECT_EQ(mesh.triangles.size(), 2u);
  EXPECT_THAT(mesh.warnings, ElementsAre(HasSubstr("line 1: the keyword OFF is missing")));
  EXPECT_EQ(read("a.off", "\xef\xbb\xbfOFF\n4 1 0\n" + kVertices + "3 0 1 2\n").triangles.size(), 1u);
}

TEST_F(ReadOff, TextureCoordinatesAreReadAndColoursNamed) {
  const TriangleMesh st = read("a.off", "STOFF\n3 1 0\n0 0 0 .25 .5\n1 0 0 1 nan\n0 1 0 .5 1\n3 0 1 2\n");
  EXPECT_EQ(st.uvs[0], (std::array<float, 2>{0.25f, 0.5f}));
  EXPECT_THAT(st.uvTriangles, ElementsAre(Corners{0, kNone, 2}));
  EXPECT_THAT(st.warnings, ElementsAre(HasSubstr("line 4: a texture coordinate")));
  const TriangleMesh c =
      read("a.off", "COFF\n3 1 0\n0 0 0 1 0 0 1\n1 0 0 1 0 0 1\n0 1 0 1 0 0 1\n3 0 1 2 255 0 0\n");
  EXPECT_THAT(c.warnings, ElementsAre(HasSubstr("line 3: colours of vertices are not used (and 2 more"),
                                      HasSubstr("line 6: colours of faces are not used")));
  EXPECT_TRUE(c.uvs.empty());
  EXPECT_THAT(read("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4 0 1 2 2\n").warnings,
              ElementsAre(HasSubstr("line 6: a face names the same vertex twice")));
}

} // namespace
} // namespace chamfer
