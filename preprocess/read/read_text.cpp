#include "preprocess/read/read_text.h"

#include "common/error.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace chamfer {
namespace {

/// from_chars takes no leading '+', which OBJ exporters do write; a sign may not follow another.
std::string_view withoutPlus(std::string_view token) {
  if (token.size() > 1 && token[0] == '+' && token[1] != '-') token.remove_prefix(1);
  return token;
}

/// True when all of `token` is one number. Out of range counts: `value` is then infinite, or 0 when too
/// small.
bool parseDouble(std::string_view token, double& value) {
  token = withoutPlus(token);
  const char* end = token.data() + token.size();
  const auto [stop, error] = std::from_chars(token.data(), end, value);
  if (stop != end || token.empty()) return false;
  if (error == std::errc::result_out_of_range) {
    // Too large and too small look the same to from_chars; the exponent's sign, or a leading "0.", tells them
    // apart.
    const std::size_t e = token.find_first_of("eE");
    const std::string_view mantissa = token.substr(token[0] == '-' ? 1 : 0);
    const bool small =
        e != std::string_view::npos ? token[e + 1] == '-' : mantissa[0] == '0' || mantissa[0] == '.';
    value = small ? 0 : INFINITY;
    return true;
  }
  return error == std::errc();
}

} // namespace

void malformed(const TextPlace& place, const std::string& what) {
  std::string text(place.file);
  if (place.line > 0) text += ":" + std::to_string(place.line);
  // What names a field may be the file's own word, too.
  throw Error(ErrorKind::Malformed, text + ": " + printable(what, what.size()));
}

double parseReal(std::string_view token, const char* what, const TextPlace& place) {
  double value = 0;
  if (!parseDouble(token, value))
    malformed(place, std::string(what) + " " + inQuotes(token) + " is not a number");
  if (!std::isfinite(value)) malformed(place, std::string(what) + " " + inQuotes(token) + " is not finite");
  return value;
}

double checkNumber(std::string_view token, const char* what, const TextPlace& place) {
  double value = 0;
  if (!parseDouble(token, value))
    malformed(place, std::string(what) + " " + inQuotes(token) + " is not a number");
  return value;
}

std::optional<double> finiteNumber(std::string_view token) {
  double value = 0;
  if (!parseDouble(token, value) || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::uint64_t parseCount(std::string_view token, std::uint64_t most, const char* what,
                         const TextPlace& place) {
  std::uint64_t value = 0;
  const char* end = token.data() + token.size();
  const auto [stop, error] = std::from_chars(token.data(), end, value);
  if (stop != end || error == std::errc::invalid_argument)
    malformed(place, std::string(what) + " " + inQuotes(token) + " is not a whole number");
  if (error != std::errc() || value > most)
    malformed(place, std::string(what) + " " + inQuotes(token) + " is above " + std::to_string(most));
  return value;
}

Point3 parsePoint(std::span<const std::string_view> tokens, const TextPlace& place) {
  return {parseReal(tokens[0], "coordinate x", place), parseReal(tokens[1], "coordinate y", place),
          parseReal(tokens[2], "coordinate z", place)};
}

void splitTokens(std::string_view line, std::vector<std::string_view>& tokens) {
  tokens.clear();
  const char* at = line.data();
  const char* const end = at + line.size();
  const auto blank = [](char c) { return c == ' ' || c == '\t'; };
  while (true) {
    while (at != end && blank(*at))
      ++at;
    if (at == end) return;
    const char* const start = at;
    while (at != end && !blank(*at))
      ++at;
    tokens.emplace_back(start, std::size_t(at - start));
  }
}

std::string_view withoutComment(std::string_view line) { return line.substr(0, line.find('#')); }

std::string_view withoutByteOrderMark(std::string_view text, std::string_view file) {
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
    malformed({file}, "the text is UTF-16; save it as UTF-8");
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  return text;
}

bool LineReader::next(std::string_view& line) {
  if (at_ >= text_.size()) return false;
  // The next '\n' is kept over lines that end in '\r', so that a file without any is not searched again and
  // again.
  if (newline_ < at_ || number_ == 0) newline_ = std::min(text_.find('\n', at_), text_.size());
  const std::size_t end = std::min(text_.substr(0, newline_).find('\r', at_), newline_);
  line = text_.substr(at_, end - at_);
  at_ = end + (end + 1 == newline_ && newline_ < text_.size() ? 2 : 1);
  at_ = std::min(at_, text_.size());
  ++number_;
  return true;
}

bool ContinuedLineReader::next(std::string_view& line) {
  const auto goesOn = [&] {
    const std::size_t last = line.find_last_not_of(" \t");
    if (last == std::string_view::npos || line[last] != '\\' || line.find('#') != std::string_view::npos)
      return false;
    line = line.substr(0, last);
    return true;
  };
  if (!lines_.next(line)) return false;
  number_ = lines_.number();
  if (!goesOn()) return true;
  joined_.clear();
  while (true) {
    joined_ += line;
    joined_ += ' ';
    line = {};
    if (!lines_.next(line) || !goesOn()) break;
  }
  joined_ += line;
  line = joined_;
  return true;
}

} // namespace chamfer
