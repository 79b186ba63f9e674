// OBJ: polygons with their texture coordinates and materials, exactly as written; obj_statements.h tells what
// becomes of every other statement. Geometry is read strictly: a coordinate or a corner that is damaged
// refuses the file with its line. What cannot change the shape (texture coordinates, normals, materials)
// never does: it is warned of. A reader of our own: tinyobjloader reads "0,5" and "abc" as 0, takes "3.1+e2"
// for 3.1, drops what it cannot parse without a word, knows no lines and no options behind a texture's name,
// and returns two of three 17-digit numbers some units in the last place off.
#include "common/error.h"
#include "common/rounding.h"
#include "preprocess/read/obj_statements.h"
#include "preprocess/read/read_formats.h"
#include "preprocess/read/read_mtl.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <unordered_map>

namespace chamfer {
namespace {

class ObjReader {
public:
  ObjReader(std::string_view name, TriangleMesh& mesh, ReadWarnings& warnings)
      : name_(name), mesh_(mesh), warnings_(warnings) {}

  /// Reads it all and returns what the mesh needs of material libraries.
  MaterialNames run(std::string_view text) {
    ContinuedLineReader reader(withoutByteOrderMark(text, name_));
    std::string_view line;
    while (reader.next(line)) {
      line_ = reader.number();
      statement(line);
    }
    checkIndices();
    return std::move(names_);
  }

private:
  TextPlace place() const { return {name_, line_}; }
  /// Warnings of the mesh itself begin with the line.
  TextPlace warned() const { return {{}, line_}; }

  void statement(std::string_view line) {
    line = trimmed(line);
    if (line.empty() || line[0] == '#') return;
    const std::string_view word = line.substr(0, std::min(line.find_first_of(" \t"), line.size()));
    const std::string_view rest = line.substr(word.size());
    switch (const ObjTreatment treatment = treatmentOf(word)) {
    case ObjTreatment::Vertex:
      return vertex(rest);
    case ObjTreatment::TextureCoordinate:
      return textureCoordinate(rest);
    case ObjTreatment::Face:
      return face(rest);
    case ObjTreatment::Library:
      return library(std::string(trimmed(rest)));
    case ObjTreatment::Material:
      return useMaterial(std::string(trimmed(rest)));
    case ObjTreatment::Silent:
      return;
    case ObjTreatment::Display:
      splitTokens(rest, tokens_);
      if (tokens_.empty() || tokens_[0] == "off" || tokens_[0] == "0") return;
      [[fallthrough]];
    case ObjTreatment::NoSurface:
    case ObjTreatment::FreeForm:
    case ObjTreatment::OtherFile:
      warnings_.add(word, warned(), [&] { return inQuotes(word) + " " + whyNotUsed(treatment); });
      return;
    case ObjTreatment::Unknown:
      // One kind, whatever the word: a file that is no OBJ has as many of them as lines.
      warnings_.add("unknown", warned(), [&] { return inQuotes(word) + " " + whyNotUsed(treatment); });
    }
  }

  void vertex(std::string_view rest) {
    splitTokens(withoutComment(rest), tokens_);
    const std::size_t n = tokens_.size();
    // x y z, and a weight or a colour (with or without alpha) or both.
    if (n < 3 || n == 5 || n > 8)
      malformed(place(), "a vertex has 3 coordinates, here are " + std::to_string(n) + " numbers");
    mesh_.positions.push_back(parsePoint(tokens_, place()));
    for (std::size_t i = 3; i < n; ++i)
      checkNumber(tokens_[i], "vertex weight or colour", place());
    if (n >= 6) warnings_.add("vertex colours", warned(), "colours of vertices are not used");
    if ((n == 4 || n == 8) && finiteNumber(tokens_[3]) != 1)
      warnings_.add("vertex weights", warned(), [&] {
        return "the weight " + inQuotes(tokens_[3]) +
               " of a vertex is not used: it is for free-form surfaces";
      });
  }

  /// What is no pair of finite numbers keeps its place in the count, but no corner gets it.
  void textureCoordinate(std::string_view rest) {
    splitTokens(withoutComment(rest), tokens_);
    std::array<float, 2> uv{};
    bool good = !tokens_.empty();
    for (std::size_t i = 0; i < std::min<std::size_t>(tokens_.size(), 2); ++i) {
      const auto value = finiteNumber(tokens_[i]);
      good = good && value && std::isfinite(float(*value));
      if (good) uv[i] = float(*value);
    }
    if (!good)
      warnings_.add("bad vt", warned(), [&] {
        return "the texture coordinate " + inQuotes(trimmed(rest)) +
               " is no pair of finite numbers; corners that name it have none";
      });
    else if (tokens_.size() > 3)
      warnings_.add("long vt", warned(), [&] {
        return "a texture coordinate of " + std::to_string(tokens_.size()) +
               " numbers; the first two are used";
      });
    if (!good) uv[0] = NAN;
    mesh_.uvs.push_back(uv);
  }

  void library(std::string name) {
    auto& known = names_.libraries;
    if (name.empty() || std::find(known.begin(), known.end(), name) != known.end()) return;
    known.push_back(std::move(name));
    names_.libraryLines.push_back(line_);
  }

  void useMaterial(std::string name) {
    if (name.empty()) { // "if none is given, a white material is used"
      material_ = kNone;
      return;
    }
    const auto [entry, added] = indexOfMaterial_.try_emplace(name, std::uint32_t(names_.materials.size()));
    material_ = entry->second;
    if (!added) return;
    names_.materials.push_back(std::move(name));
    names_.materialLines.push_back(line_);
  }

