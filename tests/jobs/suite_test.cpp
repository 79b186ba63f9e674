// Files of cases.
#include "server/jobs/suite/suite.h"

#include "tests/support/temporary_folder.h"

#include <fstream>
#include <gmock/gmock.h>
#include <set>
#include <sstream>

namespace chamfer {
namespace {

using test::thrownBy;
using testing::HasSubstr;

std::vector<CaseChoice> suiteOf(const std::string& cases, const std::string& defaults = "{}") {
  return parseSuite(R"({"schema": "chamfer.cases/1", "defaults": )" + defaults + R"(, "cases": [)" + cases +
                        "]}",
                    "cases.json");
}

TEST(Suite, ReadsAllThatACaseCanSay) {
  const auto cases = suiteOf(R"({
    "name": "one", "a": "a.scene.json", "b": "b.exr", "width": 64, "height": 48, "samples": 8, "seeds": 32, "seconds": 5,
    "crop": [1, 2, 30, 40], "mask": "m.png", "only": [[0, 0, 9, 9]], "except": [[1, 1, 2, 2], [4, 4, 1, 1]],
    "tolerance": {"absolute": 0.01, "relative": 0.1}, "limits": {"rmse": 0.02, "psnr": 30},
    "statistics": {"significance": 0.05, "tolerance": {"image": 0.001}, "resolution": {"pixel": 2, "block": 0.3}}})");
  ASSERT_EQ(cases.size(), 1u);
  const CaseChoice& c = cases[0];
  EXPECT_EQ(c.name, "one");
  EXPECT_EQ(c.a.kind, SideKind::Scene);
  EXPECT_EQ(c.b.kind, SideKind::Image);
  EXPECT_EQ(c.width, 64u);
  EXPECT_EQ(c.height, 48u);
  EXPECT_EQ(c.samples, 8u);
  EXPECT_EQ(c.budget(), 32u);
  EXPECT_EQ(c.seconds, 5);
  EXPECT_EQ(c.region.crop, (TileRect{1, 2, 30, 40}));
  EXPECT_EQ(c.region.mask, "m.png");
  EXPECT_EQ(c.region.only.size(), 1u);
  EXPECT_EQ(c.region.except.size(), 2u);
  EXPECT_EQ(c.tolerance, (PixelTolerance{0.01, 0.1}));
  using Limit = std::pair<Metric, double>;
  EXPECT_THAT(c.limits, testing::UnorderedElementsAre(Limit(Metric::Rmse, 0.02), Limit(Metric::Psnr, 30)));
  EXPECT_TRUE(c.judgesStatistics());
  EXPECT_EQ(c.statistics.significance, 0.05);
  EXPECT_EQ(c.statistics.tolerance, (PerLevel{0, 0, 0.001}));
  EXPECT_EQ(c.statistics.resolution, (PerLevel{2, 0.3, 0.005}));
}

TEST(Suite, LaysDefaultsUnderEveryCase) {
  const auto cases = suiteOf(R"({"name": "1", "a": "a.obj", "b": "b.obj"},
                                {"name": "2", "a": "a.obj", "b": "b.obj", "samples": 2, "limits": {"rmse": 1}},
                                {"name": "3", "a": "a.obj", "b": "b.obj", "statistics": true})",
                             R"({"samples": 16, "seeds": 64, "limits": {"flip": 0.1, "rmse": 0.5}})");
  ASSERT_EQ(cases.size(), 3u);
  EXPECT_EQ(cases[0].samples, 16u);
  EXPECT_EQ(cases[0].limits.size(), 2u);
  EXPECT_FALSE(cases[0].judgesStatistics());
  EXPECT_EQ(cases[1].samples, 2u);
  EXPECT_EQ(cases[1].seeds, 64u);
  EXPECT_EQ(cases[1].limits.size(), 2u) << "one of them its own";
  EXPECT_TRUE(cases[2].judgesStatistics());
  EXPECT_TRUE(cases[2].limits.empty()) << "statistics are asked instead";
}

TEST(Suite, TestsMeansWhereSomethingIsRenderedAndNothingElseIsAsked) {
  const auto judges = [](const std::string& rest) {
    return suiteOf(R"({"name": "n", )" + rest + "}").at(0).judgesStatistics();
  };
  EXPECT_TRUE(judges(R"("a": "a.obj", "b": "b.obj")"));
  EXPECT_TRUE(judges(R"("a": "a.obj", "b": "b.exr")"));
  EXPECT_FALSE(judges(R"("a": "a.exr", "b": "b.exr")"));
  EXPECT_FALSE(judges(R"("a": "a.obj", "b": "b.obj", "limits": {"mae": 0.1})"));
  EXPECT_FALSE(judges(R"("a": "a.obj", "b": "b.obj", "seeds": 1)"));
}

