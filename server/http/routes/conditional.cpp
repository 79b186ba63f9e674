// Conditional requests (RFC 9110, 13.1.2).
#include "common/digest.h"
#include "server/http/routes/routes.h"

namespace chamfer::http {

bool clientHas(const Request& request, std::string_view etag) {
  const std::string* field = request.header("if-none-match");
  if (!field) return false;
  std::string_view rest = *field;
  for (;;) {
    const std::size_t comma = rest.find(',');
    std::string_view tag = rest.substr(0, comma);
    while (tag.starts_with(' ') || tag.starts_with('\t'))
      tag.remove_prefix(1);
    while (tag.ends_with(' ') || tag.ends_with('\t'))
      tag.remove_suffix(1);
    if (tag.starts_with("W/")) tag.remove_prefix(2); // the comparison is weak
    if (tag == "*" || tag == etag) return true;
    if (comma == std::string_view::npos) return false;
    rest.remove_prefix(comma + 1);
  }
}

Response taggedAnswer(const Request& request, const std::string& etag, const char* contentType,
                      const char* cacheControl) {
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
