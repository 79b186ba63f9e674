// The head of an HTTP/1.x request, read strictly (RFC 9112) before any library sees it. Whatever two parsers
// could understand differently (smuggling), what the HTTP library gets wrong (chunked and compressed bodies,
// bodies of GET, repeated lengths), and what is too long is refused here.
#pragma once

#include "server/http/connection/message.h"
#include "server/http/routes/problem.h"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace chamfer::http {

struct RequestHead {
  std::string method; ///< GET, HEAD, POST or another token in upper case
  std::string target; ///< begins with '/', visible ASCII
  bool http11 = true;
  bool keepAlive = true;
  bool expectContinue = false; ///< the client waits for "100 Continue" before it sends the body
  Headers headers;             ///< names in lower case
  std::size_t contentLength = 0;
};

/// Where the head that begins `bytes` ends (one past its empty line); nothing while it is incomplete.
std::optional<std::size_t> findHeadEnd(std::string_view bytes);

/// `head` ends with the empty line. A Problem always closes the connection: what follows cannot be trusted.
std::variant<RequestHead, Problem> parseRequestHead(std::string_view head);

} // namespace chamfer::http
