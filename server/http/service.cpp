#include "server/http/service.h"

#include "server/http/log.h"
#include "server/http/url.h"

#include <algorithm>
#include <random>

namespace chamfer::http {
namespace {

constexpr const char* kRead = "GET, HEAD";
constexpr int kClientGone = 499; ///< in the log; nobody is left to read it

void allow(const Request& request, const char* methods) {
  const bool read = request.method == "GET" || request.method == "HEAD";
  if (methods == kRead ? !read : request.method != methods) throw ProblemError(methodNotAllowed(methods));
}

void allowNoQuery(const Request& request) {
  if (request.query.empty()) return;
  Problem problem = badRequest("this resource takes no query");
  problem.parameter = "query";
  problem.value = request.query;
  throw ProblemError(problem);
}

/// Takes the same time wherever the first difference is.
bool sameSecret(std::string_view a, std::string_view b) {
  unsigned difference = a.size() != b.size();
  for (std::size_t i = 0; i < a.size(); ++i)
    difference |=
        static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b.empty() ? 0 : b[i % b.size()]);
  return difference == 0;
}

bool usableAsId(const std::string& id) {
  return !id.empty() && id.size() <= 64 && std::all_of(id.begin(), id.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_' || c == '.';
  });
}

std::string decodedName(std::span<const std::string_view> segments) {
  std::string name;
  for (const std::string_view segment : segments) {
    const auto part = percentDecode(segment);
    if (!part)
      throw ProblemError(badRequest("the path has a broken percent escape, or one of a control character"));
    if (!name.empty()) name += '/';
    name += *part;
  }
  return name;
}

Response plainText(std::string text) {
  Response response;
  response.contentType = "text/plain; charset=utf-8";
  response.headers.emplace_back("Cache-Control", "no-store");
  response.body = std::move(text);
  return response;
}

Problem cancelledProblem(const Request& request) {
  if (*request.cancelled.clientGone) {
    Problem problem;
    problem.status = kClientGone;
    problem.kind = "client-gone";
    problem.close = true;
    return problem;
  }
  if (*request.cancelled.shuttingDown) return busy("the server is shutting down", 5);
  Problem problem;
  problem.status = 504;
  problem.kind = "deadline";
  problem.detail = "the server gave up at its own deadline; ask for a smaller tile or fewer samples";
  return problem;
}

} // namespace

Service::Service(ServiceOptions options, const Catalogue& catalogue, StaticFiles files)
    : options_(std::move(options)), catalogue_(catalogue), files_(std::move(files)),
      cache_(options_.cacheBytes, options_.threads),
      queue_(options_.slots, options_.waiting), parts_{options_, catalogue_, files_, cache_, queue_},
      requests_((std::uint64_t{std::random_device{}()} << 32) | std::random_device{}()) {}

std::string Service::newRequestId() {
  static constexpr char kHex[] = "0123456789abcdef";
  std::uint64_t number = requests_.fetch_add(1);
  std::string id(16, '0');
  for (std::size_t i = 16; i-- > 0; number >>= 4)
    id[i] = kHex[number & 15];
  return id;
}

Response Service::answer(Request& request, const Problem* refusal) {
  const auto begin = std::chrono::steady_clock::now();
  request.cancelled.shuttingDown = shuttingDown_;
  request.cancelled.deadline = begin + options_.deadline;
  const std::string* given = request.header("x-request-id");
  request.id = given && usableAsId(*given) ? *given : newRequestId();

  Response response;
  try {
    response = refusal ? toResponse(*refusal, request.id) : route(request);
  } catch (const ProblemError& error) {
    response = toResponse(error.problem(), request.id);
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::Internal)
      logMessage(LogLevel::Error, "request " + request.id + ": " + error.what());
    response = toResponse(error.kind() == ErrorKind::Cancelled ? cancelledProblem(request)
                                                               : problemOf(error, catalogue_.root().string()),
                          request.id);
  } catch (const std::bad_alloc&) {
    response = toResponse(busy("the server is short of memory", 10), request.id);
  } catch (const std::exception& error) { // a library's text stays in the log
    logMessage(LogLevel::Error, "request " + request.id + ": " + error.what());
    response = toResponse(problemOf(Error(ErrorKind::Internal, ""), ""), request.id);
  }
  response.headers.emplace_back("X-Content-Type-Options", "nosniff");
  response.headers.emplace_back("X-Request-Id", request.id);
  if (draining_) response.close = true;

  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
  logRequest({request.id, request.client, request.method,
              request.query.empty() ? request.path : request.path + '?' + request.query, response.status,
              took.count(), request.method == "HEAD" ? 0 : response.body.size()});
  return response;
}

