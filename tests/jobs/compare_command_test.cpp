// The program itself: `chamferd compare` on real renders, its exit status and its files.
#include "tests/support/run_program.h"
#include "tests/support/temporary_folder.h"

#include <fstream>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <sstream>

namespace chamfer {
namespace {

using nlohmann::json;
using test::ProgramRun;
using testing::HasSubstr;

constexpr const char* kCube =
    "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

std::string textOf(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

class CompareCommand : public testing::Test {
protected:
  CompareCommand() {
    folder.write("cube.obj", kCube);
    scene("a", 0.2);
    scene("b", 0.25);
  }
  void scene(const std::string& name, double radius) const {
    const json j = {
        {"meshes", {{{"name", "cube"}, {"file", "cube.obj"}, {"radius", radius}}}},
        {"materials", {{{"name", "grey"}, {"base_color", {0.5, 0.5, 0.5}}, {"roughness", 0.5}}}},
        {"instances", {{{"mesh", "cube"}, {"material", "grey"}}}},
        {"lights", {{{"type", "sky"}, {"zenith", 1}, {"horizon", 0.5}, {"ground", 0.1}}}},
        {"camera", {{"eye", {3, -5, 3}}, {"target", {0, 0, 0}}, {"up", {0, 0, 1}}, {"vfov_degrees", 35}}}};
    folder.write(name + ".scene.json", j.dump());
  }
  ProgramRun compare(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "compare");
    return test::runProgram(CHAMFER_BINARY_DIR "/server/chamferd", std::move(arguments));
  }
  std::string path(const std::string& name) const { return (folder.path() / name).string(); }
  std::string suite(const json& cases) const {
    return folder
        .write("cases.json", json{{"schema", "chamfer.cases/1"},
                                  {"defaults", {{"width", 48}, {"height", 27}, {"samples", 1}}},
                                  {"cases", cases}}
                                 .dump(2))
        .string();
  }

  test::TemporaryFolder folder;
  const std::vector<std::string> size{"--width", "48", "--height", "27", "--samples", "1"};
  std::vector<std::string> with(std::vector<std::string> more) const {
    more.insert(more.end(), size.begin(), size.end());
    return more;
  }
};

TEST_F(CompareCommand, EndsWithTheVerdict) {
  const ProgramRun same = compare(with({path("a.scene.json"), path("a.scene.json") + "?rounding=analytic"}));
  EXPECT_EQ(same.status, 0) << same.out << same.err;
  EXPECT_THAT(same.out, HasSubstr("same"));
  const ProgramRun differs = compare(with({path("a.scene.json"), path("b.scene.json")}));
  EXPECT_EQ(differs.status, 1) << differs.out << differs.err;
  EXPECT_THAT(differs.out, HasSubstr("differs: "));
  const ProgramRun open = compare(with({path("a.scene.json"), path("a.scene.json") + "?seed=100", "--seeds",
                                        "16", "--resolution", "pixel=0.0001"}));
  EXPECT_EQ(open.status, 2) << open.out << open.err;
  EXPECT_THAT(open.out, HasSubstr("cannot tell: "));
  const ProgramRun missing = compare(with({path("a.scene.json"), path("no.exr")}));
  EXPECT_EQ(missing.status, 2);
  EXPECT_THAT(missing.out, HasSubstr("error: side b"));
}

TEST_F(CompareCommand, SaysWhatIsWrongWithItsArguments) {
  const auto refusal = [&](std::vector<std::string> arguments) {
    const ProgramRun run = compare(std::move(arguments));
    EXPECT_EQ(run.status, 2) << run.out << run.err;
    return run.err;
  };
  EXPECT_THAT(refusal({}), HasSubstr("two sides"));
  EXPECT_THAT(refusal({"a.obj"}), HasSubstr("two sides"));
  EXPECT_THAT(refusal({"a.obj", "b.obj", "--limit", "ssim=1"}), HasSubstr("failing_share"));
  EXPECT_THAT(refusal({"a.obj", "b.obj", "--limit", "rmse"}), HasSubstr("NAME=NUMBER"));
  EXPECT_THAT(refusal({"a.obj", "b.obj", "--limit", "flip=2"}), HasSubstr("flip"));
  EXPECT_THAT(refusal({"a.obj", "b.obj", "--crop", "1,2,3"}), HasSubstr("x,y,width,height"));
  EXPECT_THAT(refusal({"a.obj", "b.obj", "--resolution", "voxel=1"}), HasSubstr("pixel, block, image"));
  EXPECT_THAT(refusal({"a.obj", "b.obj?colour=1"}), HasSubstr("colour"));
  EXPECT_THAT(refusal({"a.obj", "b.obj", "--suite", "x"}), HasSubstr("not both"));
  EXPECT_THAT(refusal({"--suite", path("none.json")}), HasSubstr("cannot read"));
  EXPECT_THAT(refusal({"--suite", folder.write("bad.json", "{}").string()}), HasSubstr("schema"));
  EXPECT_THAT(refusal({path("a.scene.json"), path("b.scene.json"), "--update"}),
              HasSubstr("no case has a reference"));
}

TEST_F(CompareCommand, WritesItsReports) {
  const std::string file = suite({{{"name", "same"}, {"a", "a.scene.json"}, {"b", "a.scene.json"}},
                                  {{"name", "it's wrong"}, {"a", "a.scene.json"}, {"b", "b.scene.json"}},
                                  {{"name", "missing"}, {"a", "a.scene.json"}, {"b", "no.exr"}}});
  const ProgramRun run = compare(
      {"--suite", file, "--json", path("r.json"), "--junit", path("r.xml"), "--html", path("r.html")});
  EXPECT_EQ(run.status, 2) << run.out << run.err;
  const json result = json::parse(textOf(path("r.json")));
  EXPECT_EQ(result["schema"], "chamfer.comparison/1");
  EXPECT_EQ(result["exit_status"], 2);
  EXPECT_EQ(result["cases"][0]["outcome"], "same");
  EXPECT_EQ(result["cases"][1]["outcome"], "differs");
  EXPECT_EQ(result["cases"][2]["outcome"], "error");
  pugi::xml_document xml;
  ASSERT_TRUE(xml.load_file(path("r.xml").c_str()));
  EXPECT_EQ(xml.select_nodes("//testcase").size(), 3u);
  EXPECT_EQ(xml.select_nodes("//failure").size(), 1u);
  EXPECT_THAT(textOf(path("r.html")), HasSubstr("it's wrong"));

  // The command that each case carries repeats it, as a shell reads it.
  const std::string command = result["cases"][1]["command"];
  EXPECT_THAT(command, testing::StartsWith("chamferd compare --suite "));
  const ProgramRun again =
      test::runProgram("/bin/sh", {"-c", std::string(CHAMFER_BINARY_DIR "/server/") + command + " --json -"});
  EXPECT_EQ(again.status, 1) << again.err;
  const json repeated = json::parse(again.out);
  ASSERT_EQ(repeated["cases"].size(), 1u);
  EXPECT_EQ(repeated["cases"][0]["reason"], result["cases"][1]["reason"]) << "verdicts repeat";
}

TEST_F(CompareCommand, AcceptsReferencesAndSeesThatTheyAreStale) {
  const std::string file =
      suite({{{"name", "image"}, {"a", "a.scene.json?seed=999"}, {"b", "a.exr"}, {"seeds", 64}},
             {{"name", "bits"}, {"a", "a.scene.json"}, {"b", "digest:00000000000000000000000000000000"}},
             {{"name", "no reference"}, {"a", "a.scene.json"}, {"b", "a.scene.json"}}});
  const ProgramRun before = compare({"--suite", file});
  EXPECT_EQ(before.status, 2);
  const ProgramRun update = compare({"--suite", file, "--update"});
  EXPECT_EQ(update.status, 0) << update.err;
  EXPECT_THAT(update.out, HasSubstr("accepted image"));
  EXPECT_THAT(textOf(file), testing::Not(HasSubstr("digest:0000000000")));
  const ProgramRun after = compare({"--suite", file});
  EXPECT_EQ(after.status, 0) << after.out << after.err;

  scene("a", 0.7);
  const ProgramRun changed = compare({"--suite", file, "--json", path("r.json")});
  EXPECT_EQ(changed.status, 1) << changed.out << changed.err;
  const json result = json::parse(textOf(path("r.json")));
  EXPECT_EQ(result["cases"][0]["outcome"], "differs");
  EXPECT_THAT(result["cases"][0]["b"]["stale"].get<std::string>(), HasSubstr("another scene"));
  EXPECT_EQ(result["cases"][1]["outcome"], "differs");
}

TEST_F(CompareCommand, KeepsSeedsWhereItIsTold) {
  const auto seeds = [&] {
    std::size_t n = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path() / "seeds"))
      n += entry.path().extension() == ".exr";
    return n;
  };
  const auto run = [&] {
    return compare(with({path("a.scene.json"), path("b.scene.json"), "--keep", path("seeds")}));
  };
  const ProgramRun first = run();
  EXPECT_EQ(first.status, 1);
  EXPECT_EQ(seeds(), 32u);
  const ProgramRun second = run();
  EXPECT_EQ(second.out, first.out);
  EXPECT_EQ(seeds(), 32u);
}

