// Errors as clients see them: application/problem+json (RFC 9457) with the offending parameter, its value and
// its limits. This is the one border where errors become answers.
#pragma once

#include "common/error.h"
#include "server/http/connection/message.h"

#include <optional>
#include <stdexcept>
#include <string>

namespace chamfer::http {

/// In the log and the metrics, for a request whose client has gone: nobody is left to read an answer.
inline constexpr int kStatusClientGone = 499;

/// What the server had too little of for a request that it sent away (503, 429).
enum class Scarcity : std::uint8_t { None, RenderQueue, FairShare, Workers, Connections, Bodies, Memory };
inline constexpr std::size_t kScarcities = 7;

/// What an answer says about an error. Nothing in it may come from a library's message or name a path of the
/// server.
struct Problem {
  int status = 500;
  std::string kind = "internal";      ///< short stable word; `type` is "urn:chamfer:problem:" and this word
  std::string detail{};               ///< one sentence: what, the number, and the fix
  std::string parameter{};            ///< empty: none
  std::string value{};                ///< as the client sent it; only with a parameter
  std::string limits{};               ///< JSON text of an object; empty: none
  std::string allow{};                ///< 405: value of the Allow header
  int retryAfterSeconds = 0;          ///< above 0: Retry-After
  bool close = false;                 ///< the connection cannot be used further
  Scarcity scarcity = Scarcity::None; ///< for the metrics
};

/// Thrown by what knows of HTTP. What a picture is asked by is refused with Errors, which problemOf() turns
/// into the same.
class ProblemError : public std::runtime_error {
public:
  explicit ProblemError(Problem problem) : std::runtime_error(problem.detail), problem_(std::move(problem)) {}
  const Problem& problem() const { return problem_; }

private:
  Problem problem_;
};

Problem badRequest(std::string detail);
Problem notFound(std::string detail);
Problem methodNotAllowed(std::string allow);
Problem unsupportedMedia(std::string detail);
/// 503: try again after `retryAfterSeconds`.
Problem busy(std::string detail, int retryAfterSeconds, Scarcity scarcity = Scarcity::None);

/// The table's status and word for an Error; its message is ours, `root` (the served folder) is cut out of
/// it. A ParameterError's parameter, value and limits are the problem's.
Problem problemOf(const Error& error, const std::string& root);
/// `message` with every mention of the folder `root` removed, so that only names below it remain.
std::string withoutRoot(std::string message, const std::string& root);

/// The status in words.
const char* problemTitle(int status);
Response toResponse(const Problem& problem, const std::string& requestId);

} // namespace chamfer::http
