#include "common/error.h"
#include "common/text.h"
#include "preprocess/read/read_formats.h"
#include "tests/preprocess/mesh_files.h"

#include "common/rounding.h"

#include <bit>
#include <cstring>
#include <gmock/gmock.h>

namespace chamfer {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

using ReadPly = MeshFiles;
using Corners = std::array<std::uint32_t, 3>;

std::string header(const std::string& format, const std::string& vertices = "4",
                   const std::string& faces = "2") {
  return "ply\nformat " + format + " 1.0\ncomment made by hand\nelement vertex " + vertices +
         "\nproperty float x\nproperty float y\nproperty double z\nproperty uchar red\nelement face " +
         faces + "\nproperty list uchar int vertex_indices\nproperty list short float weights\nend_header\n";
}
constexpr std::size_t kHeaderLines = 12;

const std::string kVertexLines = "0 0 0 255\n1 0 0 255\n0 1 0 255\n0 0 1.5 255\n";
const std::string kBody = kVertexLines + "3 0 2 1 0\n4 0 1 2 3 2 .5 .5\n";

class Bytes {
public:
  explicit Bytes(bool big) : big_(big) {}
  template <class T>
  Bytes& put(T value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    if (big_ != (std::endian::native == std::endian::big)) std::reverse(raw, raw + sizeof value);
    text.append(raw, sizeof value);
    return *this;
  }
  std::string text;

private:
  bool big_;
};

std::string binaryBody(bool big, float z = 1.5f, std::int32_t index = 3) {
  Bytes b(big);
  for (int i = 0; i < 4; ++i)
    b.put(float(i == 1)).put(float(i == 2)).put(i == 3 ? double(z) : 0.0).put(std::uint8_t(255));
  b.put(std::uint8_t(3)).put(std::int32_t(0)).put(std::int32_t(2)).put(std::int32_t(1)).put(std::int16_t(0));
  b.put(std::uint8_t(4)).put(std::int32_t(0)).put(std::int32_t(1)).put(std::int32_t(2)).put(index);
  b.put(std::int16_t(2)).put(0.5f).put(0.5f);
  return b.text;
}

void expectTheMesh(const TriangleMesh& mesh) {
  EXPECT_THAT(mesh.positions,
              ElementsAre(Point3(0, 0, 0), Point3(1, 0, 0), Point3(0, 1, 0), Point3(0, 0, 1.5)));
  EXPECT_THAT(mesh.triangles, ElementsAre(Corners{0, 2, 1}, Corners{0, 1, 2}, Corners{0, 2, 3}));
  EXPECT_THAT(mesh.faceOfTriangle, ElementsAre(0, 1, 1));
  EXPECT_THAT(mesh.warnings, ElementsAre("line 4: properties of \"vertex\" that are not used: \"red\"",
                                         "line 9: properties of \"face\" that are not used: \"weights\""));
}

TEST_F(ReadPly, AllThreeEncodingsGiveTheSameMesh) {
  const TriangleMesh ascii = read("a.ply", header("ascii") + kBody);
  expectTheMesh(ascii);
  EXPECT_THAT(ascii.lineOfFace, ElementsAre(kHeaderLines + 5, kHeaderLines + 6));
  expectTheMesh(read("l.ply", header("binary_little_endian") + binaryBody(false)));
  expectTheMesh(read("b.ply", header("binary_big_endian") + binaryBody(true)));
}

TEST_F(ReadPly, TakesOtherNamesOrdersAndElements) {
  const TriangleMesh mesh =
      read("a.ply", "ply\r\nformat ascii 1.0\r\nelement camera 1\r\nproperty list uint8 int8 k\r\n"
                    "element vertex 3\r\nproperty int z\r\nproperty float32 y\r\nproperty float64 x\r\n"
                    "property float s\r\nproperty float t\r\nelement face 1\r\n"
                    "property list uint8 uint32 vertex_index\r\nelement edge 1\r\nproperty int a\r\n"
                    "end_header\r\n2 1 1\r\n\r\n0 0 0 0 0\r\n0 0 1 1 0\r\n0 1 0 0 1\r\n3 0 1 2\r\n7\r\n");
  EXPECT_THAT(mesh.positions, ElementsAre(Point3(0, 0, 0), Point3(1, 0, 0), Point3(0, 1, 0)));
  EXPECT_EQ(mesh.uvs, (std::vector<std::array<float, 2>>{{0, 0}, {1, 0}, {0, 1}}));
  EXPECT_THAT(mesh.uvTriangles, ElementsAre(Corners{0, 1, 2}));
}

TEST_F(ReadPly, RefusesBadHeaders) {
  EXPECT_THAT(malformed("a.ply", ""), HasSubstr("end_header"));
  EXPECT_THAT(malformed("a.ply", "solid\n"), StartsWith("a.ply:1: "));
  EXPECT_THAT(malformed("a.ply", "ply\nend_header\n"), HasSubstr("no format"));
  EXPECT_THAT(malformed("a.ply", header("ascii2") + kBody), HasSubstr("\"ascii2\""));
  EXPECT_THAT(malformed("a.ply", header("ascii", "-4") + kBody), HasSubstr("\"-4\""));
  EXPECT_THAT(malformed("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n0\n"),
              AllOf(StartsWith("a.ply:4: "), HasSubstr("property quad x")));
  EXPECT_THAT(
      malformed("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n"),
      HasSubstr("no properties x, y and z"));
}

TEST_F(ReadPly, RefusesCountsThatTheFileCannotHoldBeforeItAllocates) {
  for (const char* format : {"ascii", "binary_little_endian"})
    for (const char* count : {"4000000000", "99999"}) {
      EXPECT_THAT(malformed("a.ply", header(format, count) + kBody), HasSubstr(count));
      EXPECT_THAT(
          malformed("a.ply", header(format, "4", count) + (*format == 'a' ? kBody : binaryBody(false))),
          HasSubstr(count));
    }
  EXPECT_THAT(malformed("a.ply", header("ascii", "99999999999") + kBody), HasSubstr("above"));
}

TEST_F(ReadPly, RefusesBodiesThatAreNotAsDeclared) {
  const auto message = [&](const std::string& body) { return malformed("a.ply", header("ascii") + body); };
  // A value too few or too many shifts all that follow: the line where it began is named.
  const std::string odd = "the first line with more or less than one element is line 13";
  EXPECT_THAT(message("0 0 0\n" + kBody), HasSubstr(odd));
  EXPECT_THAT(message("0 0 0 255 1\n" + kBody), HasSubstr(odd));
  EXPECT_THAT(message("0 0 0 255\n1 0,5 0 255\n" + kBody),
              AllOf(StartsWith("a.ply:14: "), HasSubstr("\"0,5\"")));
  EXPECT_THAT(message("0 0 0 255\n1 inf 0 255\n" + kBody), HasSubstr("not finite"));
  EXPECT_THAT(message(kVertexLines + "2 0 1 0\n3 0 1 2 0\n"), HasSubstr("at least 3 corners"));
  EXPECT_THAT(message(kVertexLines + "3 0 1 4 0\n3 0 1 2 0\n"), HasSubstr("0 to 3"));
  EXPECT_THAT(message(kVertexLines + "3 0 1 -1 0\n3 0 1 2 0\n"), HasSubstr("0 to 3"));
  EXPECT_THAT(message(kVertexLines + "3 0 1 1.5 0\n3 0 1 2 0\n"), HasSubstr("whole"));
  EXPECT_THAT(message(kBody + "3 0 1 2 0\n"), HasSubstr("behind the last"));
  EXPECT_THAT(message(kVertexLines + "3 0 2 1 0\n"), HasSubstr("ends"));
}

TEST_F(ReadPly, RefusesBinaryThatEndsEarlyOrHoldsNoFiniteNumber) {
  for (const bool big : {false, true}) {
    const std::string head = header(big ? "binary_big_endian" : "binary_little_endian");
    EXPECT_THAT(malformed("a.ply", head + binaryBody(big, NAN)),
                HasSubstr("\"vertex\" 3 of 4: z is not finite"));
    EXPECT_THAT(malformed("a.ply", head + binaryBody(big, 1, -7)), HasSubstr("\"face\" 1 of 2"));
    EXPECT_THAT(malformed("a.ply", head + binaryBody(big).substr(0, 100)), HasSubstr("the file ends in it"));
    EXPECT_THAT(read("a.ply", head + binaryBody(big) + "\n").warnings,
                testing::Contains(HasSubstr("1 bytes")));
  }
}

TEST_F(ReadPly, TheAsciiBodyIsAStreamOfNumbers) {
  const TriangleMesh plain = read("a.ply", header("ascii") + kBody);
  std::string oneLine = kBody, onePerLine = kBody;
  std::replace(oneLine.begin(), oneLine.end(), '\n', ' ');
  std::replace(onePerLine.begin(), onePerLine.end(), ' ', '\n');
  for (const std::string& body :
       {oneLine, onePerLine, "\n\n" + kBody + "\n\n", "0 0 0\n255 1 0 0 255\n" + kBody.substr(20)}) {
    const TriangleMesh mesh = read("a.ply", header("ascii") + body);
    EXPECT_EQ(mesh.positions, plain.positions) << body;
    EXPECT_EQ(mesh.triangles, plain.triangles) << body;
    EXPECT_EQ(mesh.warnings, plain.warnings) << body;
  }
  EXPECT_THAT(read("a.ply", header("ascii") + onePerLine).lineOfFace, ElementsAre(29, 34))
      << "where a face begins";
}

std::string small(const std::string& more, const std::string& body, const std::string& vertex = "") {
  return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n" +
         vertex + more + "end_header\n" + body;
}
const std::string kFace = "element face 1\nproperty list uchar int vertex_indices\n";
const std::string kThree = "0 0 0\n1 0 0\n0 1 0\n";

TEST_F(ReadPly, WhatIsNotUsedIsNamed) {
  const struct {
    std::string text, warning;
  } kRows[] = {
      {small(kFace, kThree + "3 0 1 2\n"), ""},
      {small(kFace, "0 0 0 0 0 1\n1 0 0 0 nan 1\n0 1 0 0 0 1\n3 0 1 2\n",
             "property float nx\nproperty float ny\nproperty float nz\n"),
       ""}, // the rounding has its own normals
      {small("comment TextureFile a.png\n" + kFace, kThree + "3 0 1 2\n"), "line 7: the texture"},
      {small("obj_info made by hand\n" + kFace, kThree + "3 0 1 2\n"), ""},
      {small(kFace + "property uchar red\nproperty list uchar int neighbours\n",
             kThree + "3 0 1 2 7 2 0 0\n"),
       "line 7: properties of \"face\" that are not used: \"red\", \"neighbours\""},
      {small(kFace + "element edge 1\nproperty int vertex1\nproperty int vertex2\n",
             kThree + "3 0 1 2\n0 1\n"),
       "line 9: 1 elements \"edge\" are not used"},
      {small(kFace + "element edge 0\nproperty int vertex1\n", kThree + "3 0 1 2\n"), ""},
      {small(kFace + "element vertex 1\nproperty float x\n", kThree + "3 0 1 2\n9\n"),
       "line 9: 1 elements \"vertex\""},
      {small(kFace, "0 0 0 0 0\n1 0 0 nan 0\n0 1 0 0 1\n3 0 1 2\n", "property float s\nproperty float t\n"),
       "line 13: a texture coordinate is not finite"},
      {small("element face 1\nproperty list uchar int vertex_indices\n", kThree + "4 0 1 2 2\n"),
       "line 13: a face names the same vertex twice"},
  };
  for (const auto& row : kRows) {
    SCOPED_TRACE(row.text);
    const TriangleMesh mesh = read("a.ply", row.text);
    EXPECT_EQ(mesh.triangles[0], (Corners{0, 1, 2}));
    if (row.warning.empty())
      EXPECT_THAT(mesh.warnings, IsEmpty());
    else
      EXPECT_THAT(mesh.warnings, ElementsAre(StartsWith(row.warning)));
  }
}

TEST_F(ReadPly, FacesMayStandBeforeTheirVertices) {
  const std::string text =
      "ply\nformat ascii 1.0\n" + kFace +
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  EXPECT_THAT(read("a.ply", text + "3 0 2 1\n" + kThree).triangles, ElementsAre(Corners{0, 2, 1}));
  EXPECT_THAT(malformed("a.ply", text + "3 0 3 1\n" + kThree), HasSubstr("from 0 to 2"));
}

TEST_F(ReadPly, TextureCoordinatesOfVerticesOrOfCorners) {
  const TriangleMesh wedges = read(
      "a.ply",
      small("element face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n",
            kThree + "3 0 1 2 6 0 0 1 0 nan 1\n3 0 2 1 0\n"));
  EXPECT_EQ(wedges.uvs.size(), 3u);
  EXPECT_THAT(wedges.uvTriangles, ElementsAre(Corners{0, 1, kNone}, Corners{kNone, kNone, kNone}));
  for (const std::string& names : std::initializer_list<std::string>{"u v", "s t", "texture_u texture_v"}) {
    const std::size_t blank = names.find(' ');
    const TriangleMesh mesh = read("a.ply", small(kFace, "0 0 0 0 .5\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n",
                                                  "property float " + names.substr(0, blank) +
                                                      "\nproperty float " + names.substr(blank + 1) + "\n"));
    EXPECT_EQ(mesh.uvs, (std::vector<std::array<float, 2>>{{0, 0.5f}, {1, 0}, {0, 1}})) << names;
    EXPECT_THAT(mesh.uvTriangles, ElementsAre(Corners{0, 1, 2}));
    EXPECT_THAT(mesh.warnings, IsEmpty());
  }
}

TEST_F(ReadPly, TriangleStripsTurnEverySecondTriangle) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n";
  const std::string vertices = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n";
  EXPECT_THAT(read("a.ply", head + vertices + "9 0 1 2 3 -1 3 2 1 -1\n").triangles,
              ElementsAre(Corners{0, 1, 2}, Corners{2, 1, 3}, Corners{3, 2, 1}));
  EXPECT_THAT(malformed("a.ply", head + vertices + "3 0 1 4\n"), HasSubstr("vertex index 4"));
  EXPECT_THAT(malformed("a.ply", head + vertices + "3 0 1 -2\n"), HasSubstr("vertex index -2"));
}

