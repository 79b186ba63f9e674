// Jobs of comparisons.
#include "common/digest.h"
#include "server/http/comparisons/comparisons.h"
#include "server/http/routes/problem.h"
#include "server/http/routes/routes.h"

namespace chamfer::http {
namespace {

using Json = nlohmann::ordered_json;

/// The report brings its scripts, styles and pictures along, and nothing else may come in or go out.
/// Sandboxed it has an origin of its own: whatever got into it could not ask this server in its reader's
/// name.
constexpr const char* kReportPolicy =
    "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'; base-uri "
    "'none'; form-action 'none'; frame-ancestors 'self'; sandbox allow-scripts";

std::string textOf(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

/// /v1/comparisons/{job}/...
std::string jobOf(const Request& request) {
  constexpr std::size_t kPrefix = std::string_view("/v1/comparisons/").size();
  return request.path.substr(kPrefix, request.path.find('/', kPrefix) - kPrefix);
}

Response submit(Comparisons& comparisons, const Request& request) {
  requireJson(request);
  const Comparisons::Submitted submitted = comparisons.submit(request.body);
  Response response;
  response.status = submitted.finished ? 200 : 202;
  response.headers.emplace_back("Location", "/v1/comparisons/" + submitted.id);
  response.headers.emplace_back("Cache-Control", "no-store");
  response.contentType = "application/json";
  response.body = textOf(comparisons.status(submitted.id));
  return response;
}

Response end(Comparisons& comparisons, const Request& request) {
  comparisons.end(jobOf(request));
  Response response;
  response.status = 204;
  response.headers.emplace_back("Cache-Control", "no-store");
  return response;
}

Response events(Comparisons& comparisons, const Request& request) {
  const std::string* const last = request.header("last-event-id");
  const bool waits = request.method == "GET";
  const Comparisons::News news =
      comparisons.newsSince(waits && last ? *last : "", jobOf(request), request.cancelled);
  Response response;
  response.headers.emplace_back("Cache-Control", "no-store");
  if (news.status.empty() && news.final) { // EventSource takes it as the end
    response.status = 204;
    return response;
  }
  response.contentType = "text/event-stream";
  response.body = "retry: 500\n";
  response.body += news.status.empty()
                       ? ": no news\n\n"
                       : "id: " + news.version + "\nevent: state\ndata: " + news.status + "\n\n";
  return response;
}

/// The sandbox is for browsers; a file that is saved works as it is.
Response report(const Request& request, std::string html) {
  Response response = cacheable(request, std::move(html), "text/html; charset=utf-8", "no-cache");
  response.headers.emplace_back("Content-Security-Policy", kReportPolicy);
  return response;
}

} // namespace

Response comparisonRoute(Comparisons* comparisons, const RouteRow& row, const Request& request) {
  if (!comparisons)
    throw ProblemError(notFound("this server takes no comparisons; start it with --jobs DIR"));
  const auto json = [&](std::string text) {
    return cacheable(request, std::move(text), "application/json", "no-cache");
  };
  switch (row.id) {
  case RouteId::Comparisons:
    return json(textOf(comparisons->list()));
  case RouteId::Submit:
    return submit(*comparisons, request);
  case RouteId::Comparison:
    return json(textOf(comparisons->status(jobOf(request))));
  case RouteId::EndComparison:
    return end(*comparisons, request);
  case RouteId::ComparisonEvents:
    return events(*comparisons, request);
  case RouteId::ComparisonSuite:
    return json(comparisons->suite(jobOf(request)));
  case RouteId::ComparisonResult:
    return json(comparisons->file(jobOf(request), "result.json"));
  case RouteId::ComparisonReport:
    return report(request, comparisons->file(jobOf(request), "report.html"));
  default:
    return cacheable(request, comparisons->file(jobOf(request), "junit.xml"), "application/xml", "no-cache");
  }
}

} // namespace chamfer::http
