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
  for (
      const std::string text : {
          "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nv 0 0 1\r\nf 1 2 3\r\nf 1 3 4\r\n", // CRLF
          "v 0 0 0\rv 1 0 0\rv 0 1 0\rv 0 0 1\rf 1 2 3\rf 1 3 4",               // CR, no end of the last line
          "\xef\xbb\xbfv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 3 4",   // byte order mark
          "\tv\t0  0\t0\n  v 1 0 0 \nv +0 1. .0\nv 0e5 -0 1E0\nf  1 2\t3  \n f 1 3 4\n", // blanks, forms of
                                                                                         // numbers
          "v 0 0 0 # a\nv 1 0 0#b\nv 0 1 0\nv 0 0 1\nf 1 2 3 # 4 5\nf 1 3 4#\n",         // comments behind
          "v 0 0 \\\n0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 \\\r\n 2 3\nf 1 3 4\n",           // continued lines
          "# C:\\scenes\\\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\n",      // no continuation
          "v 0 0 0 1\nv 1 0 0 .5 .5 .5\nv 0 1 0 nan nan nan\nv 0 0 1 1 .5 .5 .5\nf 1 2 3\nf 1 3 4\n", // w,
                                                                                                      // colours
          "o a\ng b c\ns off\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl none\nf 1 2 3\ng\nf 1 3 4\n",
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
  // tinyobjloader's own number parser returns neighbours of these.
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
    EXPECT_THAT(malformed("a.obj", kVertices + "vt 0 " + token + "\nf 1 2 3\n"), StartsWith("a.obj:5: "));
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
}

TEST_F(ReadObj, KeepsTextureCoordinatesAndForgivesStrayOnes) {
  const TriangleMesh mesh =
      read("a.obj", kVertices + "vt 0 0\nvt 1\nvt 0 1 0\nf 1/1 2/2 3/3\nf 1 2 4\nf 1/-3 2 3/9\n");
  EXPECT_EQ(mesh.uvs, (std::vector<std::array<float, 2>>{{0, 0}, {1, 0}, {0, 1}}));
  EXPECT_THAT(mesh.uvTriangles,
              ElementsAre(Corners{0, 1, 2}, Corners{kNone, kNone, kNone}, Corners{0, kNone, kNone}));
  EXPECT_THAT(mesh.warnings, ElementsAre(HasSubstr("line 10")));
}

TEST_F(ReadObj, ReadsPastPointsAndLinesWithAWarning) {
  const TriangleMesh mesh = read("a.obj", kVertices + "p 1\nl 1 2\nf 1 2 3\n");
  EXPECT_EQ(mesh.triangles.size(), 1u);
  EXPECT_THAT(mesh.warnings, ElementsAre(AllOf(HasSubstr("line 5"), HasSubstr("1 further"))));
}

TEST_F(ReadObj, BringsMaterialsWithTheirPbrKeys) {
  write("set/with space.mtl", "newmtl red glass\nKd 1 0 0\nPr 0.25\nPm 1\nNi 1.33\nd 0.25\nKe 0 2 0\n"
                              "map_Kd -s 1 1 1 wood.png\nmap_Pr rough.png\nnorm bumps.png\n"
                              "\nnewmtl shiny\r\nNs 30\r\nTr 0.5\r\nmap_Bump old.png\r\n\nnewmtl bare\n");
  const TriangleMesh mesh =
      read("a.obj", "mtllib set/with space.mtl\n" + kVertices +
                        "f 1 2 3\nusemtl red glass\nf 1 2 3 4\nusemtl shiny\nf 1 2 4\n");
  ASSERT_EQ(mesh.materials.size(), 3u);
  const MeshMaterial &glass = mesh.materials[0], &shiny = mesh.materials[1], &bare = mesh.materials[2];
  EXPECT_EQ(glass.name, "red glass");
  EXPECT_THAT(glass.baseColor, ElementsAre(1, 0, 0));
  EXPECT_DOUBLE_EQ(glass.roughness, 0.25);
  EXPECT_DOUBLE_EQ(glass.metallic, 1);
  EXPECT_DOUBLE_EQ(glass.ior, 1.33);
  EXPECT_DOUBLE_EQ(glass.transmission, 0.75);
  EXPECT_THAT(glass.emission, ElementsAre(0, 2, 0));
  EXPECT_EQ(glass.baseColorTexture, "wood.png");
  EXPECT_EQ(glass.roughnessTexture, "rough.png");
  EXPECT_EQ(glass.normalTexture, "bumps.png");
  EXPECT_DOUBLE_EQ(shiny.roughness, std::pow(2.0 / 32, 0.25));
  EXPECT_DOUBLE_EQ(shiny.transmission, 0.5);
  EXPECT_EQ(shiny.normalTexture, "old.png");
  EXPECT_THAT(bare.baseColor, ElementsAre(0.8, 0.8, 0.8));
  EXPECT_DOUBLE_EQ(bare.ior, 1.5);
  EXPECT_THAT(mesh.materialOfTriangle, ElementsAre(kNone, 0, 0, 1));
  EXPECT_THAT(mesh.warnings, IsEmpty());
}

TEST_F(ReadObj, ClampsMaterialValuesOutOfRangeWithAWarning) {
  write("m.mtl", "newmtl a\nKd 2 0 0\nNi 0\n");
  const TriangleMesh mesh = read("a.obj", "mtllib m.mtl\nusemtl a\n" + kVertices + "f 1 2 3\n");
  EXPECT_THAT(mesh.materials[0].baseColor, ElementsAre(1, 0, 0));
  EXPECT_DOUBLE_EQ(mesh.materials[0].ior, 1);
  EXPECT_THAT(mesh.warnings, ElementsAre(HasSubstr("Kd is 2"), HasSubstr("Ni is 0")));
}

TEST_F(ReadObj, MissingAndForeignMaterialLibrariesAreWarnings) {
  write("secret.mtl", "newmtl a\nKd 1 1 1\n");
  const std::string outside = "../" + folder_.filename().string() + "/secret.mtl";
  for (const std::string& library :
       {std::string("gone.mtl"), outside, (folder_ / "secret.mtl").string(), std::string(".")}) {
    const TriangleMesh mesh = read("a.obj", "mtllib " + library + "\nusemtl a\n" + kVertices + "f 1 2 3\n");
    EXPECT_THAT(mesh.materials, IsEmpty()) << library;
    EXPECT_THAT(mesh.materialOfTriangle, IsEmpty()) << library;
    EXPECT_THAT(mesh.warnings, ElementsAre(HasSubstr("material library"))) << library;
  }
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
