// STL, binary and ASCII. Which of the two is decided by the size (84 bytes and 50 a facet), not by the first
// word: binary files that begin with "solid" exist. Normals are not used: exporters write zeros and NaN
// there. A reader of our own: CGAL's merges equal points while it reads (welding is a later step here), reads
// ASCII that it cannot parse as if it were binary, and names no place.
#include "preprocess/read/read_formats.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace chamfer {
namespace {

static_assert(std::endian::native == std::endian::little, "binary STL is little-endian");

constexpr std::size_t kHeader = 80, kPrefix = 84, kFacet = 50;

void appendFacet(TriangleMesh& mesh, const std::array<Point3, 3>& corners) {
  const std::uint32_t first = std::uint32_t(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), corners.begin(), corners.end());
  mesh.faceOfTriangle.push_back(std::uint32_t(mesh.triangles.size()));
  mesh.triangles.push_back({first, first + 1, first + 2});
}

std::size_t binaryFacets(std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + kHeader, sizeof count);
  return count;
}

TriangleMesh readBinary(std::string_view bytes, std::string_view name) {
  TriangleMesh mesh;
  const std::size_t count = binaryFacets(bytes);
  mesh.positions.reserve(3 * count);
  mesh.triangles.reserve(count);
  mesh.faceOfTriangle.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    float values[12]; // the normal, then the three corners
    std::memcpy(values, bytes.data() + kPrefix + kFacet * i, sizeof values);
    std::array<Point3, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = Point3(values[3 * k + 3], values[3 * k + 4], values[3 * k + 5]);
      if (!isFinite(corners[k]))
        malformed({name}, "facet " + std::to_string(i) + " (byte " + std::to_string(kPrefix + kFacet * i) +
                              "): a coordinate is not finite");
    }
    appendFacet(mesh, corners);
  }
  return mesh;
}

/// solid [name] { facet normal n n n / outer loop / vertex x y z (three) / endloop / endfacet } endsolid
/// [name], any number of solids, words in any case, one of these a line.
class AsciiReader {
public:
  AsciiReader(std::string_view text, std::string_view name) : reader_(text), place_{name} {}

  TriangleMesh run() {
    if (!advance()) malformed(place_, "empty file");
    do {
      expect("solid");
      while (true) {
        need("endsolid");
        if (is("endsolid")) break;
        facet();
      }
    } while (advance());
    return std::move(mesh_);
  }

private:
  bool advance() {
    std::string_view line;
    while (reader_.next(line)) {
      place_.line = reader_.number();
      splitTokens(line, tokens_);
      if (!tokens_.empty()) return true;
    }
    return false;
  }

  void need(const char* word) {
    if (!advance())
      malformed(place_, std::string("the file ends where \"") + word + "\" should follow: truncated");
  }

  bool is(const char* word) const { return lowerCase(tokens_[0]) == word; }

  void expect(const char* word, const char* second = nullptr) {
    if (!is(word) || (second && (tokens_.size() < 2 || lowerCase(tokens_[1]) != second)))
      malformed(place_, inQuotes(tokens_[0]) + " where \"" + word +
                            (second ? std::string(" ") + second : "") + "\" should be");
  }

  void facet() {
    expect("facet", "normal");
    need("outer loop");
    expect("outer", "loop");
    std::array<Point3, 3> corners;
    for (Point3& corner : corners) {
      need("vertex");
      expect("vertex");
      if (tokens_.size() != 4)
        malformed(place_,
                  "a vertex has 3 coordinates, here are " + std::to_string(tokens_.size() - 1) + " words");
      corner = parsePoint(std::span(tokens_).subspan(1), place_);
    }
    mesh_.lineOfFace.push_back(std::uint32_t(place_.line - 2));
    need("endloop");
    expect("endloop");
    need("endfacet");
    expect("endfacet");
    appendFacet(mesh_, corners);
  }

  LineReader reader_;
  TextPlace place_;
  std::vector<std::string_view> tokens_;
  TriangleMesh mesh_;
};

} // namespace

TriangleMesh readStl(std::string_view bytes, std::string_view name) {
  const bool sizeFits = bytes.size() >= kPrefix && bytes.size() == kPrefix + kFacet * binaryFacets(bytes);
  const std::size_t first = std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size());
  const bool saysSolid = lowerCase(bytes.substr(first, 5)) == "solid";
  TriangleMesh mesh;
  if (sizeFits)
    mesh = readBinary(bytes, name);
  else if (saysSolid)
    mesh = AsciiReader(bytes, name).run();
  else if (bytes.size() < kPrefix)
    malformed({name}, "no STL: shorter than a binary header, and not \"solid ...\"");
  else
    malformed({name}, "no STL: " + std::to_string(bytes.size()) + " bytes, where a binary file of " +
                          std::to_string(binaryFacets(bytes)) + " facets has " +
                          std::to_string(kPrefix + kFacet * binaryFacets(bytes)));
  mesh.soup = true;
  checkSize(mesh, {name});
  return mesh;
}

} // namespace chamfer
