// Conditional requests (RFC 9110, 13.1 and 13.2.2). There are no dates, so that those conditions do not
// apply.
#include "common/digest.h"
#include "server/http/routes/problem.h"
#include "server/http/routes/routes.h"

#include <algorithm>

namespace chamfer::http {
namespace {

enum class Comparison { Strong, Weak };

/// Is `etag` (with its quotes; empty: there is none) in the list that all fields `name` make together?
bool lists(const Request& request, std::string_view name, std::string_view etag, Comparison comparison) {
  for (const auto& [field, value] : request.headers) {
    if (field != name) continue;
    std::string_view rest = value;
    for (;;) {
      const std::size_t comma = rest.find(',');
      std::string_view tag = rest.substr(0, comma);
      while (tag.starts_with(' ') || tag.starts_with('\t'))
        tag.remove_prefix(1);
      while (tag.ends_with(' ') || tag.ends_with('\t'))
        tag.remove_suffix(1);
      if (comparison == Comparison::Weak && tag.starts_with("W/")) tag.remove_prefix(2);
      if (tag == "*" || (!etag.empty() && tag == etag)) return true;
      if (comma == std::string_view::npos) break;
      rest.remove_prefix(comma + 1);
    }
  }
  return false;
}

void checkMatch(const Request& request, std::string_view etag) {
  const std::string* wanted = request.header("if-match");
  if (!wanted || lists(request, "if-match", etag, Comparison::Strong)) return;
  Problem problem;
  problem.status = 412;
  problem.kind = "precondition";
  problem.detail =
      etag.empty() ? "what is here has no ETag, If-Match names one; leave it out"
                   : "what is here now has the ETag " + std::string(etag) + ", which If-Match does not name";
  problem.parameter = "If-Match";
  problem.value = *wanted;
  throw ProblemError(problem);
}

} // namespace

bool clientHas(const Request& request, std::string_view etag) {
  return lists(request, "if-none-match", etag, Comparison::Weak);
}

void checkUntagged(const Request& request) { checkMatch(request, {}); }

Response taggedAnswer(const Request& request, const std::string& etag, const char* contentType,
                      const char* cacheControl) {
  checkMatch(request, etag);
  Response response;
  response.headers.emplace_back("ETag", etag);
  response.headers.emplace_back("Cache-Control", cacheControl);
  if (clientHas(request, etag))
    response.status = 304;
  else
    response.contentType = contentType;
  return response;
}

Response cacheable(const Request& request, std::string body, const char* contentType,
                   const char* cacheControl) {
  Response response = taggedAnswer(request, '"' + digestOf(body).hex() + '"', contentType, cacheControl);
  if (response.status != 304) response.body = std::move(body);
  return response;
}

} // namespace chamfer::http
