#include "server/http/connection/request_head.h"

#include "common/text.h"

#include "server/http/schema/limits.h"

#include <algorithm>
#include <charconv>

namespace chamfer::http {
namespace {

/// RFC 9110, 5.6.2.
bool tokenCharacter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         std::string_view("!#$%&'*+-.^_`|~").find(c) != std::string_view::npos;
}
bool isToken(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), tokenCharacter);
}
bool fieldCharacter(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return c == '\t' || (byte >= 0x20 && byte != 0x7f);
}

[[noreturn]] void refuse(int status, const char* kind, const std::string& detail) {
  Problem problem;
  problem.status = status;
  problem.kind = kind;
  problem.detail = detail;
  problem.close = true;
  throw ProblemError(problem);
}
[[noreturn]] void malformed(const std::string& detail) { refuse(400, errorWord(ErrorKind::Usage), detail); }

void parseRequestLine(std::string_view line, RequestHead& head) {
  const std::size_t first = line.find(' '), last = line.rfind(' ');
  if (first == std::string_view::npos || first == last)
    malformed("the request line must be: method, blank, target, blank, version");
  head.method = line.substr(0, first);
  const std::string_view target = line.substr(first + 1, last - first - 1), version = line.substr(last + 1);
  if (head.method.size() > 16 || !isToken(head.method)) malformed("the method is not a token");
  if (version == "HTTP/1.0")
    head.http11 = head.keepAlive = false;
  else if (version != "HTTP/1.1") {
    if (version.starts_with("HTTP/")) refuse(505, "version", "only HTTP/1.1 and HTTP/1.0 are spoken here");
    malformed("the request line must end with the version");
  }
  if (target.size() > kMaxTargetBytes)
    refuse(414, errorWord(ErrorKind::PayloadTooLarge),
           "the target has " + std::to_string(target.size()) + " bytes, at most " +
               std::to_string(kMaxTargetBytes) + " are read");
  if (!target.starts_with('/')) malformed("the target must be a path that begins with '/'");
  for (const char c : target)
    if (c <= 0x20 || c >= 0x7f || c == '#') // bytes above 127 are negative
      malformed("the target holds a byte that must be percent-encoded");
  head.target = target;
}

std::size_t parseLength(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc{} || end != text.data() + text.size())
    malformed("Content-Length must be one whole decimal number");
  return value;
}

/// Comma-separated list that holds `word`, in any case.
bool listHolds(std::string_view list, std::string_view word) {
  for (;;) {
    const std::size_t comma = list.find(',');
    if (lowerCase(trimmed(list.substr(0, comma))) == word) return true;
    if (comma == std::string_view::npos) return false;
    list.remove_prefix(comma + 1);
  }
}

/// Who asks, and for what, must be said once: of two words a proxy could go by the one, this server by the
/// other.
void refuseRepeated(const Headers& headers) {
  for (const std::string_view name : {"authorization", "x-api-key", "content-type", "x-request-id"}) {
    const auto named = [&](const auto& field) { return field.first == name; };
    if (std::count_if(headers.begin(), headers.end(), named) > 1)
      malformed("more than one " + std::string(name) + " field");
  }
}

void interpretFields(RequestHead& head) {
  int hosts = 0, lengths = 0;
  for (const auto& [name, value] : head.headers) {
    if (name == "host")
      ++hosts;
    else if (name == "content-length") {
      ++lengths;
      head.contentLength = parseLength(value);
    } else if (name == "transfer-encoding")
      refuse(411, "length", "bodies are read with Content-Length only, not with Transfer-Encoding");
    else if (name == "content-encoding" && lowerCase(value) != "identity")
      refuse(415, errorWord(ErrorKind::Unsupported),
             "compressed bodies are not read; send the body as it is");
    else if (name == "connection") {
      if (listHolds(value, "close")) head.keepAlive = false;
      if (!head.http11 && listHolds(value, "keep-alive")) head.keepAlive = true;
    } else if (name == "expect") {
      if (lowerCase(value) != "100-continue") refuse(417, "expectation", "only 100-continue can be expected");
      head.expectContinue = head.http11;
    }
  }
  refuseRepeated(head.headers);
  if (hosts > 1 || (hosts == 0 && head.http11)) malformed("exactly one Host header is needed");
  if (lengths > 1) malformed("more than one Content-Length");
  if (head.method == "POST") {
    if (lengths == 0) refuse(411, "length", "a POST needs a Content-Length");
  } else if (head.contentLength > 0) {
    malformed("a " + head.method + " must not have a body");
  }
}

void parse(std::string_view text, RequestHead& head) {
  std::size_t lineEnd = text.find("\r\n");
  parseRequestLine(text.substr(0, lineEnd), head);
  for (;;) {
    text.remove_prefix(lineEnd + 2);
    lineEnd = text.find("\r\n");
    const std::string_view line = text.substr(0, lineEnd);
    if (line.empty()) break;
    if (head.headers.size() == kMaxHeaderFields)
      refuse(431, errorWord(ErrorKind::PayloadTooLarge),
             "more than " + std::to_string(kMaxHeaderFields) + " header fields");
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos || !isToken(line.substr(0, colon)))
      malformed("header field " + std::to_string(head.headers.size() + 1) + " is not name: value");
    const std::string_view value = trimmed(line.substr(colon + 1));
    if (!std::all_of(value.begin(), value.end(), fieldCharacter))
      malformed("header field " + std::to_string(head.headers.size() + 1) + " holds a control character");
    head.headers.emplace_back(lowerCase(line.substr(0, colon)), value);
  }
  interpretFields(head);
}

} // namespace

std::optional<std::size_t> findHeadEnd(std::string_view bytes) {
  const std::size_t at = bytes.find("\r\n\r\n");
  if (at == std::string_view::npos) return std::nullopt;
  return at + 4;
}

std::variant<RequestHead, Problem> parseRequestHead(std::string_view head) {
  RequestHead result;
  try {
    if (!head.ends_with("\r\n\r\n")) malformed("the head does not end with an empty line");
    parse(head, result);
  } catch (const ProblemError& error) {
    return error.problem();
  }
  return result;
}

} // namespace chamfer::http
