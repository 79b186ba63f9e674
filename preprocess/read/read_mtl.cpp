#include "preprocess/read/read_mtl.h"

#include "common/error.h"
#include "common/rounding.h"
#include "preprocess/read/find_file.h"
#include "preprocess/read/mtl_library.h"

#include <algorithm>
#include <optional>

namespace chamfer {
namespace {

namespace fs = std::filesystem;

class Libraries {
public:
  Libraries(TriangleMesh& mesh, const MaterialNames& names, ReadWarnings& warnings)
      : mesh_(mesh), names_(names), warnings_(warnings), folder_(names.mesh.parent_path()) {}

  MaterialIndex read() {
    for (std::size_t i = 0; i < names_.libraries.size(); ++i)
      for (const std::string& name : namesOf(names_.libraries[i]))
        readNamed(name, names_.libraryLines[i]);
    if (!anyRead_ && !names_.materials.empty()) readOwn();
    return std::move(index_);
  }

private:
  std::optional<FoundFile> find(const std::string& name) const {
    return findFile(name, {folder_}, names_.top);
  }

  /// One name that may hold blanks; else several, each up to a word that ends in ".mtl".
  std::vector<std::string> namesOf(const std::string& line) const {
    if (const auto whole = find(line); whole && whole->instead.empty()) return {line};
    std::vector<std::string_view> words;
    splitTokens(withoutComment(line), words);
    std::vector<std::string> names;
    const char* begin = nullptr;
    for (const std::string_view word : words) {
      if (!begin) begin = word.data();
      if (!lowerCase(word).ends_with(".mtl")) continue;
      names.emplace_back(begin, std::size_t(word.data() + word.size() - begin));
      begin = nullptr;
    }
    if (begin) names.emplace_back(begin, std::size_t(words.back().data() + words.back().size() - begin));
    return names;
  }

  void readNamed(const std::string& name, std::size_t line) {
    const fs::path named = namedPlace(name, folder_, names_.top);
    if (!named.empty()) mesh_.materialFiles.push_back(named);
    const auto found = find(name);
    if (!found) {
      warnings_.add("library missing " + name, {{}, line},
                    "material library " + fileInQuotes(name) +
                        " is not there, or outside of the folder that is read");
      return;
    }
    if (!found->instead.empty())
      warnings_.add("library elsewhere " + name, {{}, line},
                    "material library " + fileInQuotes(name) + " is not there; " +
                        fileInQuotes(found->instead) + " is used");
    readFound(found->file);
  }

  /// Files whose mtllib line is lost or names a file of another name are common.
  void readOwn() {
    const fs::path own = fs::path(names_.mesh).replace_extension(".mtl");
    mesh_.materialFiles.push_back(own);
    const auto found = find(own.filename().string());
    if (!found) return;
    warnings_.add("own library", {},
                  "no material library could be read that the file names; " +
                      fileInQuotes(own.filename().string()) + " is used, which has the mesh's name");
    readFound(found->file);
  }

  void readFound(const fs::path& file) {
    if (mesh_.materialFiles.empty() || mesh_.materialFiles.back() != file)
      mesh_.materialFiles.push_back(file);
    try {
      readMaterialLibrary(file, mesh_, index_, warnings_);
      anyRead_ = true;
    } catch (const Error& error) {
      warnings_.add("library unreadable " + file.string(), {}, error.what());
    }
  }

  TriangleMesh& mesh_;
  const MaterialNames& names_;
  ReadWarnings& warnings_;
  fs::path folder_;
  MaterialIndex index_;
  bool anyRead_ = false;
};

/// With a comment behind it or without.
std::uint32_t indexOf(const MaterialIndex& index, std::string_view name) {
  auto found = index.find(name);
  if (found == index.end()) found = index.find(trimmed(withoutComment(name)));
  return found == index.end() ? kNone : found->second;
}

} // namespace

void addMaterials(TriangleMesh& mesh, const MaterialNames& names, ReadWarnings& warnings) {
  const MaterialIndex index = Libraries(mesh, names, warnings).read();
  std::vector<std::uint32_t> indices;
  for (std::size_t i = 0; i < names.materials.size(); ++i) {
    indices.push_back(indexOf(index, names.materials[i]));
    if (indices.back() == kNone)
      warnings.add("no material", {{}, names.materialLines[i]}, [&] {
        return "material " + inQuotes(names.materials[i]) +
               (names.libraries.empty() ? " is used, but the file names no material library"
                                        : " is in no material library that was read") +
               "; its faces have the default material";
      });
  }
  for (std::uint32_t& material : mesh.materialOfTriangle)
    if (material != kNone) material = indices[material];
  const auto& of = mesh.materialOfTriangle;
  if (std::all_of(of.begin(), of.end(), [](std::uint32_t m) { return m == kNone; }))
    mesh.materialOfTriangle.clear();
}

} // namespace chamfer
