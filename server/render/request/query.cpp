#include "server/render/request/query.h"

#include "server/render/request/parameter_error.h"

namespace chamfer {
namespace {

int hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

bool unreserved(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '.' ||
         c == '_' || c == '~';
}

std::string decodeQueryPart(std::string_view part, std::string_view whole) {
  if (std::optional<std::string> text = percentDecode(part)) return *text;
  throw ParameterError(ErrorKind::Usage,
                       "the query has a broken percent escape, or one of a control character", "query",
                       std::string(whole));
}

} // namespace

std::optional<std::string> percentDecode(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    char c = text[i];
    if (c == '%') {
      if (i + 2 >= text.size()) return std::nullopt;
      const int high = hexDigit(text[i + 1]), low = hexDigit(text[i + 2]);
      if (high < 0 || low < 0) return std::nullopt;
      c = static_cast<char>(high * 16 + low);
      i += 2;
    }
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f) return std::nullopt;
    out += c;
  }
  return out;
}

std::string percentEncode(std::string_view text, bool keepSlashes) {
  static constexpr char kHex[] = "0123456789ABCDEF";
  std::string out;
  for (const char c : text) {
    if (unreserved(c) || (keepSlashes && c == '/')) {
      out += c;
    } else {
      const auto byte = static_cast<unsigned char>(c);
      out += '%';
      out += kHex[byte >> 4];
      out += kHex[byte & 15];
    }
  }
  return out;
}

std::vector<std::string_view> splitPath(std::string_view path) {
  std::vector<std::string_view> segments;
  if (path.starts_with('/')) path.remove_prefix(1);
  for (;;) {
    const std::size_t slash = path.find('/');
    segments.push_back(path.substr(0, slash));
    if (slash == std::string_view::npos) return segments;
    path.remove_prefix(slash + 1);
  }
}

std::string decodePath(std::span<const std::string_view> segments) {
  std::string path;
  for (const std::string_view segment : segments) {
    const auto part = percentDecode(segment);
    if (!part)
      throw Error(ErrorKind::Usage, "the path has a broken percent escape, or one of a control character");
    if (!path.empty()) path += '/';
    path += *part;
  }
  return path;
}

Query parseQuery(std::string_view text) {
  Query query;
  if (text.empty()) return query;
  for (std::string_view rest = text;;) {
    const std::size_t ampersand = rest.find('&');
    const std::string_view part = rest.substr(0, ampersand);
    const std::size_t equals = part.find('=');
    if (equals == std::string_view::npos || equals == 0)
      throw ParameterError(ErrorKind::Usage, "every part of the query must be name=value", "query",
                           std::string(part));
    std::string name = decodeQueryPart(part.substr(0, equals), text);
    std::string value = decodeQueryPart(part.substr(equals + 1), text);
    for (const auto& given : query)
      if (given.first == name)
        throw ParameterError(ErrorKind::Usage, "the parameter \"" + name + "\" is given more than once", name,
                             value);
    query.emplace_back(std::move(name), std::move(value));
    if (ampersand == std::string_view::npos) return query;
    rest.remove_prefix(ampersand + 1);
  }
}

} // namespace chamfer
