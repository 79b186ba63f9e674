// OFF (Geomview's), in the forms that hold 3D surfaces: OFF, COFF, NOFF, STOFF and their combinations, ASCII.
// One vertex and one face a line, '#' comments anywhere. The keyword may be missing (with a warning), as
// Geomview allows. Texture coordinates are read, colours are not used, with a warning; normals without one. A
// reader of our own: CGAL's says true or false and neither line nor value, takes a 4OFF for a surface in
// space and refuses "OFF8 6 12"; OpenMesh's returns true for broken numbers and goes on for minutes where the
// counts are too large.
#include "preprocess/read/read_formats.h"

#include <cmath>

namespace chamfer {
namespace {

class OffReader {
public:
  OffReader(std::string_view text, std::string_view name) : reader_(text), place_{name} {}

  TriangleMesh run() {
    header();
    for (std::size_t i = 0; i < vertices_; ++i)
      vertex(i);
    for (std::size_t i = 0; i < faces_; ++i)
      face(i);
    if (advance())
      malformed(place_, inQuotes(tokens_[0]) + " behind the last of " + std::to_string(faces_) + " faces");
    settleTextureCoordinates(mesh_);
    mesh_.warnings = warnings_.texts();
    return std::move(mesh_);
  }

private:
  /// The next line that holds anything, in tokens_.
  bool advance() {
    std::string_view line;
    while (reader_.next(line)) {
      place_.line = reader_.number();
      splitTokens(withoutComment(line), tokens_);
      if (!tokens_.empty()) return true;
    }
    return false;
  }

  void header() {
    if (!advance()) malformed(place_, "empty file");
    const bool keyword = !finiteNumber(tokens_[0]);
    if (!keyword)
      warnings_.add("keyword", {{}, place_.line},
                    "the keyword OFF is missing; the numbers are read as its counts");
    if (keyword) readKeyword();
    if (tokens_.empty() && !advance()) malformed(place_, "the file ends before the counts");
    if (tokens_.size() < 2 || tokens_.size() > 3)
      malformed(place_, "the counts are two or three numbers (vertices, faces, edges)");
    // A line takes two bytes at least, so larger counts are wrong whatever follows.
    const std::size_t most = reader_.left() + 2;
    vertices_ = parseCount(tokens_[0], most, "the number of vertices", place_);
    faces_ = parseCount(tokens_[1], most, "the number of faces", place_);
    if (tokens_.size() == 3) checkNumber(tokens_[2], "the number of edges", place_);
    mesh_.positions.reserve(vertices_);
    mesh_.lineOfFace.reserve(faces_);
  }

  /// Takes the keyword from tokens_.
  void readKeyword() {
    const std::size_t off = tokens_[0].find("OFF");
    if (off == std::string_view::npos)
      malformed(place_, inQuotes(tokens_[0]) +
                            " where the keyword OFF should be; other Geomview blocks are not read");
    std::string_view prefix = tokens_[0].substr(0, off);
    textured_ = prefix.starts_with("ST");
    if (textured_) prefix.remove_prefix(2);
    coloured_ = prefix.starts_with("C");
    if (coloured_) prefix.remove_prefix(1);
    if (prefix.starts_with("N")) prefix.remove_prefix(1);
    if (!prefix.empty())
      malformed(place_,
                inQuotes(tokens_[0]) + ": vertices of other than three coordinates are no solid in space");
    plain_ = off == 0;
    tokens_[0].remove_prefix(off + 3); // "OFF8 6 12" is in use
    if (tokens_[0].empty()) tokens_.erase(tokens_.begin());
    if (!tokens_.empty() && tokens_[0] == "BINARY")
      malformed(place_, "binary OFF is not read; write it as text");
  }

  void vertex(std::size_t i) {
    if (!advance())
      malformed(place_, "the file ends after " + std::to_string(i) + " of " + std::to_string(vertices_) +
                            " vertices");
    const std::size_t n = tokens_.size();
    if (n < 3 || (plain_ && n > 3) || n > 12)
      malformed(place_,
                "vertex " + std::to_string(i) + " has " + std::to_string(n) + " numbers where 3 belong");
    mesh_.positions.push_back(parsePoint(tokens_, place_));
    double last[2] = {}; // the texture coordinate stands behind normal and colour
    for (std::size_t k = 3; k < n; ++k) {
      last[0] = last[1];
      last[1] = checkNumber(tokens_[k], "normal, colour or texture coordinate", place_);
    }
    if (textured_) textureCoordinate(n >= 5, {float(last[0]), float(last[1])});
    if (coloured_ && n >= 6) warnings_.add("colours", {{}, place_.line}, "colours of vertices are not used");
  }

  void textureCoordinate(bool there, std::array<float, 2> uv) {
    if (!there || !std::isfinite(uv[0]) || !std::isfinite(uv[1])) {
      warnings_.add("bad uv", {{}, place_.line},
                    "a texture coordinate is missing or not finite; what names it has none");
      uv[0] = NAN;
    }
    mesh_.uvs.push_back(uv);
  }

  void face(std::size_t i) {
    if (!advance())
      malformed(place_,
                "the file ends after " + std::to_string(i) + " of " + std::to_string(faces_) + " faces");
    const std::size_t corners = parseCount(tokens_[0], UINT32_MAX, "the number of corners", place_);
    if (corners < 3) malformed(place_, "a face has at least 3 corners, here are " + std::to_string(corners));
    if (corners >= tokens_.size())
      malformed(place_, "a face of " + std::to_string(corners) + " corners, but " +
                            std::to_string(tokens_.size() - 1) + " indices");
    corners_.clear();
    for (std::size_t k = 1; k <= corners; ++k) {
      if (mesh_.positions.empty()) malformed(place_, "a face without vertices");
      corners_.push_back(
          std::uint32_t(parseCount(tokens_[k], mesh_.positions.size() - 1, "vertex index", place_)));
    }
    // Behind the corners: nothing, an index into a colour map, or 3 or 4 numbers of a colour.
    if (tokens_.size() - 1 - corners > 4)
      malformed(place_, std::to_string(tokens_.size() - 1 - corners) + " numbers behind the face's corners");
    for (std::size_t k = corners + 1; k < tokens_.size(); ++k)
      checkNumber(tokens_[k], "face colour", place_);
    if (tokens_.size() - 1 > corners)
      warnings_.add("face colours", {{}, place_.line}, "colours of faces are not used");
    warnRepeats(corners_, {{}, place_.line}, warnings_);
    mesh_.lineOfFace.push_back(std::uint32_t(place_.line));
    appendPolygon(mesh_, std::uint32_t(i), corners_,
                  textured_ ? std::span<const std::uint32_t>(corners_) : std::span<const std::uint32_t>());
  }

  LineReader reader_;
  TextPlace place_;
  std::vector<std::string_view> tokens_;
  std::vector<std::uint32_t> corners_;
  std::size_t vertices_ = 0, faces_ = 0;
  bool plain_ = true, textured_ = false, coloured_ = false;
  ReadWarnings warnings_;
  TriangleMesh mesh_;
};

} // namespace

TriangleMesh readOff(std::string_view text, std::string_view name) {
  TriangleMesh mesh = OffReader(withoutByteOrderMark(text, name), name).run();
  checkSize(mesh, {name});
  return mesh;
}

} // namespace chamfer
