#include "tests/preprocess/mesh_files.h"

#include "common/rounding.h"

#include <gmock/gmock.h>

namespace chamfer {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

using ReadObj = MeshFiles;
using Corners = std::array<std::uint32_t, 3>;

const std::string kVertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"; // four lines

TEST_F(ReadObj, FansPolygonsInOrderAndKnowsTheirLines) {
  const TriangleMesh mesh = read("a.obj", kVertices + "# comment\nf 1 2 3 4\n\nf 1 3 2\n");
  EXPECT_THAT(mesh.positions,
              ElementsAre(Point3(0, 0, 0), Point3(1, 0, 0), Point3(0, 1, 0), Point3(0, 0, 1)));
  EXPECT_THAT(mesh.triangles, ElementsAre(Corners{0, 1, 2}, Corners{0, 2, 3}, Corners{0, 2, 1}));
  EXPECT_THAT(mesh.faceOfTriangle, ElementsAre(0, 0, 1));
  EXPECT_THAT(mesh.lineOfFace, ElementsAre(6, 8));
  EXPECT_FALSE(mesh.soup);
  EXPECT_THAT(mesh.warnings, IsEmpty());
}

TEST_F(ReadObj, PolygonsOfMoreThan255CornersStayWhole) {
  std::string text, face = "f";
  for (int i = 0; i < 300; ++i) {
    text += "v " + std::to_string(i) + " 0 0\n";
    face += " " + std::to_string(i + 1);
  }
  EXPECT_EQ(read("a.obj", text + face).triangles.size(), 298u);
}

TEST_F(ReadObj, NegativeIndicesCountBackFromTheFace) {
  const TriangleMesh mesh =
      read("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 0 0\nv 6 0 0\nv 7 0 0\nf -1 -3 1\n");
  EXPECT_THAT(mesh.triangles, ElementsAre(Corners{0, 1, 2}, Corners{5, 3, 0}));
}

TEST_F(ReadObj, TakesTheSyntaxThatExportersWrite) {
  const TriangleMesh plain = read("plain.obj", kVertices + "f 1 2 3\nf 1 3 4\n");
  for (const std::string text : {
           "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nv 0 0 1\r\nf 1 2 3\r\nf 1 3 4\r\n", // CRLF
           "v 0 0 0\rv 1 0 0\rv 0 1 0\rv 0 0 1\rf 1 2 3\rf 1 3 4",             // CR, no end of the last line
           "\xef\xbb\xbfv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 3 4", // byte order mark
           "\tv\t0  0\t0\n  v 1 0 0 \nv +0 1. .0\nv 0e5 -0 1E0\nf  1 2\t3  \n f 1 3 4\n", // blanks, forms of
                                                                                          // numbers
           "v 0 0 0 # a\nv 1 0 0#b\nv 0 1 0\nv 0 0 1\nf 1 2 3 # 4 5\nf 1 3 4#\n",         // comments behind
           "v 0 0 \\\n0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 \\\r\n 2 3\nf 1 3 4\n",           // continued lines
           "v 0 \\  \n 0\\\t\r\n0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3 # a\\\nf 1 3 4 \\", // with blanks
                                                                                          // behind, the
                                                                                          // file's end
           "# C:\\scenes\\\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\n",      // no continuation
           "o a\ng b c\ns off\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\ng\nf 1 3 4\n",
           "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nf 1//1 2//1 3//1\nf 1// 3/ 4\n",
       }) {
    const TriangleMesh mesh = read("a.obj", text);
    EXPECT_EQ(mesh.positions, plain.positions) << text;
    EXPECT_EQ(mesh.triangles, plain.triangles) << text;
    EXPECT_THAT(mesh.warnings, IsEmpty()) << text;
  }
}

TEST_F(ReadObj, LinesAreCountedThroughContinuations) {
  EXPECT_THAT(malformed("a.obj", "v 0 0 \\\n0\nv 1 0 0\nv 0 x 0\n"), StartsWith("a.obj:4: "));
}

TEST_F(ReadObj, SeventeenDigitsGiveTheDoubleThatWroteThem) {
  // Other readers' number parsers return neighbours of these.
  EXPECT_EQ(
      read("a.obj", "v 0.10000000000000001 66.987346820923673 -99.123456789012345\n" + kVertices + "f 1 2 3")
          .positions.front(),
      Point3(0.1, 66.987346820923673, -99.123456789012345));
  EXPECT_EQ(read("a.obj", "v 1e-400 -0.5e-330 4.9e-324\n" + kVertices + "f 1 2 3").positions.front(),
            Point3(0, 0, 4.9e-324));
}

TEST_F(ReadObj, RefusesWhatIsNoNumberWithLineAndToken) {
  for (const char* token :
       {"0,5", "abc", "3.1+e2", "1e", "--1", "+-1", "1.2.3", "0x10", "1e999", "nan", "inf", "1f"}) {
    EXPECT_THAT(malformed("a.obj", kVertices + "v 0 " + token + " 0\nf 1 2 3\n"),
                AllOf(StartsWith("a.obj:5: "), HasSubstr("\"" + std::string(token) + "\"")));
  }
  EXPECT_THAT(malformed("a.obj", "v 0 0\n"), HasSubstr("here are 2 numbers"));
  EXPECT_THAT(malformed("a.obj", "v 0 0 0 0 0\n"), HasSubstr("here are 5 numbers"));
  EXPECT_THAT(malformed("a.obj", "v 0 0 0 red\n"), HasSubstr("\"red\""));
}

TEST_F(ReadObj, RefusesFacesThatNameNoCorners) {
  const auto message = [&](const std::string& face) { return malformed("a.obj", kVertices + face + "\n"); };
  EXPECT_THAT(message("f 1 2"), AllOf(StartsWith("a.obj:5: "), HasSubstr("here are 2")));
  EXPECT_THAT(message("f"), HasSubstr("here are 0"));
  EXPECT_THAT(message("f 1 2 0"), HasSubstr("index 0"));
  EXPECT_THAT(message("f 1 2 5"), AllOf(StartsWith("a.obj:5: "), HasSubstr("5"), HasSubstr("4 vertices")));
  EXPECT_THAT(message("f 1 2 -5"), HasSubstr("-5"));
  EXPECT_THAT(message("f 1 2 99999999999"), HasSubstr("out of range"));
  for (const char* corner : {"1.5", "a", "/1", "1/a", "1/2/3/4", "1/2/x", "//", "1x", "1/1x"})
    EXPECT_THAT(message(std::string("f 1 2 ") + corner), HasSubstr("\"" + std::string(corner) + "\""));
}

TEST_F(ReadObj, RefusesFilesWithoutFaces) {
  EXPECT_THAT(malformed("a.obj", ""), HasSubstr("no faces"));
  EXPECT_THAT(malformed("a.obj", kVertices), HasSubstr("4 vertices"));
  EXPECT_THAT(malformed("a.obj", std::string("\0\x01\x02garbage\xff\n\n", 13)), HasSubstr("no faces"));
  EXPECT_THAT(malformed("a.obj", std::string("\xff\xfev\0 \0", 6)), HasSubstr("UTF-16"));
}

TEST_F(ReadObj, KeepsTextureCoordinatesAndForgivesStrayOnes) {
  const TriangleMesh mesh =
      read("a.obj", kVertices + "vt 0 0\nvt 1\nvt 0 1 0\nf 1/1 2/2 3/3\nf 1 2 4\nf 1/-3 2 3/9\n");
  EXPECT_EQ(mesh.uvs, (std::vector<std::array<float, 2>>{{0, 0}, {1, 0}, {0, 1}}));
  EXPECT_THAT(mesh.uvTriangles,
              ElementsAre(Corners{0, 1, 2}, Corners{kNone, kNone, kNone}, Corners{0, kNone, kNone}));
  EXPECT_THAT(mesh.warnings, ElementsAre(HasSubstr("line 10")));
}

TEST_F(ReadObj, NamesItsExtensionsInAnyCaseAndTellsMissingFiles) {
  EXPECT_EQ(read("A.OBJ", kVertices + "f 1 2 3\n").triangles.size(), 1u);
  EXPECT_THAT(malformed("a.xyz", ""), HasSubstr("\".xyz\""));
  try {
    readMesh(folder_ / "none.obj");
    ADD_FAILURE() << "read a file that does not exist";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::NotFound);
  }
}

TEST_F(ReadObj, DigestIsOfPositionsAndTriangles) {
  const Digest digest = geometryDigest(read("a.obj", kVertices + "f 1 2 3\n"));
  EXPECT_EQ(
      geometryDigest(read("b.obj", "# other words\n" + kVertices + "vt 0 0\nusemtl x\nf 1/1 2/1 3/1\n")),
      digest);
  EXPECT_NE(geometryDigest(read("a.obj", kVertices + "f 1 3 2\n")), digest);
  EXPECT_NE(geometryDigest(read("a.obj", kVertices + "v 0 0 0\nf 1 2 3\n")), digest);
  EXPECT_NE(geometryDigest(read("a.obj", "v 0 0 1e-300\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n")), digest);
}

} // namespace
} // namespace chamfer