TEST_F(ReadPly, TheEndOfTheHeaderIsOneEndOfALineOfItsKind) {
  // The body's first byte is a "\n" (float 1.4e-44, little-endian).
  for (const std::string& end : std::initializer_list<std::string>{"\n", "\r\n", "\r"}) {
    std::string head =
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    for (std::size_t at = head.find('\n'); at != std::string::npos; at = head.find('\n', at + end.size()))
      head.replace(at, 1, end);
    Bytes body(false);
    const float first = std::bit_cast<float>(std::uint32_t{10});
    body.put(first).put(0.f).put(0.f).put(1.f).put(0.f).put(0.f).put(0.f).put(1.f).put(0.f);
    body.put(std::uint8_t(3)).put(std::int32_t(0)).put(std::int32_t(1)).put(std::int32_t(2));
    const TriangleMesh mesh = read("a.ply", head + body.text);
    EXPECT_EQ(mesh.positions[0], Point3(first, 0, 0));
    EXPECT_THAT(mesh.warnings, IsEmpty());
  }
}

TEST_F(ReadPly, CoordinatesThatAreListsAreRefused) {
  EXPECT_THAT(
      malformed("a.ply",
                "ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar float x\nproperty float y\n"
                "property float z\nend_header\n1 0 0 0\n"),
      HasSubstr("x, y and z that are numbers"));
}

TEST(PlyMessages, ShowNoBytesOfNamesThatTheFileMadeUp) {
  try {
    readPly("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
            "property float \xd7\x1b[2J\nend_header\n0 0 0 one\n",
            "bad.ply");
    FAIL() << "read";
  } catch (const Error& e) {
    EXPECT_EQ(printable(e.what(), 1000), e.what());
  }
}

} // namespace
} // namespace chamfer
