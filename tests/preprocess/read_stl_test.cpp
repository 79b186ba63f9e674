#include "tests/preprocess/mesh_files.h"

#include "common/text.h"

#include <cstring>
#include <gmock/gmock.h>
#include <random>

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
  EXPECT_THAT(message(kFacet, "1 0 0", "1 0"),
              AllOf(StartsWith("a.stl:6: "), HasSubstr("\"vertex\" is not a number")));
  EXPECT_THAT(message(kFacet, "1 0 0", "1 0 0 0"), HasSubstr("\"0\" where \"vertex\" should be"));
  EXPECT_THAT(message(kFacet, "1 0 0", "1 inf 0"), HasSubstr("not finite"));
  EXPECT_THAT(message(kFacet, "endloop", "vertex 1 1 1\nendloop"), StartsWith("a.stl:7: \"vertex\""));
  EXPECT_THAT(message(kFacet, "endfacet\n", ""), HasSubstr("\"endsolid\""));
  EXPECT_THAT(message(kFacet, "outer loop", "outer"), StartsWith("a.stl:4: \"vertex\" where \"loop\""));
  EXPECT_THAT(message(kFacet, "normal 0 0 0", "normal 0 0 0 0"), HasSubstr("\"0\" where \"outer\""));
  EXPECT_THAT(malformed("a.stl", "solid\n" + kFacet), HasSubstr("truncated"));
  EXPECT_THAT(malformed("a.stl", "solid\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\n"),
              HasSubstr("truncated"));
  EXPECT_THAT(malformed("a.stl", "solid\nendsolid\n"), HasSubstr("no faces"));
}

TEST_F(ReadStl, AsciiWordsMayStandOnAnyLines) {
  std::string text = kFacet + kFacet;
  std::replace(text.begin(), text.end(), '\n', ' ');
  for (const std::string& solid :
       {"solid\n" + text + "\nendsolid a b\n", "\xef\xbb\xbfsolid a b\n" + text + "endsolid",
        "solid facet normal\n" + kFacet + "endsolid\n\nsolid\n" + kFacet + "endsolid\n"})
    EXPECT_EQ(read("a.stl", solid).triangles.size(), 2u) << solid;
}

const std::array<float, 9> kOne{0, 0, 0, 1, 0, 0, 0, 1, 0};

TEST_F(ReadStl, BinaryIsReadAsWrittenWithAWarning) {
  std::string coloured = binary("a", 2, {kOne, kOne}),
              materialise = binary("COLOR=\xff\x80\x40\xff", 2, {kOne, kOne});
  coloured[84 + 48] = '\x1f';
  coloured[84 + 49] = '\x80';
  const struct {
    std::string bytes, warning;
  } kRows[] = {
      {binary("a", 2, {kOne, kOne}), ""},
      {binary("solid a", 2, {kOne, kOne}), ""},
      {binary("solid a", 2, {kOne, kOne}) + "\n", "1 bytes behind the last of 2 facets are not read"},
      {binary("a", 2, {kOne, kOne}) + std::string(512, '\0'), "512 bytes behind"},
      {binary("a", 2, {kOne, kOne, kOne}), "50 bytes behind"},
      {binary("a", 0, {kOne, kOne}), "declares 0 facets; the 2 behind it are read"},
      {binary("solid a", 0, {kOne, kOne}), "declares 0 facets"},
      {coloured, "1 facets have an attribute"},
      {materialise, "the header has a colour for all facets"},
  };
  for (const auto& row : kRows) {
    SCOPED_TRACE(row.warning);
    const TriangleMesh mesh = read("a.stl", row.bytes);
    EXPECT_EQ(mesh.triangles.size(), 2u);
    EXPECT_EQ(mesh.positions[4], Point3(1, 0, 0));
    if (row.warning.empty())
      EXPECT_TRUE(mesh.warnings.empty());
    else
      EXPECT_THAT(mesh.warnings, testing::ElementsAre(HasSubstr(row.warning)));
  }
  EXPECT_THAT(read("a.stl", binary("a", 0, {kOne, kOne}) + "xy").warnings,
              testing::ElementsAre(HasSubstr("declares 0"), HasSubstr("2 bytes behind")));
  EXPECT_THAT(malformed("a.stl", binary("solid a", 3, {kOne, kOne})), HasSubstr("cut off"));
}

TEST_F(ReadStl, MessagesShowNoBinaryBytes) {
  std::mt19937 random(1);
  for (int round = 0; round < 300; ++round) {
    std::string bytes = round % 2 ? "solid " : "";
    for (std::size_t n = random() % 400; n > 0; --n)
      bytes += char(random());
    for (const char* name : {"a.stl", "a.obj", "a.ply", "a.off"}) {
      const std::string head = name[2] == 'p' ? "ply\n" : name[2] == 'o' && round % 3 ? "OFF\n1 1 1\n" : "";
      try {
        read(name, head + bytes);
      } catch (const Error& e) {
        ASSERT_EQ(printable(e.what(), 100000), e.what());
      }
    }
  }
}

} // namespace
} // namespace chamfer