  void face(std::string_view rest) {
    splitTokens(withoutComment(rest), tokens_);
    if (tokens_.size() < 3)
      malformed(place(), "a face has at least 3 corners, here are " + std::to_string(tokens_.size()));
    corners_.clear();
    uvs_.clear();
    for (const std::string_view token : tokens_)
      corner(token);
    warnRepeats(corners_, warned(), warnings_);
    const std::size_t before = mesh_.triangles.size();
    const bool anyUv = std::any_of(uvs_.begin(), uvs_.end(), [](std::uint32_t uv) { return uv != kNone; });
    if (anyUv && mesh_.uvTriangles.empty()) mesh_.uvTriangles.assign(before, {kNone, kNone, kNone});
    const bool withUvs = anyUv || !mesh_.uvTriangles.empty();
    appendPolygon(mesh_, std::uint32_t(mesh_.lineOfFace.size()), corners_,
                  withUvs ? std::span<const std::uint32_t>(uvs_) : std::span<const std::uint32_t>());
    mesh_.lineOfFace.push_back(std::uint32_t(line_));
    if (material_ != kNone && mesh_.materialOfTriangle.empty())
      mesh_.materialOfTriangle.assign(before, kNone);
    if (material_ != kNone || !mesh_.materialOfTriangle.empty())
      mesh_.materialOfTriangle.resize(mesh_.triangles.size(), material_);
  }

  /// v, v/t, v/t/n, v//n, and the "v/" and "v//" that some exporters write.
  void corner(std::string_view token) {
    const char* at = token.data();
    const char* const end = at + token.size();
    std::array<int, 3> values{};
    for (std::size_t field = 0; field < 3; ++field) {
      if (field > 0) {
        if (at == end || *at != '/') break;
        ++at;
        if (at == end || *at == '/') continue;
      }
      const auto [stop, error] = std::from_chars(at, end, values[field]);
      if (error == std::errc::result_out_of_range)
        malformed(place(), "face corner " + inQuotes(token) + ": the index is out of range");
      if (error != std::errc()) break;
      if (values[field] == 0 && field == 0)
        malformed(place(), "face corner " + inQuotes(token) + ": index 0 (indices begin at 1)");
      if (values[field] == 0 && field == 1) strayCoordinate(token, line_);
      at = stop;
    }
    if (at != end || token[0] == '/')
      malformed(place(), "face corner " + inQuotes(token) + " is not of the form v, v/vt, v//vn or v/vt/vn");
    const auto vertex = resolve(values[0], mesh_.positions.size());
    if (!vertex) refuseVertex(values[0], line_);
    corners_.push_back(*vertex);
    const auto uv = values[1] == 0 ? std::nullopt : resolve(values[1], mesh_.uvs.size());
    if (values[1] != 0 && !uv) strayCoordinate(token, line_);
    uvs_.push_back(uv.value_or(kNone));
  }

  /// 0-based index from the file's: counted from 1, or back from the face when negative. Those that count
  /// from 1 may name what follows (checkIndices).
  static std::optional<std::uint32_t> resolve(int index, std::size_t above) {
    const std::int64_t resolved = index > 0 ? std::int64_t(index) - 1 : std::int64_t(above) + index;
    if (resolved < 0) return std::nullopt;
    return std::uint32_t(resolved);
  }

  [[noreturn]] void refuseVertex(int index, std::size_t line) const {
    const std::string backwards = index < 0 ? " above this line" : "";
    malformed({name_, line}, "vertex index " + std::to_string(index) + " is out of range: the file has " +
                                 std::to_string(mesh_.positions.size()) + " vertices" + backwards);
  }

  void strayCoordinate(std::string_view corner, std::size_t line) {
    warnings_.add("stray vt", {{}, line}, [&] {
      return "face corner " + inQuotes(corner) + " names a texture coordinate that the file does not have";
    });
  }

  /// What only the whole file can tell: indices beyond its end, and coordinates that are none.
  void checkIndices() {
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
      for (const std::uint32_t v : mesh_.triangles[t])
        if (v >= mesh_.positions.size()) refuseVertex(int(v) + 1, mesh_.lineOfFace[mesh_.faceOfTriangle[t]]);
    for (std::size_t t = 0; t < mesh_.uvTriangles.size(); ++t)
      for (std::uint32_t& uv : mesh_.uvTriangles[t]) {
        if (uv == kNone || uv < mesh_.uvs.size()) continue;
        strayCoordinate(".../" + std::to_string(uv + 1), mesh_.lineOfFace[mesh_.faceOfTriangle[t]]);
        uv = kNone;
      }
    settleTextureCoordinates(mesh_);
  }

  std::string_view name_;
  TriangleMesh& mesh_;
  ReadWarnings& warnings_;
  MaterialNames names_;
  std::size_t line_ = 0;
  std::vector<std::string_view> tokens_;
  std::vector<std::uint32_t> corners_, uvs_;
  std::unordered_map<std::string, std::uint32_t> indexOfMaterial_;
  std::uint32_t material_ = kNone;
};

} // namespace

TriangleMesh readObj(std::string_view text, const std::filesystem::path& path,
                     const std::filesystem::path& top) {
  const std::string name = path.filename().string();
  TriangleMesh mesh;
  ReadWarnings warnings;
  MaterialNames names = ObjReader(name, mesh, warnings).run(text);
  checkSize(mesh, {name});
  names.mesh = path;
  names.top = top.empty() ? path.parent_path() : top;
  addMaterials(mesh, names, warnings);
  mesh.warnings = warnings.texts();
  return mesh;
}

} // namespace chamfer
