#include "tests/preprocess/mesh_files.h"

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
  EXPECT_THAT(mesh.warnings, IsEmpty());
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
  EXPECT_THAT(message("0 0 0\n" + kBody), AllOf(StartsWith("a.ply:13: vertex 0 of 4"), HasSubstr("fewer")));
  EXPECT_THAT(message("0 0 0 255 1\n" + kBody), HasSubstr("more"));
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
    EXPECT_THAT(malformed("a.ply", head + binaryBody(big, NAN)), HasSubstr("vertex 3 of 4: z is not finite"));
    EXPECT_THAT(malformed("a.ply", head + binaryBody(big, 1, -7)), HasSubstr("face 1 of 2"));
    EXPECT_THAT(malformed("a.ply", head + binaryBody(big).substr(0, 100)), HasSubstr("the file ends in it"));
    EXPECT_THAT(read("a.ply", head + binaryBody(big) + "\n").warnings, ElementsAre(HasSubstr("1 bytes")));
  }
}

} // namespace
} // namespace chamfer