TEST(Suite, RefusesWithTheKeysPlace) {
  const auto refusal = [](const std::string& rest) {
    return thrownBy([&] { suiteOf(R"({"name": "n", "a": "a.obj", "b": "b.obj", )" + rest + "}"); });
  };
  EXPECT_THAT(refusal(R"("limits": {"ssim": 1})"), HasSubstr("cases[0].limits.ssim"));
  EXPECT_THAT(refusal(R"("limits": {"ssim": 1})"), HasSubstr("failing_share"));
  EXPECT_THAT(refusal(R"("limits": {"rmse": "0.1"})"), HasSubstr("cases[0].limits.rmse"));
  EXPECT_THAT(refusal(R"("limits": {"flip": 2})"), HasSubstr("cases[0].limits.flip"));
  EXPECT_THAT(refusal(R"("limits": [1])"), HasSubstr("cases[0].limits"));
  EXPECT_THAT(refusal(R"("seed": 1)"), HasSubstr("cases[0].seed: unknown key"));
  EXPECT_THAT(refusal(R"("seeds": 0)"), HasSubstr("cases[0].seeds"));
  EXPECT_THAT(refusal(R"("seeds": 2.5)"), HasSubstr("cases[0].seeds"));
  EXPECT_THAT(refusal(R"("crop": [0, 0, 5])"), HasSubstr("cases[0].crop"));
  EXPECT_THAT(refusal(R"("crop": [0, 0, 0, 5])"), HasSubstr("cases[0].crop[2]"));
  EXPECT_THAT(refusal(R"("tolerance": {"absolute": -1})"), HasSubstr("cases[0].tolerance.absolute"));
  EXPECT_THAT(refusal(R"("statistics": {"significance": 1})"), HasSubstr("cases[0].statistics.significance"));
  EXPECT_THAT(refusal(R"("statistics": {"resolution": {"voxel": 1}})"), HasSubstr("voxel"));
  EXPECT_THAT(refusal(R"("width": 64)"), HasSubstr("width and height"));
  EXPECT_THAT(refusal(R"("seeds": 1, "statistics": true)"), HasSubstr("two seeds"));
  EXPECT_THAT(refusal(R"("statistics": false)"), HasSubstr("nothing is asked"));
  EXPECT_THAT(thrownBy([] { suiteOf(R"({"name": "n", "a": "a.obj?x=1", "b": "b.obj"})"); }),
              HasSubstr("cases[0].a"));
  EXPECT_THAT(
      thrownBy([] {
        suiteOf(R"({"name": "n", "a": "a.obj", "b": "b.obj"}, {"name": "n", "a": "a.obj", "b": "b.obj"})");
      }),
      HasSubstr("cases[1].name"));
  EXPECT_THAT(thrownBy([] { suiteOf(""); }), HasSubstr("has no case"));
  EXPECT_THAT(thrownBy([] { parseSuite(R"({"schema": "chamfer.cases/2", "cases": []})", "f"); }),
              HasSubstr("chamfer.cases/1"));
}

std::string document() {
  std::ifstream stream(CHAMFER_SOURCE_DIR "/data/COMPARISONS.md");
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

TEST(Suite, IsAsItsDocumentSays) {
  const std::string text = document();
  const std::size_t begin = text.find("```json\n"), end = text.find("\n```", begin);
  ASSERT_NE(begin, std::string::npos);
  EXPECT_EQ(parseSuite(text.substr(begin + 8, end - begin - 8), "example").size(), 3u);

  std::set<std::string> told;
  const std::size_t table = text.find("| key of a case |");
  std::istringstream rows(text.substr(table, text.find("\n\n", table) - table));
  for (std::string row; std::getline(rows, row);)
    if (row.starts_with("| `")) told.insert(row.substr(3, row.find('`', 3) - 3));
  const std::string refusal = thrownBy([] { suiteOf(R"({"name": "n", "colour": 1})"); });
  const std::string prefix = "known here: ";
  std::istringstream list(refusal.substr(refusal.find(prefix) + prefix.size()));
  std::set<std::string> known;
  for (std::string key; std::getline(list >> std::ws, key, ',');)
    known.insert(key);
  EXPECT_EQ(told, known);
}

TEST(Suite, RefusesDigestsWhereTheySayNothing) {
  const std::string digest = "digest:0123456789abcdef0123456789abcdef";
  const auto refusal = [](const std::string& a, const std::string& b, const std::string& more) {
    return thrownBy([&] { suiteOf(R"({"name": "n", "a": ")" + a + R"(", "b": ")" + b + "\"" + more + "}"); });
  };
  EXPECT_EQ(refusal("a.obj", digest, ""), "nothing");
  EXPECT_THAT(refusal(digest, "a.obj", ""), HasSubstr("make it side b"));
  EXPECT_THAT(refusal("a.exr", digest, ""), HasSubstr("side a must be one"));
  EXPECT_THAT(refusal("a.obj", digest, R"(, "limits": {"mae": 1})"), HasSubstr("only equality"));
}

} // namespace
} // namespace chamfer
