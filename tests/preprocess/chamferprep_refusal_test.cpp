// The real program on bad input: its exit status, its words, and that it leaves every file as it was.
#include "tests/preprocess/chamferprep_fixture.h"
#include "tests/preprocess/mesh_makers.h"

namespace chamfer {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class ChamferprepRefuses : public Chamferprep {
protected:
  /// Runs it, expects the status, the words on standard error and an untouched folder.
  void expectRefusal(const std::vector<std::string>& arguments, int status, const char* words) const {
    SCOPED_TRACE(testing::PrintToString(arguments));
    const auto before = listing();
    const test::ProgramRun r = run(arguments);
    EXPECT_EQ(r.status, status) << r.err;
    EXPECT_THAT(r.err, HasSubstr(words));
    EXPECT_EQ(r.out, "");
    EXPECT_THAT(listing(), testing::ContainerEq(before));
  }
  /// The "error" object of a run with --json that must end with the status and change nothing.
  nlohmann::json errorOf(std::vector<std::string> arguments, int status) const {
    arguments.push_back("--json");
    const auto before = listing();
    const test::ProgramRun r = run(std::move(arguments));
    EXPECT_EQ(r.status, status) << r.err;
    EXPECT_THAT(listing(), testing::ContainerEq(before));
    const auto error = nlohmann::json::parse(r.out).at("error");
    EXPECT_EQ(error.at("exit_status"), status);
    EXPECT_THAT(r.err, HasSubstr(error.at("message").get<std::string>()));
    return error;
  }
  std::string openCube(const std::string& name = "open.obj") const {
    TriangleMesh mesh = box();
    mesh.triangles.pop_back();
    return write(name, objText(mesh)).string();
  }
};

TEST_F(ChamferprepRefuses, WrongUsage) {
  const std::string mesh = cube();
  expectRefusal({mesh}, 2, "--radius");
  expectRefusal({"--radius", "0.1"}, 2, "MESH");
  for (const char* radius : {"0,5", "0", "-1", "nan", "inf", "1e999", "ten", "%", ""})
    expectRefusal({mesh, std::string("--radius=") + radius}, 2, "radius");
  expectRefusal({mesh, "-r", "0.1", "--frobnicate"}, 2, "frobnicate");
  expectRefusal({mesh, "-r", "0.1", "--on-nonconvex", "ignore"}, 2, "on-nonconvex");
  expectRefusal({mesh, "-r", "0.1", "--clamp", "1.5"}, 2, "clamp");
  expectRefusal({mesh, "-r", "0.1", "--segments", "0"}, 2, "segments");
  expectRefusal({mesh, "-r", "0.1", "-j", "-1"}, 2, "threads");
  expectRefusal({mesh, "-r", "0.1", "--mesh", in("out.stl")}, 2, ".obj");
  expectRefusal({mesh, cube("b.obj"), "-r", "0.1", "--mesh", in("out.obj")}, 2, "single MESH");
}

TEST_F(ChamferprepRefuses, OutputsThatWouldReplaceAnInputOrEachOther) {
  const std::string mesh = cube();
  std::filesystem::create_directories(folder_ / "other");
  std::filesystem::create_directories(folder_ / "out");
  const std::string same = cube("other/cube.obj");
  expectRefusal({mesh, "-r", "0.1", "-o", mesh}, 2, "replace the mesh");
  expectRefusal({mesh, "-r", "0.1", "-o", in("other/../cube.obj")}, 2, "replace the mesh");
  expectRefusal({mesh, "-r", "0.1", "--mesh", mesh}, 2, "replace the mesh");
  expectRefusal({mesh, "-r", "0.1", "-o", in("a.obj"), "--mesh", in("a.obj")}, 2, "twice");
  expectRefusal({mesh, same, "-r", "0.1", "-o", in("out")}, 2, "twice");
}

TEST_F(ChamferprepRefuses, WhatCannotBeRead) {
  expectRefusal({in("none.obj"), "-r", "0.1"}, 3, "none.obj");
  expectRefusal({folder_.string(), "-r", "0.1"}, 3, ".obj, .stl, .ply and .off are read");
  expectRefusal({write("cube.step", "").string(), "-r", "0.1"}, 3, ".step");
  expectRefusal({write("empty.obj", "").string(), "-r", "0.1"}, 3, "empty.obj");
  expectRefusal({write("nan.obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n").string(), "-r", "0.1"}, 3,
                "nan.obj:2: ");
  expectRefusal({write("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n").string(), "-r", "0.1"}, 3,
                "index.obj:4: ");
  expectRefusal({write("cut.stl", std::string(90, '\0')).string(), "-r", "0.1"}, 3, "cut.stl");
  EXPECT_EQ(errorOf({in("none.obj"), "-r", "0.1"}, 3).at("kind"), "not-found");
  EXPECT_EQ(errorOf({in("empty.obj"), "-r", "0.1"}, 3).at("kind"), "malformed");
}

TEST_F(ChamferprepRefuses, WhatIsNotAClosedConvexSolid) {
  const std::string mesh = openCube();
  expectRefusal({mesh, "-r", "0.1"}, 4, "(open)");
  expectRefusal({mesh, "-r", "0.1", "--on-nonconvex", "hull"}, 4, "(open)");
  const auto error = errorOf({mesh, "-r", "0.1"}, 4);
  EXPECT_EQ(error.at("kind"), "not-convex-solid");
  EXPECT_EQ(error.at("component"), 1);
  EXPECT_EQ(error.at("measure"), 3); // open edges
}

TEST_F(ChamferprepRefuses, ARadiusAtTheInradiusWithTheLargestThatWorks) {
  const std::string mesh = cube();
  expectRefusal({mesh, "-r", "0.5"}, 5, "solid 1");
  const auto error = errorOf({mesh, "-r", "0.5"}, 5);
  EXPECT_EQ(error.at("kind"), "radius-too-large");
  EXPECT_EQ(error.at("solid"), 1);
  const double largest = error.at("max_radius");
  EXPECT_GT(largest, 0.499);
  EXPECT_LT(largest, 0.5);
  report({mesh, "-r", std::to_string(largest)});
}

TEST_F(ChamferprepRefuses, PlacesThatCannotBeWritten) {
  const std::string mesh = cube();
  write("file", "not a folder");
  std::filesystem::create_directories(folder_ / "folder.obj");
  expectRefusal({mesh, "-r", "0.1", "-o", in("file/cube.chamfer")}, 6, "file/cube.chamfer");
  expectRefusal({mesh, "-r", "0.1", "-o", in("none/cube.chamfer")}, 6, "none/cube.chamfer");
  expectRefusal({mesh, "-r", "0.1", "--mesh", in("file/out.obj")}, 6, "file/out.obj");
  expectRefusal({mesh, "-r", "0.1", "--mesh", in("folder.obj")}, 6, "folder.obj");
  expectRefusal({mesh, "-r", "0.1", "--mesh", in("out.obj"), "-o", in("file/cube.chamfer")}, 6,
                "file/cube.chamfer");
  EXPECT_EQ(errorOf({mesh, "-r", "0.1", "-o", in("file/cube.chamfer")}, 6).at("kind"), "cannot-write");
}

TEST_F(ChamferprepRefuses, AndLeavesAGoodSidecarAsItWas) {
  const std::string mesh = cube();
  report({mesh, "-r", "0.1", "--mesh", in("out.obj")});
  expectRefusal({mesh, "-r", "0.5", "--mesh", in("out.obj")}, 5, "too large");
  openCube("cube.obj");
  expectRefusal({mesh, "-r", "0.1", "--mesh", in("out.obj")}, 4, "(open)");
  write("cube.obj", "v 1 2\n");
  expectRefusal({mesh, "-r", "0.1", "--mesh", in("out.obj")}, 3, "cube.obj:1: ");
}

TEST_F(ChamferprepRefuses, OneOfSeveralAndGoesOn) {
  const std::string open = openCube(), good = cube(), missing = in("none.obj");
  const auto r = run({open, good, missing, "-r", "0.1", "--json"});
  EXPECT_EQ(r.status, 4) << "the first failure's";
  EXPECT_THAT(names(), ElementsAre("cube.obj", "cube.obj.chamfer", "open.obj"));
  const auto json = nlohmann::json::parse(r.out);
  ASSERT_EQ(json.size(), 3u);
  EXPECT_EQ(json[0].at("error").at("exit_status"), 4);
  EXPECT_EQ(json[1].at("spheres"), 8);
  EXPECT_EQ(json[2].at("error").at("exit_status"), 3);
  EXPECT_THAT(r.err, HasSubstr(open + ": "));
  EXPECT_THAT(r.err, HasSubstr(missing + ": "));
}

} // namespace
} // namespace chamfer
