// A folder of its own for a test that loads scenes, and small meshes to put there.
#pragma once

#include "server/render/path/render.h"

#include <filesystem>
#include <string>

namespace chamfer::test {

/// Made empty, removed with everything in it at the end.
class TemporaryFolder {
public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  /// Writes `content` to a file below, making folders on the way.
  std::filesystem::path write(const std::string& name, const std::string& content) const;

private:
  std::filesystem::path path_;
};

/// OBJ of an axis-aligned box, quads turned outward.
std::string boxObj(const Point3& lower, const Point3& upper);
/// OBJ of the unit cube about the origin.
std::string cubeObj();

/// Loads a scene file of this content; every test mesh is there: cube.obj, box2.obj (side 2), floor.obj (a 20
/// x 20 x 1 slab with its top at z = -0.5).
std::shared_ptr<const Scene> loadText(const TemporaryFolder& folder, const std::string& json);
void writeMeshes(const TemporaryFolder& folder);

/// What a call throws, as "kind: message"; "nothing" when it does not.
template <class F>
std::string thrownBy(F&& f);

} // namespace chamfer::test

#include "common/error.h"

template <class F>
std::string chamfer::test::thrownBy(F&& f) {
  try {
    f();
  } catch (const Error& e) {
    return std::string(errorWord(e.kind())) + ": " + e.what();
  }
  return "nothing";
}
