// The JSON of comparisons: what data/COMPARISONS.md says of it holds both ways, and nothing that a result can
// hold breaks it.
#include "server/jobs/report/reports.h"

#include "tests/jobs/report_samples.h"

#include <fstream>
#include <gmock/gmock.h>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

namespace chamfer {
namespace {

using Json = nlohmann::ordered_json;
using testing::ElementsAre;

Json parsed(const SuiteResult& suite) { return Json::parse(comparisonJson(suite)); }

std::vector<std::string> keysOf(const Json& object) {
  std::vector<std::string> keys;
  for (const auto& item : object.items())
    keys.push_back(item.key());
  return keys;
}

/// Keys of each table in data/COMPARISONS.md, in their order, by every name that its heading has in quotes.
std::map<std::string, std::vector<std::string>> readTables() {
  std::ifstream document(CHAMFER_SOURCE_DIR "/data/COMPARISONS.md");
  EXPECT_TRUE(document.good());
  std::map<std::string, std::vector<std::string>> tables;
  std::vector<std::string> names;
  bool isResults = false;
  for (std::string line; std::getline(document, line);) {
    if (line.starts_with("## ")) isResults = line == "## Results";
    if (!isResults) continue;
    if (line.starts_with("### ")) {
      names.clear();
      const std::string heading = line.substr(0, line.find(':'));
      for (std::size_t begin = 0; (begin = heading.find('`', begin)) != std::string::npos;) {
        const std::size_t end = heading.find('`', begin + 1);
        names.push_back(heading.substr(begin + 1, end - begin - 1));
        begin = end + 1;
      }
    }
    if (!line.starts_with("| `")) continue;
    for (const std::string& name : names)
      tables[name].push_back(line.substr(3, line.find('`', 3) - 3));
  }
  return tables;
}

/// Holds an object, and all below it, against the table of its name.
void expectDescribed(const Json& value, const std::string& name,
                     const std::map<std::string, std::vector<std::string>>& tables,
                     std::set<std::string>& used) {
  if (value.is_array()) {
    for (const Json& one : value)
      if (one.is_object()) expectDescribed(one, name + "[]", tables, used);
    return;
  }
  if (!value.is_object()) return;
  ASSERT_TRUE(tables.contains(name)) << name << " is not described";
  EXPECT_EQ(keysOf(value), tables.at(name)) << name;
  used.insert(name);
  for (const auto& item : value.items())
    expectDescribed(item.value(), item.key(), tables, used);
}

TEST(ReportJson, IsWhatItsDocumentSays) {
  const auto tables = readTables();
  std::set<std::string> used, described;
  for (const auto& [name, keys] : tables)
    described.insert(name);
  expectDescribed(parsed(test::makeSuite()), "result", tables, used);
  EXPECT_EQ(used, described); // no table of something that is never written
}

TEST(ReportJson, HoldsEveryValue) {
  const SuiteResult suite = test::makeSuite();
  const Json json = parsed(suite);
  EXPECT_EQ(json["schema"], "chamfer.comparison/1");
  EXPECT_EQ(json["outcome"], "error");
  EXPECT_EQ(json["exit_status"], 2);
  EXPECT_EQ(json["counts"].dump(), R"({"same":2,"differs":3,"cannot_tell":1,"error":3})");
  const Json& room = json["cases"][0];
  EXPECT_EQ(room["name"], "room, radius 0.05");
  EXPECT_EQ(room["outcome"], "differs");
  EXPECT_EQ(room["seconds"], 3.71);
  EXPECT_EQ(room["a"]["settings"][1].dump(), R"({"name":"radius","value":"0.05"})");
  EXPECT_EQ(room["a"]["picture"]["channels"], 3);
  EXPECT_EQ(room["a"]["picture"]["has_variance"], false);
  EXPECT_EQ(room["b"]["picture"]["has_variance"], true);
  EXPECT_EQ(room["b"]["picture"]["about"][1]["value"], "0.1.0");
  EXPECT_EQ(room["b"]["scene_id"], nullptr);
  EXPECT_EQ(room["tolerance"]["relative"], 0.05);
  const Json& mae = room["metrics"][0];
  EXPECT_EQ(mae.dump(), R"({"name":"mae","unit":"","value":0.0213,"standard_error":0.0004,"limit":0.005,)"
                        R"("limit_kind":"most","outcome":"differs"})");
  EXPECT_EQ(room["metrics"][1]["limit_kind"], "least");
  EXPECT_EQ(room["metrics"][1]["unit"], "dB");
  EXPECT_EQ(room["metrics"][3]["limit"], nullptr);
  EXPECT_EQ(room["metrics"][3]["standard_error"], nullptr);
  EXPECT_EQ(room["largest"]["x"], suite.cases[0].largest->x);
  EXPECT_EQ(room["largest"]["error"], suite.cases[0].largest->error);
  EXPECT_EQ(room["statistics"]["levels"][1]["outcome"], "differs");
  EXPECT_EQ(room["statistics"]["levels"][1]["p_value"], 3.2e-9);
  EXPECT_EQ(room["statistics"]["levels"][1]["channel"], "G");
  EXPECT_EQ(room["warnings"].size(), 1u);
  const Json& unsure = json["cases"][3];
  EXPECT_EQ(unsure["outcome"], "cannot-tell");
  EXPECT_EQ(unsure["region"]["crop"].dump(), R"({"x":40,"y":20,"width":160,"height":120})");
  EXPECT_EQ(unsure["region"]["pixels"], 12800);
  EXPECT_EQ(unsure["largest"]["channel"], "grey");
  EXPECT_THAT(unsure["b"]["stale"].get<std::string>(), testing::HasSubstr("0.0.9"));
  const Json& missing = json["cases"][4];
  EXPECT_EQ(missing["a"]["picture"], nullptr);
  EXPECT_EQ(missing["largest"], nullptr);
  EXPECT_EQ(missing["statistics"], nullptr);
  EXPECT_EQ(missing["metrics"], Json::array());
}

TEST(ReportJson, WritesNumbersThatAreNotFiniteAsWords) {
  const Json json = parsed(test::makeSuite());
  EXPECT_EQ(json["cases"][2]["metrics"][1]["value"], "inf");
  EXPECT_EQ(json["cases"][5]["metrics"][0]["value"], "nan");
  EXPECT_EQ(json["cases"][5]["metrics"][1]["value"], "-inf");
}

TEST(ReportJson, SurvivesHostileText) {
  SuiteResult suite = test::makeSuite();
  suite.cases = {test::makeHostileCase()};
  const std::string text = comparisonJson(suite);
  EXPECT_TRUE(text.ends_with("}\n"));
  const Json one = Json::parse(text)["cases"][0];
  EXPECT_THAT(one["name"].get<std::string>(),
              testing::HasSubstr("</script><!-- \"'&]]>\x01\x1b[31m \xef\xbf\xbd"));
  EXPECT_EQ(one["a"]["settings"].size(), 2u); // a name given twice loses nothing
}

TEST(ReportJson, OfNothingIsAnError) {
  const Json json = parsed({});
  EXPECT_EQ(json["outcome"], "error");
  EXPECT_EQ(json["exit_status"], 2);
  EXPECT_EQ(json["cases"], Json::array());
}

} // namespace
} // namespace chamfer
