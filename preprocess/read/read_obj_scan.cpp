#include "preprocess/read/read_obj_scan.h"

#include "preprocess/read/read_text.h"

#include <algorithm>
#include <charconv>

namespace chamfer {
namespace {

constexpr const char* kSilent[] = {"g",        "o",   "s",          "mg",        "bevel",  "c_interp",
                                   "d_interp", "lod", "shadow_obj", "trace_obj", "maplib", "usemap"};

/// Overwrites "\" + line end with blanks, except in comments (where it is the end of a path more often than
/// not). Returns the offsets of the line ends that went.
std::vector<std::size_t> joinContinuedLines(std::string& text) {
  std::vector<std::size_t> joins;
  std::size_t lineStart = 0; // of the line that `scanned` lies in
  std::size_t scanned = 0;
  for (std::size_t at = text.find('\\'); at != std::string::npos; at = text.find('\\', at + 1)) {
    if (at + 1 >= text.size() || (text[at + 1] != '\n' && text[at + 1] != '\r')) continue;
    for (; scanned < at; ++scanned)
      if (text[scanned] == '\n' || text[scanned] == '\r') lineStart = scanned + 1;
    const std::size_t first = text.find_first_not_of(" \t", lineStart);
    if (text[first] == '#') continue;
    const bool two = text.compare(at + 1, 2, "\r\n") == 0;
    joins.push_back(at + 1);
    std::fill_n(text.begin() + std::ptrdiff_t(at), two ? 3 : 2, ' ');
  }
  return joins;
}

class Scanner {
public:
  Scanner(std::string& text, std::string_view name) : text_(text), place_{name} {}

  ObjScan run() {
    if (text_.starts_with("\xef\xbb\xbf")) text_.replace(0, 3, "   ");
    const std::vector<std::size_t> joins = joinContinuedLines(text_);
    std::size_t joined = 0;
    LineReader reader(text_);
    std::string_view line;
    while (true) {
      const std::size_t start = reader.offset();
      if (!reader.next(line)) break;
      while (joined < joins.size() && joins[joined] < start)
        ++joined;
      place_.line = reader.number() + joined;
      statement(line);
    }
    if (skipped_ > 0)
      scan_.warnings.push_back(
          "line " + std::to_string(firstSkipped_) + ": " + inQuotes(skippedWord_) +
          (skipped_ > 1 ? " and " + std::to_string(skipped_ - 1) + " further lines are" : " is") +
          " no part of a surface and not read");
    return std::move(scan_);
  }

private:
  void statement(std::string_view line) {
    const auto blank = [](char c) { return c == ' ' || c == '\t'; };
    line.remove_prefix(std::size_t(std::find_if_not(line.begin(), line.end(), blank) - line.begin()));
    if (line.empty() || line[0] == '#') return;
    const std::string_view word(line.begin(), std::find_if(line.begin(), line.end(), blank));
    const std::string_view rest = line.substr(word.size());
    if (word == "v")
      vertex(rest);
    else if (word == "f")
      face(rest);
    else if (word == "vt")
      textureCoordinate(rest);
    else if (word == "vn")
      normal(rest);
    else if (word == "mtllib")
      library(rest);
    else if (word != "usemtl" &&
             std::find(std::begin(kSilent), std::end(kSilent), word) == std::end(kSilent)) {
      if (skipped_++ == 0) {
        skippedWord_ = word;
        firstSkipped_ = place_.line;
      }
    }
  }

  void vertex(std::string_view rest) {
    splitTokens(withoutComment(rest), tokens_);
    const std::size_t n = tokens_.size();
    // x y z, and w or a colour (with or without alpha) or both.
    if (n < 3 || n == 5 || n > 8)
      malformed(place_, "a vertex has 3 coordinates, here are " + std::to_string(n) + " numbers");
    scan_.positions.push_back(parsePoint(tokens_, place_));
    for (std::size_t i = 3; i < n; ++i)
      checkNumber(tokens_[i], "vertex weight or colour", place_);
  }

  void textureCoordinate(std::string_view rest) {
    splitTokens(withoutComment(rest), tokens_);
    if (tokens_.empty() || tokens_.size() > 3)
      malformed(place_,
                "a texture coordinate has 1 to 3 numbers, here are " + std::to_string(tokens_.size()));
    std::array<float, 2> uv{};
    for (std::size_t i = 0; i < tokens_.size(); ++i) {
      const double value = parseReal(tokens_[i], "texture coordinate", place_);
      if (i < 2) uv[i] = float(value);
    }
    scan_.uvs.push_back(uv);
  }

  void normal(std::string_view rest) {
    splitTokens(withoutComment(rest), tokens_);
    if (tokens_.size() != 3)
      malformed(place_, "a normal has 3 numbers, here are " + std::to_string(tokens_.size()));
    for (const std::string_view token : tokens_)
      checkNumber(token, "normal", place_);
  }

  void face(std::string_view rest) {
    const std::string_view bare = withoutComment(rest);
    overwrite(rest.substr(bare.size())); // tinyobjloader would read the comment's words as corners
    splitTokens(bare, tokens_);
    if (tokens_.size() < 3)
      malformed(place_, "a face has at least 3 corners, here are " + std::to_string(tokens_.size()));
    for (const std::string_view token : tokens_)
      corner(token);
    scan_.lineOfFace.push_back(std::uint32_t(place_.line));
    scan_.above.push_back({std::uint32_t(scan_.positions.size()), std::uint32_t(scan_.uvs.size())});
  }

  /// v, v/t, v/t/n, v//n, and the "v/" and "v//" that some exporters write.
  void corner(std::string_view token) {
    const char* at = token.data();
    const char* const end = at + token.size();
    for (int field = 0; field < 3; ++field) {
      if (field > 0) {
        if (at == end || *at != '/') break;
        ++at;
        if (at == end || *at == '/') continue;
      }
      int value = 0;
      const auto [stop, error] = std::from_chars(at, end, value);
      if (error == std::errc::result_out_of_range)
        malformed(place_, "face corner " + inQuotes(token) + ": the index is out of range");
      if (error != std::errc()) break;
      if (value == 0) malformed(place_, "face corner " + inQuotes(token) + ": index 0 (indices begin at 1)");
      at = stop;
    }
    if (at != end || token[0] == '/')
      malformed(place_, "face corner " + inQuotes(token) + " is not of the form v, v/vt, v//vn or v/vt/vn");
    overwrite(token.substr(token.find_last_not_of('/') +
                           1)); // tinyobjloader would go on to the next corner's index
  }

  void overwrite(std::string_view part) {
    std::fill_n(text_.begin() + (part.data() - text_.data()), part.size(), ' ');
  }

  void library(std::string_view rest) {
    const std::size_t first = rest.find_first_not_of(" \t");
    if (first == std::string_view::npos) return;
    const std::string_view name = rest.substr(first, rest.find_last_not_of(" \t") + 1 - first);
    auto& known = scan_.libraries;
    if (std::find(known.begin(), known.end(), name) == known.end()) known.emplace_back(name);
  }

  std::string& text_;
  TextPlace place_;
  ObjScan scan_;
  std::vector<std::string_view> tokens_;
  std::size_t skipped_ = 0, firstSkipped_ = 0;
  std::string skippedWord_;
};

} // namespace

ObjScan scanObj(std::string& text, std::string_view name) { return Scanner(text, name).run(); }

} // namespace chamfer
