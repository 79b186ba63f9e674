#include "tests/render/scene_files_fixture.h"

#include <sstream>

namespace chamfer::test {

std::string boxObj(const Point3& a, const Point3& b) {
  std::ostringstream s;
  s.precision(17);
  for (int i = 0; i < 8; ++i)
    s << "v " << (i & 1 ? b.x : a.x) << ' ' << (i & 2 ? b.y : a.y) << ' ' << (i & 4 ? b.z : a.z) << '\n';
  s << "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  return s.str();
}

std::string cubeObj() { return boxObj({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}); }

void writeMeshes(const TemporaryFolder& folder) {
  folder.write("cube.obj", cubeObj());
  folder.write("box2.obj", boxObj({-1, -1, -1}, {1, 1, 1}));
  folder.write("floor.obj", boxObj({-10, -10, -1.5}, {10, 10, -0.5}));
}

std::shared_ptr<const Scene> loadText(const TemporaryFolder& folder, const std::string& json) {
  writeMeshes(folder);
  return loadScene(folder.write("test.scene.json", json), folder.path(), "test");
}

} // namespace chamfer::test
