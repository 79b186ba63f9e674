#include "server/http/comparisons/job_runner.h"

#include "common/error.h"
#include "server/http/comparisons/submission.h"
#include "server/http/monitoring/log.h"
#include "server/http/routes/problem.h"
#include "server/http/version.h"
#include "server/jobs/cli/compare_command.h"
#include "server/jobs/compare/compare_suite.h"
#include "server/jobs/report/reports.h"
#include "server/render/image/image_io.h"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace chamfer::http {
namespace {

/// Between looks for jobs that another process has left or taken in, and for a word that a job is cancelled.
constexpr std::chrono::milliseconds kRescan{1'000}, kLook{300};
constexpr std::chrono::seconds kTidy{60};
constexpr int kMostTries = 5;
constexpr const char* kTries = "tries.json";
/// Of the thread and those that it starts: a tenth of the cores beside requests, all of them where there are
/// none.
constexpr int kNice = 10;

void becomeBackground() {
  // Libraries start threads of their own, for all, when they are first asked; those are not to be slow.
  (void)encodeExr(Image{1, 1, {0, 0, 0, 1}});
  ::setpriority(PRIO_PROCESS, static_cast<id_t>(::syscall(SYS_gettid)), kNice);
}

std::string nodeName() {
  char name[256] = "";
  ::gethostname(name, sizeof name - 1);
  return std::string(name) + ':' + std::to_string(::getpid());
}

nlohmann::ordered_json caseJson(const CaseResult& c) {
  return {{"name", c.name}, {"outcome", outcomeWord(c.outcome)}, {"reason", c.reason}};
}

std::string textOf(const nlohmann::ordered_json& json) {
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

} // namespace

JobRunner::JobRunner(const JobStore& store, const Parts& parts)
    : store_(store), parts_(parts), thread_([this] { run(); }) {}

JobRunner::~JobRunner() {
  stop();
  thread_.join();
}

void JobRunner::wake() {
  {
    const std::lock_guard lock(mutex_);
    woken_ = true;
  }
  wake_.notify_all();
}

void JobRunner::stop() {
  stopping_ = true;
  wake();
}

void JobRunner::look(const std::string& id) {
  const std::lock_guard lock(mutex_);
  if (current_ == id) cancelled_ = store_.ended(id) || !store_.has(id);
}

nlohmann::ordered_json JobRunner::progressOf(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  return current_ == id ? progress_ : Json();
}

void JobRunner::run() {
  auto tidied = Clock::time_point::min();
  bool ready = false;
  while (!stopping_) {
    try {
      if (!ready && parts_.catalogue.loaded()) {
        becomeBackground();
        ready = true;
      }
      if (ready) workOnOne();
      if (const auto now = Clock::now(); tidied == Clock::time_point::min() || now - tidied > kTidy) {
        store_.tidy();
        tidied = now;
      }
    } catch (const std::exception& error) { // the folder is full, or gone for a while
      logMessage(LogLevel::Error, std::string("comparisons: ") + error.what());
    }
    std::unique_lock lock(mutex_);
    wake_.wait_for(lock, ready ? kRescan : std::chrono::milliseconds(50), [this] { return woken_; });
    woken_ = false;
  }
}

/// The first that nobody works on.
void JobRunner::workOnOne() {
  for (const std::string& id : store_.unfinished()) {
    if (stopping_) return;
    const auto lock = JobLock::tryTake(store_.path(id, "lock"));
    if (!lock || store_.ended(id) || !store_.has(id)) continue;
    work(id);
    wake(); // for the next one
    return;
  }
}

void JobRunner::work(const std::string& id) {
  {
    const std::lock_guard lock(mutex_);
    cancelled_ = false;
    progress_ = {{"node", nodeName()}, {"progress", nullptr}, {"cases", Json::array()}};
    current_ = id;
  }
  nextLook_ = 0;
  logMessage(LogLevel::Info, "comparison " + id + " begins");
  std::string ended = "stopped";
  try {
    countTry(id);
    compare(id);
    ended = "done";
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::Cancelled) fail(id, ended = error.what());
  } catch (const std::exception& error) {
    fail(id, ended = std::string("internal error: ") + error.what());
  }
  std::error_code ignored;
  std::filesystem::remove(store_.path(id, kTries), ignored); // the process has lived on
  if (store_.ended(id)) store_.dropSeeds(id);
  {
    const std::lock_guard lock(mutex_);
    current_.clear();
  }
  logMessage(LogLevel::Info, "comparison " + id + ": " + ended);
}

/// A job that ends its server again and again without one more seed is to be given up.
void JobRunner::countTry(const std::string& id) const {
  std::error_code none;
  const auto seeds = std::distance(std::filesystem::directory_iterator(store_.path(id, "seeds"), none),
                                   std::filesystem::directory_iterator());
  const Json before = store_.readJson(id, kTries);
  const bool stuck = before.is_object() && before.value("seeds", Json()) == seeds;
  const int tries = stuck ? before.value("tries", 0) + 1 : 1;
  if (tries > kMostTries)
    throw Error(ErrorKind::Internal, "the server ended " + std::to_string(kMostTries) +
                                         " times while it worked on this, without one more seed; see its "
                                         "log, and its memory");
  store_.write(id, kTries, textOf({{"seeds", seeds}, {"tries", tries}}));
}

void JobRunner::compare(const std::string& id) {
  const JobRequest request = readJobRequest(store_.read(id, "request.json").value_or(""));
  if (request.version != kVersion)
    throw Error(ErrorKind::Usage, "it was submitted to version " + request.version + ", and this is " +
                                      kVersion + "; submit it again");
  const SeedStore seeds(store_.path(id, "seeds"));
  ServedHost host(parts_, request.origins, [this] { return lostPurpose(); });
  SuiteControl control;
  control.each.version = kVersion;
  control.each.threads = parts_.options.threads;
  control.each.store = &seeds;
  control.each.cancelled = [this] { return lostPurpose(); };
  control.command = "POST /v1/comparisons";
  control.commandOf = [](const CaseChoice& c) {
    return shellText({"chamferd", "compare", "--suite", "suite.json", "--case", c.name});
  };
  control.progress = [&](std::size_t i, unsigned done, unsigned most) {
    const std::lock_guard lock(mutex_);
    progress_["progress"] = {{"case", i},
                             {"cases", request.cases.size()},
                             {"name", request.cases[i].name},
                             {"seeds", done},
                             {"most_seeds", most}};
  };
  control.finished = [&](std::size_t, const CaseResult& c) {
    CaseResult told;
    told.name = c.name;
    told.outcome = c.outcome;
    told.reason = clean(c.reason);
    const std::lock_guard lock(mutex_);
    progress_["cases"].push_back(caseJson(told));
  };
  SuiteResult result = compareSuite(request.cases, host, control);
  if (lostPurpose()) throw Error(ErrorKind::Cancelled, "the comparison was cancelled");
  finish(id, std::move(result));
}

/// Paths of this machine are nobody's business.
std::string JobRunner::clean(std::string message) const {
  return withoutRoot(withoutRoot(std::move(message), parts_.catalogue.root().string()),
                     store_.options().folder.string());
}

void JobRunner::finish(const std::string& id, SuiteResult result) {
  Json cases = Json::array();
  for (CaseResult& c : result.cases) {
    c.reason = clean(c.reason);
    for (std::string& warning : c.warnings)
      warning = clean(warning);
    cases.push_back(caseJson(c));
  }
  store_.write(id, "report.html", comparisonHtml(result));
  store_.write(id, "junit.xml", comparisonJUnit(result));
  store_.write(id, "result.json", comparisonJson(result));
  const std::lock_guard lock(mutex_); // against look()
  if (store_.ended(id)) return;       // cancelled in the last moment
  store_.write(id, "state.json",
               textOf({{"state", "done"},
                       {"finished", utcNowText()},
                       {"outcome", outcomeWord(result.outcome())},
                       {"detail", nullptr},
                       {"cases", cases}}));
}

void JobRunner::fail(const std::string& id, const std::string& why) {
  logMessage(LogLevel::Error, "comparison " + id + " failed: " + why);
  if (!store_.has(id) || store_.ended(id)) return;
  store_.write(id, "state.json",
               textOf({{"state", "failed"},
                       {"finished", utcNowText()},
                       {"outcome", nullptr},
                       {"detail", clean(why)},
                       {"cases", Json::array()}}));
}

bool JobRunner::lostPurpose() {
  if (stopping_ || cancelled_) return true;
  const Clock::rep now = Clock::now().time_since_epoch().count();
  Clock::rep due = nextLook_;
  if (now < due || !nextLook_.compare_exchange_strong(due, now + Clock::duration(kLook).count()))
    return false;
  std::string id, progress;
  {
    const std::lock_guard lock(mutex_);
    id = current_;
    progress = textOf(progress_);
  }
  // Another process may have been told to cancel it.
  if (store_.ended(id) || !store_.has(id)) return cancelled_ = true;
  try {
    store_.write(id, "progress.json", progress);
  } catch (const Error&) { // whoever asks another process sees it later
  }
  return false;
}

} // namespace chamfer::http
