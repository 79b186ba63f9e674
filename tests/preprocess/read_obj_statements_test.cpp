// What becomes of each statement of OBJ: one row a statement or a variant of it. None of them changes the
// shape.
#include "tests/preprocess/mesh_files.h"

#include "common/rounding.h"

#include <gmock/gmock.h>

namespace chamfer {
namespace {

using testing::AllOf;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

using ReadObjStatements = MeshFiles;

const std::string kVertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"; // four lines
const std::string kFaces = "f 1 2 3\nf 1 3 4\n";

struct Row {
  std::string statement; ///< stands in line 5
  std::string warning;   ///< what the one warning says; empty: there is none
};

const Row kRows[] = {
    // Names, groups, normals and smoothing.
    {"# a comment \\", ""},
    {"g", ""},
    {"g left front", ""},
    {"o \xc3\xa9lan", ""},
    {"s 1", ""},
    {"s off", ""},
    {"mg 1 0.5", ""},
    {"vn 0 0 1", ""},
    {"vn nan 0", ""},
    {"vn", ""},
    // Texture coordinates that no face names are silent only when they are what they should be.
    {"vt 0", ""},
    {"vt 0 1", ""},
    {"vt 0 1 0 # w", ""},
    {"vt 0 1 0 1", "texture coordinate of 4 numbers"},
    {"vt 0 nan", "\"0 nan\" is no pair of finite numbers"},
    {"vt -nan(ind) 0", "no pair of finite numbers"},
    {"vt 1e39 0", "no pair of finite numbers"}, // beyond float
    {"vt 0,5 1", "\"0,5 1\""},
    {"vt", "no pair of finite numbers"},
    // Vertices with more than a place.
    {"v 1 1 1 1", ""},
    {"v 1 1 1 2", "weight \"2\""},
    {"v 1 1 1 1 0 0", "colours of vertices"},
    {"v 1 1 1 255 0 0 255", "colours of vertices"},
    {"v 1 1 1 1 .5 .5 .5 1", "colours of vertices"},
    {"v 1 1 1 nan nan nan", "colours of vertices"},
    // Points and lines.
    {"p 1", "\"p\" is no part of a surface"},
    {"l 1 2 3", "\"l\" is no part of a surface"},
    {"l 1/1 2/2", "\"l\" is no part of a surface"},
    // Display.
    {"bevel off", ""},
    {"bevel on", "\"bevel\" is not used"},
    {"c_interp off", ""},
    {"c_interp on", "\"c_interp\""},
    {"d_interp on", "\"d_interp\""},
    {"lod 0", ""},
    {"lod 5", "\"lod\""},
    // Free-form curves and surfaces, with the superseded statements.
    {"vp 0.3 0.5", "\"vp\" belongs to a free-form"},
    {"cstype rat bspline", "\"cstype\""},
    {"deg 3 3", "\"deg\""},
    {"bmat u 1 0 0 1", "\"bmat\""},
    {"step 1 2", "\"step\""},
    {"curv 0 1 1 2 3", "\"curv\""},
    {"curv2 1 2", "\"curv2\""},
    {"surf 0 1 0 1 1 2 3 4", "\"surf\""},
    {"parm u 0 1", "\"parm\""},
    {"trim 0 1 1", "\"trim\""},
    {"hole 0 1 1", "\"hole\""},
    {"scrv 0 1 1", "\"scrv\""},
    {"sp 1", "\"sp\""},
    {"end", "\"end\""},
    {"con 1 0 1 1 2 0 1 1", "\"con\""},
    {"ctech cparm 1", "\"ctech\""},
    {"stech cparma 1 1", "\"stech\""},
    {"bsp 1 2 3", "\"bsp\""},
    {"bzp 1 2 3", "\"bzp\""},
    {"cdc 1 2 3", "\"cdc\""},
    {"cdp 1 2 3", "\"cdp\""},
    {"res 4 4", "\"res\""},
    // Other files and commands.
    {"call part.obj 1", "\"call\" is not followed"},
    {"csh -rm *", "\"csh\" is not followed: no other file is read for it and no command run"},
    {"shadow_obj a.obj", "\"shadow_obj\""},
    {"trace_obj a.obj", "\"trace_obj\""},
    {"maplib a.map", "\"maplib\""},
    {"usemap a", "\"usemap\""},
    // Materials.
    {"mtllib", ""},
    {"mtllib none.mtl", "material library \"none.mtl\" is not there"},
    {"usemtl", ""},
    {"usemtl red", "material \"red\" is used, but the file names no material library"},
    {"mtllib none.mtl \\\n", "material library \"none.mtl\""},
    // What is no OBJ.
    {"facet normal 0 0 1", "\"facet\" is no statement of OBJ"},
    {"newmtl red", "\"newmtl\" is no statement of OBJ"},
    {std::string("\x01\x02\xff\0", 4), R"("\x01\x02\xff\x00" is no statement)"},
    // Faces.
    {"fo 1 2 4", ""},
    {"f 1/ 2// 4", ""},
    {"f 1//9 2//9 4//9", ""}, // normals that are not there are not asked for
    {"f 1/1 2/1 4/1", "names a texture coordinate that the file does not have"},
    {"f 1/0/1 2/0/1 4/0/1", "names a texture coordinate that the file does not have"},
    {"f 1/-1 2 4", "names a texture coordinate that the file does not have"},
    {"f 1 1 2 4", "names the same vertex twice in a row"},
    {"f 1 2 4 1", "names the same vertex twice in a row"},
};

TEST_F(ReadObjStatements, EachIsUsedWarnedOfByLineOrSilent) {
  for (const Row& row : kRows) {
    SCOPED_TRACE(row.statement);
    const TriangleMesh mesh = read("a.obj", kVertices + row.statement + "\n" + kFaces);
    ASSERT_GE(mesh.positions.size(), 4u);
    ASSERT_GE(mesh.triangles.size(), 2u);
    EXPECT_EQ(mesh.triangles[mesh.triangles.size() - 2], (std::array<std::uint32_t, 3>{0, 1, 2}));
    EXPECT_EQ(mesh.triangles.back(), (std::array<std::uint32_t, 3>{0, 2, 3}));
    if (row.warning.empty()) {
      EXPECT_THAT(mesh.warnings, IsEmpty());
    } else {
      ASSERT_FALSE(mesh.warnings.empty());
      EXPECT_THAT(mesh.warnings[0], AllOf(StartsWith("line 5: "), HasSubstr(row.warning)));
    }
    EXPECT_TRUE(mesh.materialOfTriangle.empty());
    EXPECT_TRUE(mesh.uvTriangles.empty()) << "no corner has a coordinate";
    EXPECT_TRUE(mesh.uvs.empty());
  }
}

TEST_F(ReadObjStatements, AKindIsToldOnceWithItsNumber) {
  const TriangleMesh mesh = read("a.obj", kVertices + "l 1 2\np 1\nl 2 3\nl 3 4\n" + kFaces);
  EXPECT_THAT(mesh.warnings,
              ElementsAre(AllOf(StartsWith("line 5: \"l\""), HasSubstr("(and 2 more of this kind)")),
                          StartsWith("line 6: \"p\"")));
}

TEST_F(ReadObjStatements, WarningsAreBoundedInNumberAndLength) {
  std::string text = kVertices + kFaces;
  for (const Row& row : kRows)
    text += row.statement.find("\\\n") == std::string::npos ? row.statement + "\n" : "";
  for (int i = 0; i < 1000; ++i)
    text += "mtllib " + std::to_string(i) + ".mtl\n" + std::string(1000, 'x') + " 1\n";
  const TriangleMesh mesh = read("a.obj", text);
  ASSERT_EQ(mesh.warnings.size(), 21u);
  EXPECT_THAT(mesh.warnings.back(), AllOf(StartsWith("and "), HasSubstr(" more")));
  EXPECT_THAT(mesh.warnings,
              Each(testing::ResultOf([](const std::string& w) { return w.size(); }, testing::Lt(400u))));
}

TEST_F(ReadObjStatements, CornersKeepTheCoordinatesThatAreGood) {
  const TriangleMesh mesh =
      read("a.obj", kVertices + "vt 0 0\nvt nan 0\nvt .5 1\nf 1/1 2/2 3/3\nf 1/1 3/-1 4/-2\n");
  EXPECT_THAT(mesh.uvTriangles, ElementsAre(std::array<std::uint32_t, 3>{0, kNone, 2},
                                            std::array<std::uint32_t, 3>{0, 2, kNone}));
  for (const auto& uv : mesh.uvs)
    EXPECT_TRUE(std::isfinite(uv[0]) && std::isfinite(uv[1]));
}

TEST_F(ReadObjStatements, FacesMayStandBeforeTheirVertices) {
  const TriangleMesh mesh =
      read("a.obj", "f 1/1 2/2 3/3\n" + kVertices + "vt 0 0\nvt 1 0\nvt 0 1\nf -4 -3 -1\n");
  EXPECT_EQ(mesh.triangles[0], (std::array<std::uint32_t, 3>{0, 1, 2}));
  EXPECT_EQ(mesh.triangles[1], (std::array<std::uint32_t, 3>{0, 1, 3}));
  EXPECT_THAT(mesh.uvTriangles[0], ElementsAre(0, 1, 2));
  EXPECT_THAT(malformed("a.obj", "f 1 2 9\n" + kVertices),
              AllOf(StartsWith("a.obj:1: "), HasSubstr("vertex index 9")));
}

} // namespace
} // namespace chamfer
