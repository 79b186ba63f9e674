// Scene files: any bytes are refused as malformed, or are a scene whose references hold. Files that a scene
// names are found below the served folder or not at all.
#include "common/error.h"
#include "server/render/scene/scene_description.h"
#include "server/render/scene/scene_files.h"
#include "tests/fuzz/require.h"

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace {

namespace fs = std::filesystem;

/// A folder to serve: a file, a folder, and links that lead inside and out.
class Root {
public:
  Root() : folder_(makeFolder()) {
    fs::create_directory(folder_ / "in");
    std::ofstream(folder_ / "in" / "a.obj") << "a";
    std::ofstream(folder_ / "a.obj") << "a";
    fs::create_symlink("in/a.obj", folder_ / "link");
    fs::create_symlink("/etc/passwd", folder_ / "out");
    fs::create_symlink("/", folder_ / "top");
  }
  ~Root() { fs::remove_all(folder_); }

  void resolve(const std::string& name) const {
    try {
      const fs::path file = chamfer::resolveBelow(folder_, folder_ / "in", name);
      const auto [end, unused] = std::mismatch(folder_.begin(), folder_.end(), file.begin(), file.end());
      REQUIRE(end == folder_.end());
      REQUIRE(fs::is_regular_file(file));
    } catch (const chamfer::Error&) {
    }
  }

private:
  static fs::path makeFolder() {
    std::string pattern = (fs::temp_directory_path() / "chamfer-fuzz-XXXXXX").string();
    REQUIRE(::mkdtemp(pattern.data()));
    return fs::canonical(pattern);
  }
  const fs::path folder_;
};

/// Millions of instances are allowed, and take seconds to write down: that is no news here.
bool hasManyInstances(const std::string& text) {
  const auto document = nlohmann::json::parse(text, nullptr, false);
  if (!document.is_object() || !document.contains("instances") || !document["instances"].is_array())
    return false;
  double total = 0;
  for (const auto& instance : document["instances"]) {
    double copies = 1;
    if (instance.is_object() && instance.contains("repeat") && instance["repeat"].is_array())
      for (const auto& repeat : instance["repeat"])
        if (repeat.is_object() && repeat.contains("count") && repeat["count"].is_number())
          copies *= repeat["count"].get<double>();
    total += copies;
  }
  return !(total <= 10'000);
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Root root;
  const std::string text(reinterpret_cast<const char*>(data), size);
  root.resolve(text);
  if (hasManyInstances(text)) return 0;
  try {
    const chamfer::SceneDescription scene = chamfer::parseSceneDescription(text, "fuzz.scene.json");
    REQUIRE(!scene.instances.empty());
    for (const chamfer::InstanceDescription& instance : scene.instances) {
      REQUIRE(instance.mesh < scene.meshes.size());
      REQUIRE(instance.material == chamfer::kNone || instance.material < scene.materials.size());
    }
    for (const chamfer::MeshDescription& mesh : scene.meshes)
      root.resolve(mesh.file);
    for (const chamfer::MaterialDescription& material : scene.materials)
      root.resolve(material.baseColorTexture);
  } catch (const chamfer::Error& error) {
    REQUIRE(error.kind() == chamfer::ErrorKind::Malformed);
  }
  return 0;
}
