#include "tests/http/scene_folder.h"

#include "common/sidecar.h"
#include "preprocess/preprocess.h"

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace chamfer::test {

namespace fs = std::filesystem;

SceneFolder::SceneFolder() {
  std::string pattern = (fs::temp_directory_path() / "chamfer-test-XXXXXX").string();
  if (!::mkdtemp(pattern.data())) throw std::runtime_error("cannot make a temporary folder");
  path_ = fs::canonical(pattern);
}

SceneFolder::~SceneFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

fs::path SceneFolder::write(const std::string& name, const std::string& text) const {
  const fs::path file = path_ / name;
  fs::create_directories(file.parent_path());
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) throw std::runtime_error("cannot write " + file.string());
  return file;
}

void SceneFolder::round(const std::string& name, double radius) const {
  const fs::path file = path_ / name;
  PreprocessOptions options;
  options.radius.value = radius;
  writeSidecar(file.string() + ".chamfer", *preprocess(readMesh(file), options).rounding);
}

void SceneFolder::addCube(const std::string& name, double radius, double half) const {
  write(name, cubeObj(half));
  round(name, radius);
}

std::string cubeObj(double half) {
  std::ostringstream text;
  text.precision(17);
  for (int z = -1; z <= 1; z += 2)
    for (int y = -1; y <= 1; y += 2)
      for (int x = -1; x <= 1; x += 2)
        text << "v " << x * half << ' ' << y * half << ' ' << z * half << '\n';
  text << "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  return text.str();
}

} // namespace chamfer::test