Response Service::route(const Request& request) {
  const auto segments = splitPath(request.path);
  if (segments.size() == 1 && (segments[0] == "livez" || segments[0] == "readyz")) {
    // Health is asked for by whatever name the balancer has for this server.
    allow(request, kRead);
    return segments[0] == "livez" ? plainText("ok\n") : ready();
  }
  checkHost(request);
  if (segments[0] == "v1") {
    checkKey(request);
    if (segments.size() == 2 && segments[1] == "info") {
      allow(request, kRead);
      allowNoQuery(request);
      return infoRoute(parts_, request);
    }
    if (segments.size() == 2 && segments[1] == "scenes") {
      allow(request, kRead);
      allowNoQuery(request);
      return scenesRoute(parts_, request);
    }
    if (segments.size() > 2 && segments[1] == "scenes")
      return sceneResource(request, std::span(segments).subspan(2));
    throw ProblemError(notFound("there is nothing under this path; GET /v1/info and /v1/scenes are"));
  }
  const std::string path = decodedName(segments);
  allow(request, kRead);
  return fileRoute(files_, request, path);
}

Response Service::sceneResource(const Request& request, std::span<const std::string_view> segments) {
  // A scene's name may hold slashes, sent plain or as %2F. What looks like a resource below a scene is one,
  // unless a scene has all of it as its name.
  std::size_t nameEnd = segments.size();
  std::string_view word;
  if (!catalogue_.find(decodedName(segments))) {
    for (std::size_t i = segments.size(); i-- > 1;)
      if (segments[i] == "tiles" || segments[i] == "frames" ||
          (segments[i] == "rays" && i + 1 == segments.size())) {
        nameEnd = i;
        word = segments[i];
        break;
      }
  }
  const std::string name = decodedName(segments.first(nameEnd));
  const auto rest = segments.subspan(std::min(nameEnd + 1, segments.size()));
  allow(request, word == "rays" ? "POST" : kRead);

  const auto entry = catalogue_.find(name);
  if (!entry) {
    if (!catalogue_.loaded()) throw ProblemError(busy("the scenes are being loaded", 1));
    Problem problem = notFound("there is no scene of this name or id; GET /v1/scenes lists them");
    problem.parameter = "scene";
    problem.value = name;
    throw ProblemError(problem);
  }
  if (word.empty()) {
    allowNoQuery(request);
    return sceneRoute(request, *entry, catalogue_.root().string());
  }
  if (draining_) throw ProblemError(busy("the server is shutting down", 5));
  if (word == "tiles") return tileRoute(parts_, request, *entry, name, rest);
  if (word == "frames") return frameRoute(parts_, request, *entry, name, rest);
  return raysRoute(parts_, request, *entry);
}

Response Service::ready() const {
  if (draining_) throw ProblemError(busy("not ready: the server is shutting down", 5));
  if (!catalogue_.loaded()) throw ProblemError(busy("not ready: the scenes are being loaded", 1));
  return plainText("ready\n");
}

void Service::checkHost(const Request& request) const {
  const std::string* host = request.header("host");
  if (options_.hosts.empty() || !host) return; // HTTP/1.0 has none; 1.1 without one does not get here
  std::string name = *host;
  if (const std::size_t colon = name.rfind(':');
      colon != std::string::npos && name.find(']', colon) == std::string::npos)
    name.resize(colon);
  std::transform(name.begin(), name.end(), name.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if (std::find(options_.hosts.begin(), options_.hosts.end(), name) != options_.hosts.end()) return;
  // A page of another site could have its own name resolve to this machine (DNS rebinding).
  Problem problem;
  problem.status = 421;
  problem.kind = "host";
  problem.detail = "this server does not answer for that host; start it with --allow-host to add a name";
  problem.parameter = "Host";
  problem.value = *host;
  throw ProblemError(problem);
}

void Service::checkKey(const Request& request) const {
  if (options_.keys.empty()) return;
  std::string_view given;
  if (const std::string* field = request.header("authorization")) {
    given = *field;
    if (given.starts_with("Bearer ")) given.remove_prefix(7);
  } else if (const std::string* key = request.header("x-api-key")) {
    given = *key;
  }
  Problem problem;
  if (given.empty()) {
    problem.status = 401;
    problem.kind = "key";
    problem.detail = "this server asks for a key: Authorization: Bearer KEY";
    throw ProblemError(problem);
  }
  bool known = false;
  for (const std::string& key : options_.keys)
    known |= sameSecret(key, given);
  if (known) return;
  problem.status = 403;
  problem.kind = "key";
  problem.detail = "this key is not one of the server's";
  throw ProblemError(problem);
}

} // namespace chamfer::http
