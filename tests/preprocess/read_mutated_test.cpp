// Readers on damaged files: a valid mesh that reads back as itself from OBJ, or Error(Malformed), whatever
// the bytes.
#include "common/error.h"
#include "common/rounding.h"
#include "preprocess/components/solids.h"
#include "preprocess/read/read_formats.h"
#include "tests/support/obj_text.h"

#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <random>

namespace chamfer {
namespace {

void expectValid(const TriangleMesh& mesh) {
  for (const Point3& p : mesh.positions)
    ASSERT_TRUE(isFinite(p));
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t)
      ASSERT_LT(v, mesh.positions.size());
  ASSERT_EQ(mesh.faceOfTriangle.size(), mesh.triangles.size());
  for (const std::uint32_t f : mesh.faceOfTriangle)
    ASSERT_TRUE(mesh.lineOfFace.empty() || f < mesh.lineOfFace.size());
  ASSERT_TRUE(mesh.uvTriangles.empty() || mesh.uvTriangles.size() == mesh.triangles.size());
  for (const auto& t : mesh.uvTriangles)
    for (const std::uint32_t v : t)
      ASSERT_TRUE(v == kNone || v < mesh.uvs.size());
  ASSERT_TRUE(mesh.materialOfTriangle.empty() || mesh.materialOfTriangle.size() == mesh.triangles.size());
  for (const std::string& warning : mesh.warnings)
    ASSERT_EQ(printable(warning, warning.size()), warning);
  ASSERT_TRUE(sameShape(readObj(objText(mesh), "again.obj"), mesh));
}

/// Changes, drops, doubles and swaps in bytes, pieces copied elsewhere, and words that break number parsers.
std::string damaged(std::string text, std::mt19937& random) {
  const char* const kWords[] = {
      "nan", "-1", "1e999", "4294967295", "99999999999999999999", "\n", "\r", "\\\n",  "#",
      "/",   "f ", "v ",    "usemtl x\n", "\xef\xbb\xbf",         " ",  "\0", "ply\n", "solid "};
  for (std::uint32_t n = 1 + random() % 4; n > 0 && !text.empty(); --n) {
    const std::size_t at = random() % text.size(), length = 1 + random() % 12;
    switch (random() % 6) {
    case 0:
      text[at] = char(random());
      break;
    case 1:
      text.erase(at, length);
      break;
    case 2:
      text.insert(random() % text.size(), text.substr(at, length));
      break;
    case 3:
      text.insert(at, kWords[random() % std::size(kWords)]);
      break;
    case 4:
      text.resize(at);
      break;
    case 5:
      text[at] = char(text[at] ^ (1 << random() % 8));
      break;
    }
  }
  return text;
}

void damageManyTimes(const std::string& seed, const std::function<TriangleMesh(const std::string&)>& read) {
  expectValid(read(seed));
  std::mt19937 random(3);
  std::size_t refused = 0, taken = 0;
  for (int round = 0; round < 20000; ++round) {
    const std::string text = damaged(seed, random);
    try {
      const TriangleMesh mesh = read(text);
      expectValid(mesh);
      splitComponents(mesh, {}, 1);
      ++taken;
    } catch (const Error& error) {
      ASSERT_EQ(error.kind(), ErrorKind::Malformed) << error.what() << "\n" << text;
      ++refused;
    }
    if (testing::Test::HasFatalFailure()) FAIL() << text;
  }
  EXPECT_GT(refused, 1000u);
  EXPECT_GT(taken, 100u);
}

TEST(ReadMutated, Obj) {
  damageManyTimes("mtllib none.mtl\no cube\nv 0 0 0 1\nv 1 0 0\nv 0 1.5e0 0\nv 0 0 1 .5 .5 .5\nvt 0 1\nvn 0 "
                  "0 1\nusemtl x\n"
                  "f 1/1/1 3/1 2\nf 1//1 2//1 4//1\nf -4 -1 -2 # c\nf 2 3 \\\n 4\ng a\nl 1 2\n",
                  [](const std::string& text) { return readObj(text, "mutated.obj"); });
}

TEST(ReadMutated, AsciiStl) {
  std::string text = "solid a\n";
  for (int i = 0; i < 4; ++i)
    text += "facet normal 0 0 1\nouter loop\nvertex 0 0 " + std::to_string(i) +
            "\nvertex 1 0 0\nvertex 0 1e0 0\nendloop\nendfacet\n";
  damageManyTimes(text + "endsolid a\n", [](const std::string& t) { return readStl(t, "mutated.stl"); });
}

TEST(ReadMutated, BinaryStl) {
  std::string bytes(84 + 4 * 50, '\1');
  bytes[80] = 4;
  bytes[81] = bytes[82] = bytes[83] = 0;
  damageManyTimes(bytes, [](const std::string& t) { return readStl(t, "mutated.stl"); });
}

TEST(ReadMutated, Off) {
  damageManyTimes(
      "OFF\n4 4 6 # counts\n0 0 0\n1 0 0\n0 1.5 0\n0 0 1\n3 0 2 1\n3 0 1 3 255 0 0\n3 0 3 2\n3 1 2 3\n",
      [](const std::string& text) { return readOff(text, "mutated.off"); });
}

TEST(ReadMutated, Ply) {
  const auto header = [](const std::string& format) {
    return "ply\nformat " + format +
           " 1.0\nelement vertex 3\nproperty float x\nproperty double y\nproperty short z\n"
           "property float s\nproperty float t\nelement face 2\nproperty list uchar int "
           "vertex_indices\nend_header\n";
  };
  const auto read = [](const std::string& text) { return readPly(text, "mutated.ply"); };
  damageManyTimes(header("ascii") + "0 0 0 0 0\n1 0 0 1 0\n0 1 2 0 1\n3 0 1 2\n3 2 1 0\n", read);
  std::string body(3 * (4 + 8 + 2 + 4 + 4), '\0');
  for (int i = 0; i < 2; ++i)
    body += std::string("\3\0\0\0\0\1\0\0\0\2\0\0\0", 13);
  damageManyTimes(header("binary_little_endian") + body, read);
}

} // namespace
} // namespace chamfer
