#include "server/http/serve_command.h"

#include "common/text.h"

#include "server/http/connection/http_server.h"
#include "server/http/monitoring/log.h"
#include "server/http/service.h"

#include <csignal>
#include <cstdio>
#include <fstream>
#include <malloc.h>
#include <sys/resource.h>
#include <thread>

namespace chamfer::http {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kTick{20};
/// So long the line that says where it listens waits for the scenes; scripts may then use them at once.
constexpr milliseconds kPatience{5'000};
constexpr std::size_t kShortestKey = 16;
/// Threads for requests that neither render nor wait for it, so that health answers under any load.
constexpr unsigned kQuickWorkers = 8;

milliseconds fromSeconds(double seconds) { return milliseconds(static_cast<std::int64_t>(seconds * 1000)); }

bool isLoopback(const std::string& host) {
  return host == "localhost" || host == "::1" || host.starts_with("127.");
}

std::vector<std::string> readKeys(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw Error(ErrorKind::NotFound, "cannot read the key file " + file.string());
  std::vector<std::string> keys;
  for (std::string line; std::getline(stream, line);) {
    while (!line.empty() && (line.back() == '\r' || line.back() == ' '))
      line.pop_back();
    if (line.empty() || line[0] == '#') continue;
    if (line.size() < kShortestKey)
      throw Error(ErrorKind::Usage, "a key in " + file.string() + " has " + std::to_string(line.size()) +
                                        " characters; use at least " + std::to_string(kShortestKey));
    keys.push_back(line);
  }
  if (keys.empty()) throw Error(ErrorKind::Usage, file.string() + " holds no key; write one a line");
  return keys;
}

ServiceOptions serviceOptions(const ServeCommandOptions& options) {
  ServiceOptions service;
  service.threads = options.threads;
  service.slots = options.slots;
  service.waiting = options.waiting;
  service.connections = options.connections;
  service.behindProxy = options.behindProxy;
  service.cacheBytes = options.cacheMegabytes << 20;
  service.jobs = {options.jobs, std::uint64_t{options.jobsMegabytes} << 20,
                  std::chrono::seconds(static_cast<std::int64_t>(options.jobsDays * 86400)),
                  options.jobsWaiting};
  service.deadline = fromSeconds(options.deadlineSeconds);
  if (!options.keyFile.empty()) service.keys = readKeys(options.keyFile);
  const bool loopback = isLoopback(options.host);
  if (!loopback && service.keys.empty() && !options.noAuth)
    throw Error(ErrorKind::Usage,
                "listening on " + options.host +
                    ", beyond this machine, needs --key-file, or --no-auth to let everybody in");
  // Beyond this machine every name is answered unless some are given: its names are not known here.
  if (loopback || !options.allowHosts.empty()) {
    service.hosts = {"localhost", "127.0.0.1", "[::1]"};
    service.hosts.push_back(options.host);
    service.hosts.insert(service.hosts.end(), options.allowHosts.begin(), options.allowHosts.end());
    for (std::string& name : service.hosts) // names are compared in lower case
      name = lowerCase(name);
  }
  return service;
}

/// A server has many descriptors open; the soft limit is often made for other programs.
void raiseDescriptorLimit() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  ::setrlimit(RLIMIT_NOFILE, &limit);
}

/// SIGTERM and SIGINT, taken by whoever waits instead of interrupting a thread.
class StopSignals {
public:
  /// To be made before other threads, which inherit the blocked signals.
  StopSignals() {
    sigemptyset(&set_);
    sigaddset(&set_, SIGTERM);
    sigaddset(&set_, SIGINT);
    pthread_sigmask(SIG_BLOCK, &set_, &before_);
  }
  ~StopSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  /// Has one come within `wait`?
  bool within(milliseconds wait) const {
    const timespec time{wait.count() / 1000, (wait.count() % 1000) * 1'000'000};
    return sigtimedwait(&set_, nullptr, &time) > 0;
  }
  void await() const {
    int signal = 0;
    while (sigwait(&set_, &signal) != 0) {
    }
  }

private:
  sigset_t set_{}, before_{};
};

void printAddress(const std::string& host, int port) {
  const bool v6 = host.find(':') != std::string::npos;
  std::printf("listening on http://%s%s%s:%d/\n", v6 ? "[" : "", host.c_str(), v6 ? "]" : "", port);
  std::fflush(stdout);
}

} // namespace

int runServeCommand(const ServeCommandOptions& options) {
  startLog(options.logLevel);
  // Threads come by the dozen, and the C library would give most of them an arena, each of which keeps the
  // most that it ever held: a third of the server's memory. As many as requests are rendered at one time do.
  ::mallopt(M_ARENA_MAX, static_cast<int>(options.slots));
  const StopSignals signals;
  raiseDescriptorLimit();

  Catalogue catalogue(options.root, fromSeconds(options.rescanSeconds), options.sceneMegabytes << 20,
                      options.upAxis);
  Service service(serviceOptions(options), catalogue,
                  options.web.empty() ? StaticFiles() : StaticFiles(options.web));
  ConnectionLimits limits;
  limits.connections = options.connections;
  limits.workers = service.blockingRequests() + kQuickWorkers;
  HttpServer server(
      limits, [&](Request& request, const Problem* refusal) { return service.answer(request, refusal); },
      [&](Request& request) { return service.screen(request); });
  service.observeConnections([&server] { return server.counts(); });

  const int port = server.start(options.host, options.port);
  catalogue.start();
  const auto patience = Clock::now() + kPatience;
  bool stop = false;
  while (!stop && !catalogue.loaded() && Clock::now() < patience)
    stop = signals.within(kTick);
  if (!stop) {
    printAddress(options.host, port);
    signals.await();
  }

  // Health checks go on being answered, with "not ready", while the requests under way come to their end.
  logMessage(LogLevel::Info, "stopping: what is under way is finished, nothing new is taken");
  service.announceEnd();
  const bool impatient = signals.within(fromSeconds(options.drainDelaySeconds));
  service.drain();
  const auto end = Clock::now() + fromSeconds(options.drainSeconds);
  while (!impatient && server.counts().busy > 0 && Clock::now() < end && !signals.within(kTick)) {
  }
  service.cancelAll();
  server.stop(milliseconds(2'000));
  logMessage(LogLevel::Info, "stopped");
  return 0;
}

} // namespace chamfer::http
