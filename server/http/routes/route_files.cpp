#include "server/http/routes/problem.h"
#include "server/http/routes/routes.h"

namespace chamfer::http {
namespace {

/// The page runs its own scripts only, and talks to its own server only.
constexpr const char* kContentSecurityPolicy = "default-src 'self'; img-src 'self' blob: data:; object-src "
                                               "'none'; base-uri 'none'; frame-ancestors 'self'";

} // namespace

Response fileRoute(const StaticFiles& files, const Request& request, const std::string& path) {
  std::optional<StaticFile> file = files.find(path);
  if (!file)
    throw ProblemError(notFound("there is nothing under this path; GET /v1/info and /v1/scenes are"));
  const bool page = file->contentType.starts_with("text/html");
  Response response = cacheable(request, std::move(file->bytes), file->contentType.c_str(), "no-cache");
  if (page) response.headers.emplace_back("Content-Security-Policy", kContentSecurityPolicy);
  return response;
}

} // namespace chamfer::http
