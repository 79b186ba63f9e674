#include "server/http/service.h"

#include "server/http/monitoring/log.h"
#include "server/render/request/query.h"

#include <algorithm>
#include <random>
#include <system_error>

namespace chamfer::http {
namespace {

/// What a resource can do. No header of CORS is in it, so that browsers keep pages of other sites out.
Response optionsOf(const RouteRow& row) {
  Response response;
  response.status = 204;
  response.headers.emplace_back("Allow", allowedMethods(row));
  response.headers.emplace_back("Cache-Control", "no-store");
  return response;
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

/// The last address of X-Forwarded-For: what stands before it is the client's own word.
std::string forwardedClient(const Request& request) {
  std::string_view addresses;
  for (const auto& [name, value] : request.headers)
    if (name == "x-forwarded-for") addresses = value;
  addresses.remove_prefix(addresses.rfind(',') + 1); // npos + 1 is 0
  while (addresses.starts_with(' '))
    addresses.remove_prefix(1);
  return addresses.empty() ? request.client : std::string(addresses);
}

Response plainText(std::string text) {
  Response response;
  response.contentType = "text/plain; charset=utf-8";
  response.headers.emplace_back("Cache-Control", "no-store");
  response.body = std::move(text);
  return response;
}

/// What a key was asked for is for its holder: no cache that others share may keep it, and the holder's own
/// one is to ask again with another key.
void keepFromOthers(Response& response) {
  for (auto& [name, value] : response.headers) {
    if (name != "Cache-Control" || value == "no-store") continue;
    constexpr std::string_view kPublic = "public, ";
    if (value.starts_with(kPublic)) value.erase(0, kPublic.size());
    value = "private, " + value;
  }
  response.headers.emplace_back("Vary", "Authorization, X-Api-Key");
}

Problem cancelledProblem(const Request& request) {
  if (*request.cancelled.clientGone) {
    Problem problem;
    problem.status = kStatusClientGone;
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
      queue_(options_.slots, options_.waiting), parts_{options_, catalogue_, files_,
                                                       cache_,   queue_,     metrics_},
      requests_((std::uint64_t{std::random_device{}()} << 32) | std::random_device{}()) {
  if (!options_.jobs.folder.empty()) comparisons_ = std::make_unique<Comparisons>(options_.jobs, parts_);
}

void Service::announceEnd() {
  ending_ = true;
  if (comparisons_) comparisons_->stop();
}

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
  if (options_.behindProxy) request.client = forwardedClient(request);

  const RouteRow* row = nullptr;
  const auto problemResponse = [&](const Problem& problem) {
    metrics_.refused(problem);
    return toResponse(problem, request.id);
  };
  Response response;
  try {
    response = refusal ? problemResponse(*refusal) : route(request, row);
  } catch (const ProblemError& error) {
    response = problemResponse(error.problem());
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::Internal)
      logMessage(LogLevel::Error, "request " + request.id + ": " + error.what());
    response =
        problemResponse(error.kind() == ErrorKind::Cancelled ? cancelledProblem(request)
                                                             : problemOf(error, catalogue_.root().string()));
  } catch (const std::bad_alloc&) {
    response = problemResponse(busy("the server is short of memory", 10, Scarcity::Memory));
  } catch (const std::system_error& error) {
    logMessage(LogLevel::Error, "request " + request.id + ": " + error.what());
    response = problemResponse(error.code() == std::errc::resource_unavailable_try_again // a thread's start
                                   ? busy("the server is short of threads", 10, Scarcity::Memory)
                                   : problemOf(Error(ErrorKind::Internal, ""), ""));
  } catch (const std::exception& error) { // a library's text stays in the log
    logMessage(LogLevel::Error, "request " + request.id + ": " + error.what());
    response = problemResponse(problemOf(Error(ErrorKind::Internal, ""), ""));
  }
  response.headers.emplace_back("X-Content-Type-Options", "nosniff");
  response.headers.emplace_back("X-Request-Id", request.id);
  if (ending_) response.close = true;

  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  const std::size_t bytes = request.method == "HEAD" ? 0 : response.body.size();
  metrics_.answered(row, response.status, took.count(), bytes);
  logRequest({request.id, request.client, request.method,
              request.query.empty() ? request.path : request.path + '?' + request.query, response.status,
              took.count() * 1000, bytes});
  return response;
}

std::optional<Problem> Service::screen(Request& request) const {
  if (options_.behindProxy) request.client = forwardedClient(request);
  try {
    const RouteRow* row = nullptr;
    admit(request, row);
    return std::nullopt;
  } catch (const ProblemError& error) {
    return error.problem();
  } catch (const Error& error) { // its path cannot be read
    return problemOf(error, catalogue_.root().string());
  }
}

Service::Target Service::admit(const Request& request, const RouteRow*& row) const {
  row = fixedRoute(request.path);
  // Health is asked for by whatever name the balancer has for this server.
  if (!row || !row->anyHost) {
    checkHost(request);
    checkSite(request);
  }
  if (!row || row->needsKey) checkKey(request);
  Target target{row, {}, {}};
  if (!row) {
    target.segments = splitPath(request.path);
    target.match = sceneRouteOf(target.segments,
                                [this](const std::string& name) { return catalogue_.find(name) != nullptr; });
    row = target.row = target.match.row;
    if (!row)
      throw ProblemError(notFound("there is nothing under this path; GET /v1/info and /v1/scenes are"));
  }
  const RouteRow* const asked = row;
  row = target.row = rowFor(*row, request.method);
  if (!row) throw ProblemError(methodNotAllowed(allowedMethods(*asked)));
  return target;
}

Response Service::route(const Request& request, const RouteRow*& row) {
  const Target target = admit(request, row);
  if (request.method == "OPTIONS") return optionsOf(*row);
  if (row->headers.find("ETag") == std::string_view::npos) checkUntagged(request);
  Response response = row->hasScene() ? answerScene(target.match, request) : answerRoute(*row, request);
  if (row->needsKey && !options_.keys.empty()) keepFromOthers(response);
  return response;
}

Response Service::answerRoute(const RouteRow& row, const Request& request) {
  if (row.needsKey) allowNoQuery(request);
  switch (row.id) {
  case RouteId::Live:
    return plainText("ok\n");
  case RouteId::Ready:
    return ready();
  case RouteId::Metrics:
    return metricsText();
  case RouteId::OpenApi:
    return openApiRoute(parts_, request);
  case RouteId::Info:
    return infoRoute(parts_, comparisons_.get(), request);
  case RouteId::Scenes:
    return scenesRoute(parts_, request);
  case RouteId::File:
    return fileRoute(files_, request, decodePath(splitPath(request.path)));
  default:
    if (draining_ && row.id == RouteId::Submit) throw ProblemError(busy("the server is shutting down", 5));
    return comparisonRoute(comparisons_.get(), row, request);
  }
}

Response Service::answerScene(const SceneMatch& match, const Request& request) {
  const auto entry = catalogue_.find(match.scene);
  if (!entry) {
    if (!catalogue_.loaded()) throw ProblemError(busy("the scenes are being loaded", 1));
    Problem problem = notFound("there is no scene of this name or id; GET /v1/scenes lists them");
    problem.parameter = "scene";
    problem.value = match.scene;
    throw ProblemError(problem);
  }
  if (match.row->id == RouteId::Scene) {
    allowNoQuery(request);
    return sceneRoute(request, *entry, catalogue_.root().string());
  }
  if (draining_) throw ProblemError(busy("the server is shutting down", 5));
  switch (match.row->id) {
  case RouteId::Tile:
    return tileRoute(parts_, request, *entry, match.scene, match.rest);
  case RouteId::Frame:
    return frameRoute(parts_, request, *entry, match.scene, match.rest);
  case RouteId::Preview:
    allowNoQuery(request);
    return previewRoute(parts_, request, *entry, match.scene);
  default:
    return raysRoute(parts_, request, *entry);
  }
}

Response Service::metricsText() const {
  MetricsNow now;
  now.queue = queue_.state();
  now.cache = cache_.state();
  now.sceneLimit = catalogue_.memoryLimit();
  for (const auto& entry : catalogue_.list()) {
    ++now.scenes[static_cast<std::size_t>(entry->state)];
    now.outdatedScenes += !entry->outdated.empty();
    now.sceneBytes += entry->bytes;
  }
  if (connections_) now.connections = connections_();
  if (comparisons_) {
    const Comparisons::State jobs = comparisons_->state();
    now.queuedComparisons = jobs.queued;
    now.runningComparisons = jobs.running;
  }
  now.draining = ending_;
  Response response = plainText(metrics_.text(now));
  response.contentType = kMetricsMediaType;
  return response;
}

Response Service::ready() const {
  if (ending_) throw ProblemError(busy("not ready: the server is shutting down", 5));
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

/// Browsers tell when a page of another site asks (Fetch Metadata, W3C). It could not read the answer, but it
/// could have this server render. Links from there are followed when a person does: into a tab of their own,
/// not into a frame of that page, nor ahead of time.
void Service::checkSite(const Request& request) const {
  const auto says = [&](const char* field, std::string_view word) {
    const std::string* value = request.header(field);
    return value && *value == word;
  };
  if (!says("sec-fetch-site", "cross-site")) return;
  const bool link = says("sec-fetch-mode", "navigate") && says("sec-fetch-dest", "document") &&
                    (request.method == "GET" || request.method == "HEAD") && !request.header("sec-purpose") &&
                    !request.header("purpose");
  if (link) return;
  Problem problem;
  problem.status = 403;
  problem.kind = "cross-site";
  problem.detail = "pages of other sites are not answered; serve yours and this from one origin";
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
