#include "tests/preprocess/mesh_files.h"

#include <cstring>
#include <gmock/gmock.h>

namespace chamfer {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

using ReadStl = MeshFiles;

const std::string kFacet =
    "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 .5\nendloop\nendfacet\n";

std::string binary(const std::string& header, std::uint32_t claimed,
                   const std::vector<std::array<float, 9>>& facets) {
  std::string bytes = header;
  bytes.resize(80, ' ');
  bytes.append(reinterpret_cast<const char*>(&claimed), 4);
  for (const auto& facet : facets) {
    bytes.append(12, '\0');
    bytes.append(reinterpret_cast<const char*>(facet.data()), sizeof facet);
    bytes.append(2, '\0');
  }
  return bytes;
}

TEST_F(ReadStl, AsciiIsASoupOfThreePositionsAFacet) {
  const TriangleMesh mesh = read("a.stl", "solid name with words\n" + kFacet + kFacet + "endsolid\n");
  EXPECT_TRUE(mesh.soup);
  ASSERT_EQ(mesh.triangles.size(), 2u);
  ASSERT_EQ(mesh.positions.size(), 6u);
  EXPECT_EQ(mesh.positions[5], Point3(0, 1, 0.5));
  EXPECT_THAT(mesh.lineOfFace, testing::ElementsAre(4, 11));
}

TEST_F(ReadStl, AsciiInCapitalsWithSeveralSolidsAndAnyNormals) {
  const TriangleMesh mesh =
      read("a.stl", "  SOLID\r\nFacet NORMAL nan -1.#IND x\r\n  OUTER Loop\r\n\tVERTEX 0 0 0\r\n"
                    "VERTEX 1 0 0\r\nVERTEX 0 1 0\r\nENDLOOP\r\nENDFACET\r\nENDSOLID\r\n\r\n"
                    "solid b\n" +
                        kFacet + "endsolid b");
  EXPECT_EQ(mesh.triangles.size(), 2u);
}

TEST_F(ReadStl, BinaryIsToldByItsSizeEvenWhenItSaysSolid) {
  const TriangleMesh mesh = read("a.stl", binary("solid", 1, {{0, 0, 0, 1, 0, 0, 0, 1, 0.5f}}));
  ASSERT_EQ(mesh.triangles.size(), 1u);
  EXPECT_EQ(mesh.positions[2], Point3(0, 1, 0.5));
}

TEST_F(ReadStl, RefusesBinaryOfAnotherSizeOrWithoutFiniteNumbers) {
  EXPECT_THAT(malformed("a.stl", binary("x", 2, {{}})), AllOf(HasSubstr("134 bytes"), HasSubstr("184")));
  EXPECT_THAT(malformed("a.stl", binary("x", 0xffffffffu, {{}})), HasSubstr("4294967295 facets"));
  EXPECT_THAT(malformed("a.stl", binary("x", 1, {{0, 0, 0, NAN, 0, 0, 0, 1, 0}})),
              HasSubstr("facet 0 (byte 84)"));
  EXPECT_THAT(malformed("a.stl", binary("x", 1, {{0, 0, 0, 1, 0, 0, 0, 1, INFINITY}})),
              HasSubstr("not finite"));
  EXPECT_THAT(malformed("a.stl", binary("x", 0, {})), HasSubstr("no faces"));
  EXPECT_THAT(malformed("a.stl", "short"), HasSubstr("shorter"));
}

TEST_F(ReadStl, RefusesDamagedAsciiWithLineAndWord) {
  const auto message = [&](std::string facet, const char* what, const char* with) {
    facet.replace(facet.find(what), std::strlen(what), with);
    return malformed("a.stl", "solid\n" + facet + "endsolid\n");
  };
  EXPECT_THAT(message(kFacet, "1 0 0", "1 blah 0"), AllOf(StartsWith("a.stl:5: "), HasSubstr("\"blah\"")));
  EXPECT_THAT(message(kFacet, "1 0 0", "1 0"), HasSubstr("here are 2 words"));
  EXPECT_THAT(message(kFacet, "1 0 0", "1 0 0 0"), HasSubstr("here are 4 words"));
  EXPECT_THAT(message(kFacet, "endloop", "vertex 1 1 1\nendloop"), StartsWith("a.stl:7: \"vertex\""));
  EXPECT_THAT(message(kFacet, "endfacet\n", ""), HasSubstr("\"endsolid\""));
  EXPECT_THAT(message(kFacet, "outer loop", "outer"), StartsWith("a.stl:3: "));
  EXPECT_THAT(malformed("a.stl", "solid\n" + kFacet), HasSubstr("truncated"));
  EXPECT_THAT(malformed("a.stl", "solid\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\n"),
              HasSubstr("truncated"));
  EXPECT_THAT(malformed("a.stl", "solid\nendsolid\n"), HasSubstr("no faces"));
}

} // namespace
} // namespace chamfer
