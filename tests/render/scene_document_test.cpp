// data/SCENES.md says what the readers of scene files and material libraries do: its keys are theirs, no more
// and no fewer, its limits hold, and its examples are accepted.
#include "preprocess/mesh.h"
#include "server/render/scene/scene_description.h"

#include "tests/render/scene_files_fixture.h"

#include <cmath>
#include <fstream>
#include <gmock/gmock.h>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

namespace chamfer {
namespace {

using nlohmann::json;

std::string textOf(const std::string& file) {
  std::ifstream stream(CHAMFER_SOURCE_DIR "/" + file, std::ios::binary);
  EXPECT_TRUE(stream.good()) << file;
  return {std::istreambuf_iterator<char>(stream), {}};
}

struct Row {
  std::string key, limits, example;
};

std::string withoutQuotes(const std::string& cell) {
  return cell.size() >= 2 && cell.front() == '`' && cell.back() == '`' ? cell.substr(1, cell.size() - 2) : "";
}

/// The rows of each table of five columns, by the heading above it up to its colon.
std::map<std::string, std::vector<Row>> readTables() {
  std::map<std::string, std::vector<Row>> tables;
  std::istringstream document(textOf("data/SCENES.md"));
  std::string heading;
  for (std::string line; std::getline(document, line);) {
    if (line.starts_with("#")) heading = line.substr(line.find(' ') + 1, line.find(':') - line.find(' ') - 1);
    if (!line.starts_with("| `")) continue;
    std::vector<std::string> cells;
    for (std::size_t begin = 1, end; (end = line.find(" |", begin)) != std::string::npos; begin = end + 2)
      cells.push_back(end > begin ? line.substr(begin + 1, end - begin - 1) : "");
    if (cells.size() != 5) {
      ADD_FAILURE() << "not five columns: " << line;
      continue;
    }
    tables[heading].push_back({withoutQuotes(cells[0]), cells[3], withoutQuotes(cells[4])});
  }
  return tables;
}

/// A table's object in a scene that has no more than it must.
struct Section {
  const char* heading;
  const char* object; ///< JSON pointer into the scene
  const char* scene;
};

constexpr Section kSections[] = {
    {"`scene`", "", R"({"meshes": [{"name": "m", "file": "a.obj"}], "instances": [{"mesh": "m"}]})"},
    {"`meshes[]`", "/meshes/0",
     R"({"meshes": [{"name": "m", "file": "a.obj"}, {"name": "n", "file": "b.obj"}], "instances": [{"mesh": "n"}]})"},
    {"`materials[]`", "/materials/0",
     R"({"meshes": [{"name": "m", "file": "a.obj"}], "instances": [{"mesh": "m"}], "materials": [{"name": "x"}]})"},
    {"`instances[]`", "/instances/0",
     R"({"meshes": [{"name": "m", "file": "a.obj"}], "instances": [{"mesh": "m"}], "materials": [{"name": "red"}]})"},
    {"`instances[].rotate`", "/instances/0/rotate",
     R"({"meshes": [{"name": "m", "file": "a.obj"}],
         "instances": [{"mesh": "m", "rotate": {"axis": [1, 0, 0], "degrees": 1}}]})"},
    {"`instances[].repeat[]`", "/instances/0/repeat/0",
     R"({"meshes": [{"name": "m", "file": "a.obj"}],
         "instances": [{"mesh": "m", "repeat": [{"count": 1, "step": [1, 0, 0]}]}]})"},
    {"`lights[]` of type `area`", "/lights/0",
     R"({"meshes": [{"name": "m", "file": "a.obj"}], "instances": [{"mesh": "m"}],
         "lights": [{"type": "area", "center": [0, 0, 1], "u": [1, 0, 0], "v": [0, 1, 0], "emission": 1}]})"},
    {"`lights[]` of type `point`", "/lights/0",
     R"({"meshes": [{"name": "m", "file": "a.obj"}], "instances": [{"mesh": "m"}],
         "lights": [{"type": "point", "position": [0, 0, 1], "intensity": 1}]})"},
    {"`lights[]` of type `directional`", "/lights/0",
     R"({"meshes": [{"name": "m", "file": "a.obj"}], "instances": [{"mesh": "m"}],
         "lights": [{"type": "directional", "direction": [0, 0, -1], "irradiance": 1}]})"},
    {"`lights[]` of type `sky`", "/lights/0",
     R"({"meshes": [{"name": "m", "file": "a.obj"}], "instances": [{"mesh": "m"}], "lights": [{"type": "sky"}]})"},
    {"`lights[]` of type `environment`", "/lights/0",
     R"({"meshes": [{"name": "m", "file": "a.obj"}], "instances": [{"mesh": "m"}],
         "lights": [{"type": "environment", "color": 1}]})"},
    {"`camera`", "/camera",
     R"({"meshes": [{"name": "m", "file": "a.obj"}], "instances": [{"mesh": "m"}],
         "camera": {"eye": [0, -5, 0], "target": [0, 0, 0]}})"},
};

std::string faultOf(const json& scene) {
  return test::thrownBy([&] { parseSceneDescription(scene.dump(), "s"); });
}

json sceneWith(const Section& section, const std::string& key, const json& value) {
  json scene = json::parse(section.scene);
  json& object = scene[json::json_pointer(section.object)];
  object[key] = value;
  if (key == "image") object.erase("color"); // one of the two
  return scene;
}

/// "0 to 1e9", "above 0", "at least 0": what is accepted and what is refused.
struct Limits {
  std::vector<double> inside, outside;
};

