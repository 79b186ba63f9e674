// The real chamferprep in a folder of its own.
#pragma once

#include "tests/preprocess/mesh_files.h"
#include "tests/support/obj_text.h"
#include "tests/support/run_program.h"

#include <gmock/gmock.h>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

namespace chamfer {

inline std::string contentOf(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file) << path;
  return {std::istreambuf_iterator<char>(file), {}};
}

class Chamferprep : public MeshFiles {
protected:
  static test::ProgramRun run(std::vector<std::string> arguments) {
    return test::runProgram(CHAMFER_BINARY_DIR "/preprocess/chamferprep", std::move(arguments));
  }
  /// The report of a run that must end with 0; `arguments` without --json.
  static nlohmann::json report(std::vector<std::string> arguments) {
    arguments.push_back("--json");
    const test::ProgramRun r = run(std::move(arguments));
    EXPECT_EQ(r.status, 0) << r.err;
    EXPECT_EQ(r.err, "");
    return nlohmann::json::parse(r.out);
  }
  std::string in(const std::string& name) const { return (folder_ / name).string(); }
  /// The bundled cube of edge 1, copied into the folder.
  std::string cube(const std::string& name = "cube.obj") const {
    return write(name, contentOf(CHAMFER_SOURCE_DIR "/data/solids/cube.obj")).string();
  }
  /// Every file of the folder with its content, by its path in the folder.
  std::map<std::string, std::string> listing() const {
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_))
      files[entry.path().lexically_relative(folder_).string()] =
          entry.is_regular_file() ? contentOf(entry.path()) : "";
    return files;
  }
  std::vector<std::string> names() const {
    std::vector<std::string> list;
    for (const auto& [name, content] : listing())
      list.push_back(name);
    return list;
  }
};

} // namespace chamfer
