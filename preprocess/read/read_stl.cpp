// STL, binary and ASCII. Binary is told by its size (84 bytes and 50 a facet) or by a control character in
// its first bytes, not by the first word: binary files that begin with "solid" exist. Bytes behind the last
// facet, and a count of 0 with facets behind it, are warned of. Not used, with a warning: colours, in either
// convention (VisCAM's: the highest bit of the attribute means that there is one; Materialise's: "COLOR=" in
// the header, and the bit means that the facet has the header's). Normals are not used: exporters write zeros
// and NaN there. A reader of our own: CGAL's merges equal points while it reads (welding is a later step
// here), reads ASCII that it cannot parse as if it were binary, and names no place.
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

std::size_t declaredFacets(std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + kHeader, sizeof count);
  return count;
}

/// How many facets to read: as many as declared, or what there is where 0 are.
std::size_t facetsToRead(std::string_view bytes, std::string_view name, ReadWarnings& warnings) {
  const std::size_t declared = declaredFacets(bytes), left = bytes.size() - kPrefix, whole = left / kFacet;
  if (declared > whole)
    malformed({name}, "no STL: " + std::to_string(bytes.size()) + " bytes, where a binary file of " +
                          std::to_string(declared) + " facets has " +
                          std::to_string(kPrefix + kFacet * declared) + "; it may be cut off");
  const std::size_t count = declared == 0 ? whole : declared;
  if (declared == 0 && whole > 0)
    warnings.add("count", {},
                 "the header declares 0 facets; the " + std::to_string(whole) + " behind it are read");
  if (left > count * kFacet)
    warnings.add("behind", {},
                 std::to_string(left - count * kFacet) + " bytes behind the last of " +
                     std::to_string(count) + " facets are not read");
  return count;
}

TriangleMesh readBinary(std::string_view bytes, std::string_view name) {
  TriangleMesh mesh;
  ReadWarnings warnings;
  const std::size_t count = facetsToRead(bytes, name, warnings);
  std::size_t coloured = 0;
  mesh.positions.reserve(3 * count);
  mesh.triangles.reserve(count);
  mesh.faceOfTriangle.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const char* const facet = bytes.data() + kPrefix + kFacet * i;
    float values[12]; // the normal, then the three corners
    std::memcpy(values, facet, sizeof values);
    std::array<Point3, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = Point3(values[3 * k + 3], values[3 * k + 4], values[3 * k + 5]);
      if (!isFinite(corners[k]))
        malformed({name}, "facet " + std::to_string(i) + " (byte " + std::to_string(kPrefix + kFacet * i) +
                              "): a coordinate is not finite");
    }
    coloured += facet[kFacet - 2] != 0 || facet[kFacet - 1] != 0;
    appendFacet(mesh, corners);
  }
  if (coloured > 0)
    warnings.add("colours", {},
                 std::to_string(coloured) +
                     " facets have an attribute (a colour, as a rule), which is not used");
  else if (bytes.substr(0, kHeader).find("COLOR=") != std::string_view::npos)
    warnings.add("colours", {}, "the header has a colour for all facets, which is not used");
  mesh.warnings = warnings.texts();
  return mesh;
}

/// solid [name to the end of the line] { facet normal n n n outer loop vertex x y z (three) endloop endfacet
/// } endsolid [name to the end of the line], any number of solids, words in any case, over any lines.
class AsciiReader {
public:
  AsciiReader(std::string_view text, std::string_view name) : reader_(text), place_{name} {}

  TriangleMesh run() {
    if (!advance()) malformed(place_, "empty file");
    do {
      expect("solid");
      skipLine();
      while (true) {
        need("endsolid");
        if (word() == "endsolid") break;
        facet();
      }
      skipLine();
    } while (advance());
    return std::move(mesh_);
  }

private:
  /// To the next word, over the ends of lines.
  bool advance() {
    ++next_;
    std::string_view line;
    while (next_ >= tokens_.size()) {
      if (!reader_.next(line)) return false;
      place_.line = reader_.number();
      splitTokens(line, tokens_);
      next_ = 0;
    }
    return true;
  }

  void skipLine() { next_ = tokens_.size(); }

  std::string word() const { return lowerCase(tokens_[next_]); }

  void need(const char* what) {
    if (!advance())
      malformed(place_, std::string("the file ends where \"") + what + "\" should follow: truncated");
  }

  void expect(const char* what) {
    if (word() != what) malformed(place_, inQuotes(tokens_[next_]) + " where \"" + what + "\" should be");
  }

  void needWord(const char* what) {
    need(what);
    expect(what);
  }

  void facet() {
    expect("facet");
    needWord("normal");
    // Up to three words of any kind: "nan", "-1.#IND".
    need("outer");
    for (int i = 0; i < 3 && word() != "outer"; ++i)
      need("outer");
    expect("outer");
    needWord("loop");
    std::array<Point3, 3> corners;
    for (Point3& corner : corners) {
      needWord("vertex");
      if (&corner == &corners[0]) mesh_.lineOfFace.push_back(std::uint32_t(place_.line));
      std::array<std::string_view, 3> coordinates;
      for (std::string_view& coordinate : coordinates) {
        need("a coordinate");
        coordinate = tokens_[next_];
      }
      corner = parsePoint(coordinates, place_);
    }
    needWord("endloop");
    needWord("endfacet");
    appendFacet(mesh_, corners);
  }

  LineReader reader_;
  TextPlace place_;
  std::vector<std::string_view> tokens_;
  std::size_t next_ = 0;
  TriangleMesh mesh_;
};

/// No text holds a control character other than blanks and ends of lines; a binary count and its floats do.
bool looksBinary(std::string_view bytes) {
  constexpr std::size_t kLooked = 1024;
  const std::string_view first = bytes.substr(0, kLooked);
  return bytes.size() >= kPrefix && std::any_of(first.begin(), first.end(), [](char c) {
           const auto byte = static_cast<unsigned char>(c);
           return byte < 0x20 && !(byte >= 0x09 && byte <= 0x0d);
         });
}

} // namespace

TriangleMesh readStl(std::string_view bytes, std::string_view name) {
  const bool sizeFits = bytes.size() >= kPrefix && bytes.size() == kPrefix + kFacet * declaredFacets(bytes);
  TriangleMesh mesh;
  if (sizeFits || looksBinary(bytes)) {
    mesh = readBinary(bytes, name);
  } else {
    const std::string_view text = withoutByteOrderMark(bytes, name);
    const std::size_t first = std::min(text.find_first_not_of(" \t\r\n"), text.size());
    if (lowerCase(text.substr(first, 5)) == "solid")
      mesh = AsciiReader(text, name).run();
    else if (bytes.size() < kPrefix)
      malformed({name}, "no STL: shorter than a binary header, and not \"solid ...\"");
    else
      mesh = readBinary(bytes, name);
  }
  mesh.soup = true;
  checkSize(mesh, {name});
  return mesh;
}

} // namespace chamfer
