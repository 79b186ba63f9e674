#include "server/http/routes/problem.h"

#include "server/render/request/parameter_error.h"

#include <nlohmann/json.hpp>

namespace chamfer::http {
namespace {

constexpr std::size_t kLongestValue = 200; ///< of a client's value that an answer repeats

} // namespace

const char* problemTitle(int status) {
  switch (status) {
  case 400:
    return "Bad request";
  case 401:
    return "Key needed";
  case 403:
    return "Refused";
  case 404:
    return "Not found";
  case 405:
    return "Method not allowed";
  case 409:
    return "Scene cannot be used as it is on disk";
  case 411:
    return "Length required";
  case 412:
    return "Precondition failed";
  case 413:
    return "Content too large";
  case 414:
    return "Target too long";
  case 415:
    return "Unsupported media type";
  case 417:
    return "Expectation failed";
  case 421:
    return "Host not served here";
  case 422:
    return "Value out of range";
  case 431:
    return "Header too large";
  case 429:
    return "Too many requests";
  case 503:
    return "Busy";
  case 504:
    return "Deadline passed";
  case 505:
    return "HTTP version not supported";
  default:
    return "Internal error";
  }
}

Problem badRequest(std::string detail) {
  return {.status = 400, .kind = errorWord(ErrorKind::Usage), .detail = std::move(detail)};
}

Problem notFound(std::string detail) {
  return {.status = 404, .kind = errorWord(ErrorKind::NotFound), .detail = std::move(detail)};
}

Problem methodNotAllowed(std::string allow) {
  std::string detail = "this resource answers " + allow;
  return {.status = 405, .kind = "method", .detail = std::move(detail), .allow = std::move(allow)};
}

Problem unsupportedMedia(std::string detail) {
  return {.status = 415, .kind = errorWord(ErrorKind::Unsupported), .detail = std::move(detail)};
}

Problem busy(std::string detail, int retryAfterSeconds, Scarcity scarcity) {
  return {.status = 503,
          .kind = errorWord(ErrorKind::Busy),
          .detail = std::move(detail),
          .retryAfterSeconds = retryAfterSeconds,
          .scarcity = scarcity};
}

std::string withoutRoot(std::string message, const std::string& root) {
  if (root.empty() || root == "/") return message;
  for (std::size_t at = message.find(root); at != std::string::npos; at = message.find(root, at)) {
    const std::size_t end = at + root.size();
    const bool slash = end < message.size() && message[end] == '/';
    message.replace(at, root.size() + (slash ? 1 : 0), slash ? "" : ".");
  }
  return message;
}

Problem problemOf(const Error& error, const std::string& root) {
  Problem problem{.status = httpStatus(error.kind()), .kind = errorWord(error.kind())};
  if (const auto* asked = dynamic_cast<const ParameterError*>(&error)) {
    problem.detail = error.what(); // of the request, which knows no path of the server
    problem.parameter = asked->parameter();
    problem.value = asked->value();
    problem.limits = asked->limits();
    return problem;
  }
  if (error.kind() == ErrorKind::Internal)
    problem.detail = "a defect of the server; its log has more under this request's id";
  else
    problem.detail = withoutRoot(error.what(), root);
  if (problem.status == 503) problem.retryAfterSeconds = 1;
  return problem;
}

Response toResponse(const Problem& problem, const std::string& requestId) {
  nlohmann::ordered_json body{{"type", "urn:chamfer:problem:" + problem.kind},
                              {"title", problemTitle(problem.status)},
                              {"status", problem.status},
                              {"detail", problem.detail}};
  if (!problem.parameter.empty()) {
    body["parameter"] = problem.parameter;
    body["value"] = problem.value.substr(0, kLongestValue);
  }
  if (!problem.limits.empty()) body["limits"] = nlohmann::ordered_json::parse(problem.limits);
  if (!requestId.empty()) body["request_id"] = requestId;

  Response response;
  response.status = problem.status;
  response.contentType = "application/problem+json";
  // A client's bytes need not be UTF-8: replace what is not.
  response.body = body.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  response.headers.emplace_back("Cache-Control", "no-store");
  if (!problem.allow.empty()) response.headers.emplace_back("Allow", problem.allow);
  if (problem.retryAfterSeconds > 0)
    response.headers.emplace_back("Retry-After", std::to_string(problem.retryAfterSeconds));
  if (problem.status == 401) response.headers.emplace_back("WWW-Authenticate", "Bearer realm=\"chamferd\"");
  response.close = problem.close;
  return response;
}

} // namespace chamfer::http