TEST_F(CompareCommand, FindsTheScenesOfUrlsBelowItsRoot) {
  const std::string tile = "/v1/scenes/a/tiles/48x27/8,8,16,16/0-1.exr";
  const ProgramRun run = compare({tile, "http://localhost:8080/v1/scenes/a/frames/48x27/0-1.exr", "--root",
                                  folder.path().string(), "--seeds", "1"});
  EXPECT_EQ(run.status, 0) << run.out << run.err;
  const ProgramRun lost = compare({tile, tile + "?seed=9", "--root", "/nonexistent"});
  EXPECT_EQ(lost.status, 2);
  EXPECT_THAT(lost.out, HasSubstr("--root names the folder"));
}

/// Inputs after public reports of other tools; they lie beside the project.
std::string reportFile(const std::string& name) {
  const std::filesystem::path file =
      std::filesystem::path(CHAMFER_SOURCE_DIR "/../shared/data/reports") / name;
  return std::filesystem::exists(file) ? file.string() : std::string();
}

TEST_F(CompareCommand, NeverPassesWhatCannotBeCompared) {
  const std::string nan = reportFile("compare/nan.exr"), black = reportFile("compare/black.exr"),
                    wider = reportFile("compare/black-wider.exr");
  if (nan.empty()) GTEST_SKIP() << "the reports are not beside the project";
  for (const auto& [a, b] : {std::pair(nan, black), std::pair(black, nan), std::pair(nan, nan),
                             std::pair(wider, black), std::pair(black, wider)}) {
    const ProgramRun run = compare({a, b});
    EXPECT_EQ(run.status, 2) << run.out;
    EXPECT_THAT(run.out, HasSubstr("error: ")) << a << " against " << b;
  }
  EXPECT_EQ(compare({black, black}).status, 0);
}

TEST_F(CompareCommand, FindsNoTerminatorOnARoundingThatItsMeshDoesNotHave) {
  const std::string scene = reportFile("terminator/low-sun.scene.json");
  if (scene.empty()) GTEST_SKIP() << "the reports are not beside the project";
  const std::vector<std::string> limits{"--width", "160",        "--height", "100",
                                        "--limit", "flip=0.002", "--limit",  "bias_percent=0.1"};
  const auto against = [&](const std::string& rounding) {
    std::vector<std::string> arguments{scene, scene + "?rounding=" + rounding};
    arguments.insert(arguments.end(), limits.begin(), limits.end());
    return compare(arguments);
  };
  const ProgramRun mesh = against("mesh:32");
  EXPECT_EQ(mesh.status, 0) << mesh.out << mesh.err;
  EXPECT_EQ(against("bevel:8").status, 1) << "a shader's edges are seen to be other ones";
}

} // namespace
} // namespace chamfer
