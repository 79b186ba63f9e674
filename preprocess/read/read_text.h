// Strict reading of text: lines of any ending, tokens, numbers that must parse to their last character.
// Shared by the readers of OBJ, OFF, PLY and STL; nothing here knows a format.
#pragma once

#include "common/text.h"
#include "common/vec.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace chamfer {

/// Where a reader is, for its messages: "cube.obj:12: ...".
struct TextPlace {
  std::string_view file; ///< name without folder
  std::size_t line = 0;  ///< 1-based; 0: the file as a whole
};

/// Throws Error(Malformed): place, then `what`.
[[noreturn]] void malformed(const TextPlace& place, const std::string& what);

/// A finite number in full; "1,5", "0x1p3", "nan", "1e999" and "3.1+e2" are errors. `what` names the field.
/// A number too small for a double is 0.
double parseReal(std::string_view token, const char* what, const TextPlace& place);

/// The same, but nan and inf pass: for colours, normals and texture coordinates, which are no fault of the
/// shape.
double checkNumber(std::string_view token, const char* what, const TextPlace& place);

/// The finite number that `token` is in full; nothing when it is none.
std::optional<double> finiteNumber(std::string_view token);

/// A whole decimal number from 0 to `most`.
std::uint64_t parseCount(std::string_view token, std::uint64_t most, const char* what,
                         const TextPlace& place);

/// Parses the first three of `tokens` (there must be that many) as a position.
Point3 parsePoint(std::span<const std::string_view> tokens, const TextPlace& place);

/// Splits at blanks and tabs, replacing what `tokens` held.
void splitTokens(std::string_view line, std::vector<std::string_view>& tokens);

/// `line` up to a '#'.
std::string_view withoutComment(std::string_view line);

/// `text` without the byte order mark of UTF-8. Throws Error(Malformed) where it begins with that of UTF-16.
std::string_view withoutByteOrderMark(std::string_view text, std::string_view file);

/// Goes through a text line by line; "\n", "\r\n" and "\r" end a line, the last one may lack its end.
class LineReader {
public:
  explicit LineReader(std::string_view text) : text_(text) {}
  bool next(std::string_view& line);
  std::size_t number() const { return number_; } ///< of the line that next() gave last, 1-based
  std::size_t offset() const { return at_; }     ///< of the first byte behind that line's end
  std::size_t left() const { return text_.size() - at_; }

private:
  std::string_view text_;
  std::size_t at_ = 0, number_ = 0, newline_ = 0;
};

/// The same line by line of what is meant: a line whose last character other than a blank is '\\' goes on in
/// the next one, unless it holds a '#' (a comment's path may end so).
class ContinuedLineReader {
public:
  explicit ContinuedLineReader(std::string_view text) : lines_(text) {}
  /// `line` is valid until the next call.
  bool next(std::string_view& line);
  std::size_t number() const { return number_; } ///< of the first line of what next() gave last, 1-based

private:
  LineReader lines_;
  std::string joined_;
  std::size_t number_ = 0;
};

} // namespace chamfer
