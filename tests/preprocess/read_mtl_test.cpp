// What becomes of each statement of MTL: one row a statement or a variant of it.
#include "tests/preprocess/mesh_files.h"

#include "common/rounding.h"

#include <cmath>
#include <functional>
#include <gmock/gmock.h>

namespace chamfer {
namespace {

using testing::AllOf;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

const std::string kShape = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n";

class ReadMtl : public MeshFiles {
protected:
  TriangleMesh withLibrary(const std::string& library) const {
    write("m.mtl", library);
    return read("a.obj", "mtllib m.mtl\nusemtl a\n" + kShape);
  }
};

double roughnessOf(double ns) { return std::pow(2 / (ns + 2), 0.25); }

using Value = std::function<double(const MeshMaterial&)>;
const Value kRed = [](const MeshMaterial&m) { return m.baseColor[0]; },
            kGreen = [](const MeshMaterial&m) { return m.baseColor[1]; },
            kRoughness = [](const MeshMaterial&m) { return m.roughness; },
            kMetallic = [](const MeshMaterial&m) { return m.metallic; },
            kTransmission = [](const MeshMaterial&m) { return m.transmission; },
            kIor = [](const MeshMaterial&m) { return m.ior; },
            kGlow = [](const MeshMaterial&m) { return m.emission[1]; };

struct Row {
  std::string statements; ///< behind "newmtl a", from line 2 on
  Value value;
  double expected;
  std::string warning; ///< what the one warning says; empty: there is none
};

const Row kRows[] = {
    {"", kRed, 0.8, ""},
    {"# Kd 0 0 0", kRed, 0.8, ""},
    {"Kd .25 .5 1", kGreen, 0.5, ""},
    {"\tKd  .25\t.5 1 # green", kGreen, 0.5, ""},
    {"kd .25 .5 1", kGreen, 0.5, ""},
    {"Kd .25", kGreen, 0.25, ""}, // "if only r is given, g and b are the same"
    {"Kd .25 .5", kGreen, 0.8, "m.mtl:2: material \"a\": Kd has 2 numbers"},
    {"Kd 2 0 0", kRed, 1, "Kd is 2, outside 0 to 1"},
    {"Kd nan 0 0", kRed, 0.8, "Kd \"nan\" is not a finite number"},
    {"Kd 0,5 0 0", kRed, 0.8, "Kd \"0,5\""},
    {"Kd spectral a.rfl 1", kRed, 0.8, "Kd spectral is not read"},
    {"Kd xyz 0 0 0", kRed, 0.8, "Kd xyz is not read"},
    {"Pr .25", kRoughness, 0.25, ""},
    {"Pr .25\nNs 30", kRoughness, 0.25, ""},
    {"Ns 30", kRoughness, roughnessOf(30), ""},
    {"Ns -1", kRoughness, roughnessOf(0), "Ns is -1"},
    {"Pm 1", kMetallic, 1, ""},
    {"Ni 1.33", kIor, 1.33, ""},
    {"Ni 0", kIor, 1, "Ni is 0, outside 1 to 4"},
    {"Ni", kIor, 1.5, "Ni \"\" is not a finite number"},
    {"Ke 0 2 0", kGlow, 2, ""},
    {"d .25", kTransmission, 0.75, ""},
    {"d 0", kTransmission, 1, ""},
    {"d -halo .25", kTransmission, 0.75, "d -halo"},
    {"Tr .25", kTransmission, 0.25, ""},
    {"Tr 1", kTransmission, 1, "Tr 1 without d"},
    {"Tr 0", kTransmission, 0, ""},
    {"d 1\nTr 0", kTransmission, 0, ""},
    {"Tr .3\nd .3", kTransmission, 0.7, "m.mtl:1: material \"a\": d 0.3 and Tr 0.3 contradict each other"},
    {"d .3\nTr .3", kTransmission, 0.7, "contradict each other"},
    {"map_Kd a.png", kRed, 1, ""}, // the image alone is the colour
    {"map_Kd a.png\nKd .5 .5 .5", kRed, 0.5, ""},
    // Used nowhere: named with their line, unless there is nothing to drop.
    {"Ka 0 0 0", kRed, 0.8, ""},
    {"Ka 1 1 1", kRed, 0.8, "m.mtl: keys that are not used: Ka (line 2)"},
    {"Ks 0 0 0", kRed, 0.8, "Ks (line 2)"}, // no highlight: that is dropped
    {"Ks .5 .5 .5\nKa 1 1 1\nillum 1", kRed, 0.8, "Ks (line 2), Ka (line 3), illum (line 4)"},
    {"Tf 1 1 1", kRed, 0.8, ""},
    {"Tf .2 .2 .2", kRed, 0.8, "Tf (line 2)"},
    {"illum 2", kRed, 0.8, ""},
    {"illum 4", kRed, 0.8, "illum (line 2)"},
    {"Ps 0\nPc 0\nPcr 0\naniso 0\nanisor 0", kRed, 0.8, ""},
    {"Ps 1\nPc 1\nPcr .1\naniso .5\nanisor .5", kRed, 0.8,
     "Ps (line 2), Pc (line 3), Pcr (line 4), aniso (line 5), anisor (line 6)"},
    {"sharpness 60", kRed, 0.8, "sharpness (line 2)"},
    {"map_Ka a.png", kRed, 0.8, "map_Ka (line 2)"},
    {"map_Ks a.png", kRed, 0.8, "map_Ks (line 2)"},
    {"map_Ns a.png", kRed, 0.8, "map_Ns (line 2)"},
    {"map_d a.png", kRed, 0.8, "map_d (line 2)"},
    {"map_Ke a.png", kRed, 0.8, "map_Ke (line 2)"},
    {"map_Pm a.png", kRed, 0.8, "map_Pm (line 2)"},
    {"map_Ps a.png", kRed, 0.8, "map_Ps (line 2)"},
    {"map_aat on", kRed, 0.8, "map_aat (line 2)"},
    {"disp a.png", kRed, 0.8, "disp (line 2)"},
    {"decal a.png", kRed, 0.8, "decal (line 2)"},
    {"refl -type sphere a.png", kRed, 0.8, "refl (line 2)"},
    {"colour red", kRed, 0.8, "colour (line 2)"},
    {"\x01\xff 1", kRed, 0.8, R"("\x01\xff" (line 2))"},
    {"newmtl a\nKd 0 0 0", kRed, 0.8, "the name is taken by a material above it"},
    {"newmtl\nKd 0 0 0", kRed, 0.8, "a newmtl without a name"},
};

TEST_F(ReadMtl, EachStatementIsUsedOrNamedByLine) {
  for (const Row& row : kRows) {
    SCOPED_TRACE(row.statements);
    const TriangleMesh mesh = withLibrary("newmtl a\n" + row.statements + "\n");
    ASSERT_EQ(mesh.materials.size(), 1u);
    EXPECT_THAT(row.value(mesh.materials[0]), DoubleNear(row.expected, 1e-12));
    EXPECT_THAT(mesh.materialOfTriangle, ElementsAre(0));
    if (row.warning.empty())
      EXPECT_THAT(mesh.warnings, IsEmpty());
    else
      EXPECT_THAT(mesh.warnings, ElementsAre(HasSubstr(row.warning)));
  }
}

struct TextureRow {
  std::string statement; ///< behind "map_Kd" or "bump"
  std::string file;
  std::array<double, 2> scale, offset;
  bool clamp;
  double strength;
  std::string warning;
};

const TextureRow kTextures[] = {
    {"a.png", "a.png", {1, 1}, {0, 0}, false, 1, ""},
    {"wood grain  2.png", "wood grain  2.png", {1, 1}, {0, 0}, false, 1, ""},
    {"a.png  \t", "a.png", {1, 1}, {0, 0}, false, 1, ""},
    {"tex\\a.png", "tex\\a.png", {1, 1}, {0, 0}, false, 1, ""}, // as written: finding it is another step
    {"a #3.png", "a #3.png", {1, 1}, {0, 0}, false, 1, ""},
    {"-s 4 2 1 a.png", "a.png", {4, 2}, {0, 0}, false, 1, ""},
    {"-s 4 a.png", "a.png", {4, 1}, {0, 0}, false, 1, ""}, // v and w keep their defaults
    {"-s 4 2 7", "7", {4, 2}, {0, 0}, false, 1, ""},       // what is left at the end is the name
    {"-s 4 4.png", "4.png", {4, 1}, {0, 0}, false, 1, ""},
    {"-o .5 -.25 0 a.png", "a.png", {1, 1}, {.5, -.25}, false, 1, ""},
    {"-clamp on a.png", "a.png", {1, 1}, {0, 0}, true, 1, ""},
    {"-clamp off a.png", "a.png", {1, 1}, {0, 0}, false, 1, ""},
    {"-bm .5 a.png", "a.png", {1, 1}, {0, 0}, false, .5, ""},
    {"a b.png -s 2 2 2 -clamp on", "a b.png", {2, 2}, {0, 0}, true, 1, ""}, // behind the name
    {"-o 0 -7 0 -s 1 10 1 -clamp on a.png -bm 2", "a.png", {1, 10}, {0, -7}, true, 2, ""},
    {"-o a.png", "-o a.png", {1, 1}, {0, 0}, false, 1, ""}, // an option has values
    {"-x 1 a.png", "-x 1 a.png", {1, 1}, {0, 0}, false, 1, ""},
    {"-blendu on -blendv on -cc off -mm 0 1 -t 0 0 0 -boost 0 a.png", "a.png", {1, 1}, {0, 0}, false, 1, ""},
    {"-blendu off a.png", "a.png", {1, 1}, {0, 0}, false, 1, "\"-blendu off\" is not supported"},
    {"-blendv off a.png", "a.png", {1, 1}, {0, 0}, false, 1, "\"-blendv off\""},
    {"-cc on a.png", "a.png", {1, 1}, {0, 0}, false, 1, "\"-cc on\""},
    {"-mm .1 2 a.png", "a.png", {1, 1}, {0, 0}, false, 1, "\"-mm .1 2\""},
    {"-t 1 1 1 a.png", "a.png", {1, 1}, {0, 0}, false, 1, "\"-t 1 1 1\""},
    {"-boost 2 a.png", "a.png", {1, 1}, {0, 0}, false, 1, "\"-boost 2\""},
    {"-texres 512 a.png", "a.png", {1, 1}, {0, 0}, false, 1, "\"-texres 512\""},
    {"-imfchan r a.png", "a.png", {1, 1}, {0, 0}, false, 1, "\"-imfchan r\""},
    {"-type sphere a.png", "a.png", {1, 1}, {0, 0}, false, 1, "\"-type sphere\""},
    {"", "", {1, 1}, {0, 0}, false, 1, "names no file"},
    {"-s 1 1 1 -clamp on", "", {1, 1}, {0, 0}, false, 1, "names no file"},
};

TEST_F(ReadMtl, TexturesWithTheirOptionsWhereverTheyStand) {
  for (const TextureRow& row : kTextures) {
    SCOPED_TRACE(row.statement);
    const TriangleMesh mesh = withLibrary("newmtl a\n\nbump " + row.statement + "\n");
    ASSERT_EQ(mesh.materials.size(), 1u);
    const MeshTexture& t = mesh.materials[0].normalTexture;
    EXPECT_EQ(t.file, row.file);
    EXPECT_EQ(t.scale, row.scale);
    EXPECT_EQ(t.offset, row.offset);
    EXPECT_EQ(t.clamp, row.clamp);
    EXPECT_EQ(t.strength, row.strength);
    if (!row.file.empty()) {
      EXPECT_EQ(t.place, "m.mtl:3");
      EXPECT_EQ(t.folder, folder_);
    }
    if (row.warning.empty())
      EXPECT_THAT(mesh.warnings, IsEmpty());
    else
      EXPECT_THAT(mesh.warnings,
                  ElementsAre(AllOf(StartsWith("m.mtl:3: material \"a\": bump"), HasSubstr(row.warning))));
  }
}

TEST_F(ReadMtl, EachTextureGoesToItsPlace) {
  const TriangleMesh mesh =
      withLibrary("newmtl a\nmap_kd c.png\nmap_Pr -imfchan g r.png\nmap_Bump b.png\nnorm n.png\n");
  const MeshMaterial& m = mesh.materials[0];
  EXPECT_EQ(m.baseColorTexture.file, "c.png");
  EXPECT_EQ(m.roughnessTexture.file, "r.png");
  EXPECT_EQ(m.normalTexture.file, "n.png") << "norm is made for what it is used for";
  EXPECT_THAT(mesh.warnings, IsEmpty());
  for (const std::string key : {"bump", "map_bump", "map_Bump", "norm"})
    EXPECT_EQ(withLibrary("newmtl a\n" + key + " b.png\n").materials[0].normalTexture.file, "b.png");
  EXPECT_THAT(withLibrary("newmtl a\nmap_Kd c.png -bm 1\n").warnings,
              ElementsAre(HasSubstr("-bm has no effect here")));
}

TEST_F(ReadMtl, AByteOrderMarkHidesNothing) {
  const TriangleMesh mesh = withLibrary("\xef\xbb\xbfnewmtl a\nKd 1 0 0\n");
  ASSERT_EQ(mesh.materials.size(), 1u);
  EXPECT_THAT(mesh.materials[0].baseColor, ElementsAre(1, 0, 0));
  EXPECT_THAT(mesh.warnings, IsEmpty());
  EXPECT_THAT(withLibrary(std::string("\xff\xfen\0", 4)).warnings, testing::Contains(HasSubstr("UTF-16")));
}

TEST_F(ReadMtl, WhatStandsBeforeTheFirstMaterialIsNamed) {
  const TriangleMesh mesh = withLibrary("Kd 1 0 0\nd 0\nnewmtl a\n");
  EXPECT_THAT(mesh.warnings, ElementsAre(AllOf(StartsWith("m.mtl:1: \"Kd\""), HasSubstr("1 more"))));
}

TEST_F(ReadMtl, LibrariesAreFoundByTheirNamesAsWritten) {
  write("a.mtl", "newmtl a\n");
  write("b.mtl", "newmtl b\n");
  write("with space.mtl", "newmtl a\nnewmtl b\n");
  write("two words.mtl", "newmtl a\n");
  write("sub/d.mtl", "newmtl a\nnewmtl b\n");
  const struct {
    std::string line;
    std::size_t materials;
    std::string warning;
  } kLines[] = {
      {"with space.mtl", 2, ""},
      {"with space.mtl # comment", 2, ""},
      {"\"with space.mtl\"", 2, ""},
      {"a.mtl b.mtl", 2, ""},
      {"two words.mtl b.mtl", 2, ""}, // several, with blanks
      {"a.mtl  \t", 1, ""},
      {"./a.mtl", 1, ""},
      {"sub\\d.mtl", 2, ""},
      {"sub/../sub/d.mtl", 2, ""},
      {"A.MTL", 1, "\"A.MTL\" is not there; \"a.mtl\" is used"},
      {"Sub/D.mtl", 2, "\"sub/d.mtl\" is used"},
      {"C:\\work\\a.mtl", 1, "\"a.mtl\" is used"},
      {"/home/someone/sub/d.mtl", 2, "\"sub/d.mtl\" is used"},
      {"gone.mtl a.mtl", 1, "\"gone.mtl\" is not there"},
      {".", 0, "\".\" is not there"},
      {"sub", 0, "\"sub\" is not there"},
      {"gone.mtl", 0, "\"gone.mtl\" is not there, or outside of the folder that is read"},
  };
  for (const auto& line : kLines) {
    SCOPED_TRACE(line.line);
    const TriangleMesh mesh = read("mesh.obj", "mtllib " + line.line + "\n" + kShape);
    EXPECT_EQ(mesh.materials.size(), line.materials);
    if (line.warning.empty())
      EXPECT_THAT(mesh.warnings, IsEmpty());
    else
      EXPECT_THAT(mesh.warnings, ElementsAre(AllOf(StartsWith("line 1: "), HasSubstr(line.warning))));
    EXPECT_EQ(mesh.materialFiles.empty(), line.line == ".") << "what is missing may come later";
  }
}

TEST_F(ReadMtl, LibrariesLieBelowTheFolderOrTheGivenOne) {
  write("top/mesh/a.obj", "mtllib ../set/m.mtl\nusemtl a\n" + kShape);
  write("top/set/m.mtl", "newmtl a\n");
  write("secret.mtl", "newmtl a\n");
  std::filesystem::create_symlink(folder_ / "secret.mtl", folder_ / "top/link.mtl");
  EXPECT_EQ(readMesh(folder_ / "top/mesh/a.obj", folder_ / "top").materials.size(), 1u);
  EXPECT_THAT(readMesh(folder_ / "top/mesh/a.obj").warnings,
              testing::Contains(HasSubstr("outside of the folder")));
  for (const std::string name : {"../secret.mtl", "link.mtl", "x/../../secret.mtl"}) {
    const TriangleMesh mesh = read("top/b.obj", "mtllib " + name + "\n" + kShape);
    EXPECT_THAT(mesh.materials, IsEmpty()) << name;
    EXPECT_THAT(mesh.warnings, ElementsAre(HasSubstr("outside of the folder"))) << name;
    EXPECT_THAT(mesh.materialFiles, IsEmpty()) << name;
  }
}

TEST_F(ReadMtl, ALibraryOfTheMeshsNameIsTakenWhereNoneIsThat) {
  write("box.mtl", "newmtl a\nKd 1 0 0\n");
  const TriangleMesh guessed = read("box.obj", "mtllib other.mtl\nusemtl a\n" + kShape);
  EXPECT_THAT(guessed.materials, testing::SizeIs(1));
  EXPECT_THAT(guessed.warnings, ElementsAre(HasSubstr("other.mtl"),
                                            HasSubstr("\"box.mtl\" is used, which has the mesh's name")));
  EXPECT_THAT(read("box.obj", "usemtl a\n" + kShape).materialOfTriangle, ElementsAre(0));
  EXPECT_THAT(read("box.obj", kShape).materials, IsEmpty()) << "no face names a material";
}

TEST_F(ReadMtl, FacesGetTheMaterialsThatTheyName) {
  write("m.mtl", "newmtl red glass\nKd 1 0 0\n\nnewmtl shiny\r\nNs 30\r\nnewmtl bare\n");
  const TriangleMesh mesh = read(
      "a.obj",
      "usemtl shiny\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl\nf 1 2 3\nusemtl red glass  \nf 1 2 3 4\n"
      "usemtl shiny # blue\nf 1 2 4\nusemtl gone\nf 1 2 4\nmtllib m.mtl\n");
  EXPECT_THAT(mesh.materials, testing::SizeIs(3));
  EXPECT_EQ(mesh.materials[0].name, "red glass");
  EXPECT_THAT(mesh.materialOfTriangle, ElementsAre(kNone, 0, 0, 1, kNone));
  EXPECT_THAT(mesh.warnings, ElementsAre(AllOf(StartsWith("line 12: material \"gone\""),
                                               HasSubstr("in no material library"))));
}

} // namespace
} // namespace chamfer
