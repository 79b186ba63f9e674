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

namespace {

void putCube(std::ostream& out, double half, double x0, int firstVertex) {
  for (int z = -1; z <= 1; z += 2)
    for (int y = -1; y <= 1; y += 2)
      for (int x = -1; x <= 1; x += 2)
        out << "v " << x * half + x0 << ' ' << y * half << ' ' << z * half << '\n';
  for (const auto& face : {std::array{1, 3, 4, 2}, std::array{5, 6, 8, 7}, std::array{1, 2, 6, 5},
                           std::array{3, 7, 8, 4}, std::array{1, 5, 7, 3}, std::array{2, 4, 8, 6}}) {
    out << 'f';
    for (const int corner : face)
      out << ' ' << corner + firstVertex;
    out << '\n';
  }
}

} // namespace

std::string cubeObj(double half) {
  std::ostringstream text;
  text.precision(17);
  putCube(text, half, 0, 0);
  return text.str();
}

std::string rowObj(int count) {
  std::ostringstream text;
  for (int i = 0; i < count; ++i)
    putCube(text, 0.5, 2 * i, 8 * i);
  return text.str();
}

} // namespace chamfer::test