Limits readLimits(const std::string& text) {
  static const std::regex range("(-?[0-9.e]+) to ([0-9.e]+)");
  std::smatch part;
  if (text == "above 0") return {{1e-300}, {0, -1}};
  if (text == "at least 0") return {{0}, {-1e-300}};
  if (!std::regex_match(text, part, range)) {
    ADD_FAILURE() << "no limits: " << text;
    return {};
  }
  const double low = std::stod(part[1]), high = std::stod(part[2]);
  return {{low, high}, {std::nextafter(low, -HUGE_VAL), std::nextafter(high, HUGE_VAL)}};
}

TEST(SceneDocument, HasTheParsersKeysAndNoOther) {
  const auto tables = readTables();
  for (const Section& section : kSections) {
    SCOPED_TRACE(section.heading);
    ASSERT_TRUE(tables.contains(section.heading));
    EXPECT_EQ(faultOf(json::parse(section.scene)), "nothing");
    // The parser names the keys that it knows.
    const std::string fault = faultOf(sceneWith(section, "no such key", 1));
    const std::string before = "known here: ";
    ASSERT_THAT(fault, testing::HasSubstr(before));
    std::istringstream list(fault.substr(fault.find(before) + before.size()));
    std::vector<std::string> known, documented;
    for (std::string key; std::getline(list >> std::ws, key, ',');)
      known.push_back(key);
    for (const Row& row : tables.at(section.heading))
      documented.push_back(row.key);
    EXPECT_THAT(documented, testing::UnorderedElementsAreArray(known));
  }
}

TEST(SceneDocument, ExamplesAreAcceptedAndLimitsHold) {
  const auto tables = readTables();
  for (const Section& section : kSections)
    for (const Row& row : tables.at(section.heading)) {
      SCOPED_TRACE(section.heading + (": " + row.key));
      EXPECT_EQ(faultOf(sceneWith(section, row.key, json::parse(row.example))), "nothing") << row.example;
      if (row.limits.empty()) continue;
      Limits limits = readLimits(row.limits);
      const bool whole = row.key == "count";
      if (whole) limits = {{1}, {0, limits.inside.back() + 1}}; // as many as are allowed would take gigabytes
      const auto value = [&](double v) { return whole ? json(std::int64_t(v)) : json(v); };
      for (const double v : limits.inside)
        EXPECT_EQ(faultOf(sceneWith(section, row.key, value(v))), "nothing") << v;
      for (const double v : limits.outside)
        EXPECT_THAT(faultOf(sceneWith(section, row.key, value(v))), testing::HasSubstr("must be")) << v;
    }
}

TEST(SceneDocument, ItsSceneIsRead) {
  const std::string document = textOf("data/SCENES.md");
  const std::size_t begin = document.find("```json\n") + 8;
  EXPECT_EQ(test::thrownBy([&] {
              parseSceneDescription(document.substr(begin, document.find("```", begin) - begin), "s");
            }),
            "nothing");
}

/// What reading a library of one material with this statement warns of.
std::string warningsOf(const test::TemporaryFolder& folder, const std::string& statement) {
  folder.write("m.mtl", (statement.starts_with("newmtl") ? "" : "newmtl red\n") + statement + "\n");
  const auto file = folder.write("a.obj", "mtllib m.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  std::string all;
  for (const std::string& warning : readMesh(file).warnings)
    all += warning + "\n";
  return all;
}

TEST(SceneDocument, HasTheKeysOfMaterialLibraries) {
  const test::TemporaryFolder folder;
  const auto tables = readTables();
  std::set<std::string> documented;
  for (const Row& row : tables.at("Material libraries (MTL)")) {
    SCOPED_TRACE(row.key);
    EXPECT_TRUE(row.example.starts_with(row.key + " ")) << row.example;
    EXPECT_EQ(warningsOf(folder, row.example), "");
    std::string lower;
    for (const char c : row.key)
      lower += char(std::tolower(static_cast<unsigned char>(c)));
    documented.insert(lower);
    if (row.limits.empty()) continue;
    const Limits limits = readLimits(row.limits);
    for (const double v : limits.inside)
      EXPECT_THAT(warningsOf(folder, row.key + " " + std::to_string(v)),
                  testing::Not(testing::HasSubstr("taken into it")))
          << v;
    for (const double v : {limits.inside.front() - 1, limits.inside.back() + 1})
      EXPECT_THAT(warningsOf(folder, row.key + " " + std::to_string(v)), testing::HasSubstr("taken into it"))
          << v;
  }
  // The reader has no list to ask for: its source tells which keys it looks for.
  const std::string source = textOf("preprocess/read/mtl_library.cpp");
  const std::regex comparison("\\bkey == \"([a-z_]+)\"");
  std::set<std::string> read;
  for (std::sregex_iterator i(source.begin(), source.end(), comparison), end; i != end; ++i)
    read.insert((*i)[1]);
  EXPECT_EQ(documented, read);

  const std::string document = textOf("data/SCENES.md");
  const std::string unused = document.substr(document.find("Not used, among others:"));
  const std::regex quoted("`([A-Za-z_]+)`");
  std::size_t count = 0;
  for (std::sregex_iterator i(unused.begin(), unused.end(), quoted), end; i != end; ++i, ++count)
    EXPECT_THAT(warningsOf(folder, (*i)[1].str() + " 0.25 0.25 0.25"), testing::HasSubstr("not used"))
        << (*i)[1];
  EXPECT_GT(count, 10u);
}

} // namespace
} // namespace chamfer
