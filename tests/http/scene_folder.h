// A temporary folder with meshes and their sidecars, made by the preprocessing library.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace chamfer::test {

/// Removed with everything in it at the end.
class SceneFolder {
public:
  SceneFolder();
  ~SceneFolder();
  SceneFolder(const SceneFolder&) = delete;
  SceneFolder& operator=(const SceneFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Writes `name` with that text; folders on the way are made.
  std::filesystem::path write(const std::string& name, const std::string& text) const;
  /// Rounds the mesh `name` and writes its sidecar beside it.
  void round(const std::string& name, double radius) const;
  /// write() and round() of a cube from -half to +half.
  void addCube(const std::string& name, double radius = 0.1, double half = 0.5) const;

private:
  std::filesystem::path path_;
};

/// OBJ text of an axis-aligned cube from -half to +half.
std::string cubeObj(double half = 0.5);
/// OBJ text of `count` such cubes of edge length 1 in a row.
std::string rowObj(int count);

} // namespace chamfer::test
