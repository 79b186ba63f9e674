#include "server/http/comparisons/comparisons.h"

#include "common/digest.h"
#include "server/http/comparisons/submission.h"
#include "server/http/routes/problem.h"

namespace chamfer::http {
namespace {

using Json = nlohmann::ordered_json;
using std::chrono::milliseconds;

constexpr std::chrono::seconds kLongestWatch{20};
constexpr milliseconds kWatchPause{100};
constexpr int kRetryAfterSeconds = 30;

Json casesOf(const Json& request) {
  Json cases = Json::array();
  if (request.contains("suite"))
    for (const Json& one : request["suite"].value("cases", Json::array()))
      cases.push_back({{"name", one.value("name", "")}, {"outcome", nullptr}, {"reason", nullptr}});
  return cases;
}

Json linksOf(const std::string& id, bool done) {
  const std::string self = "/v1/comparisons/" + id;
  const auto made = [&](const char* name) { return done ? Json(self + name) : Json(); };
  return {{"self", self},
          {"events", self + "/events"},
          {"suite", self + "/suite.json"},
          {"result", made("/result.json")},
          {"report", made("/report.html")},
          {"junit", made("/junit.xml")}};
}

} // namespace

Comparisons::Comparisons(const JobOptions& options, const Parts& parts)
    : store_(options, parts.catalogue.root()), parts_(parts), runner_(store_, parts) {}

void Comparisons::require(const std::string& id) const {
  if (store_.has(id)) return;
  Problem problem = notFound("there is no comparison of this id; GET /v1/comparisons lists them");
  problem.parameter = "job";
  problem.value = id;
  throw ProblemError(problem);
}

Comparisons::Submitted Comparisons::submit(const std::string& body) {
  const Submission submission = readSubmission(body, parts_, store_.options());
  const std::string& id = submission.id;
  const std::lock_guard lock(submitting_);
  const bool known = store_.has(id), ended = known && store_.ended(id);
  if (ended && store_.readJson(id, "state.json").value("state", "") == "done") return {id, true};
  if (known && !ended) return {id, false};
  const std::size_t waiting = store_.unfinished().size();
  if (waiting >= store_.options().waiting)
    throw ProblemError(busy(std::to_string(waiting) + " comparisons wait or run, which is all that may",
                            kRetryAfterSeconds));
  if (known)
    store_.restart(id, submission.request);
  else
    store_.add(id, submission.request);
  runner_.wake();
  return {id, false};
}

/// Without its cases' names where none of them has ended.
Json Comparisons::facts(const std::string& id) const {
  Json job{{"id", id},
           {"state", "queued"},
           {"created", store_.submitted(id)},
           {"finished", nullptr},
           {"outcome", nullptr},
           {"detail", nullptr},
           {"node", nullptr},
           {"progress", nullptr},
           {"cases", Json::array()}};
  const auto take = [&job](const Json& from, std::initializer_list<const char*> keys) {
    for (const char* key : keys)
      if (from.contains(key)) job[key] = from[key];
  };
  if (store_.ended(id)) {
    Json ended = store_.readJson(id, "state.json");
    if (!ended.is_object()) ended = {{"state", "failed"}, {"detail", "its state.json is damaged"}};
    take(ended, {"state", "finished", "outcome", "detail", "cases"});
  } else if (Json here = runner_.progressOf(id); here.is_object() || store_.running(id)) {
    job["state"] = "running";
    if (!here.is_object()) here = store_.readJson(id, "progress.json");
    if (here.is_object()) take(here, {"node", "progress", "cases"});
  }
  job["links"] = linksOf(id, job["state"] == "done");
  return job;
}

Json Comparisons::status(const std::string& id) const {
  require(id);
  Json job = facts(id);
  if (job["state"] != "done") { // those that have ended, and the names of the others
    Json cases = casesOf(store_.readJson(id, "request.json"));
    for (std::size_t i = 0; i < std::min(cases.size(), job["cases"].size()); ++i)
      cases[i] = job["cases"][i];
    job["cases"] = std::move(cases);
  }
  return job;
}

Json Comparisons::list() const {
  const std::vector<std::string> ids = store_.ids();
  Json all = Json::array();
  for (auto id = ids.rbegin(); id != ids.rend(); ++id) {
    Json job = facts(*id);
    job.erase("cases");
    all.push_back(std::move(job));
  }
  return all;
}

void Comparisons::end(const std::string& id) {
  require(id);
  const std::lock_guard lock(submitting_);
  if (store_.ended(id)) {
    store_.remove(id);
  } else {
    const Json state{{"state", "cancelled"},
                     {"finished", utcNowText()},
                     {"outcome", nullptr},
                     {"detail", nullptr},
                     {"cases", Json::array()}};
    store_.write(id, "state.json", state.dump(1) + "\n");
    if (!store_.running(id)) store_.dropSeeds(id);
  }
  runner_.look(id);
}

std::string Comparisons::file(const std::string& id, const char* name) const {
  require(id);
  if (store_.ended(id))
    if (std::optional<std::string> text = store_.read(id, name)) return std::move(*text);
  throw ProblemError(notFound("the comparison has no result; its state says why"));
}

std::string Comparisons::suite(const std::string& id) const {
  require(id);
  const Json request = store_.readJson(id, "request.json");
  if (!request.contains("suite")) throw ProblemError(notFound("the comparison's suite is damaged"));
  return request["suite"].dump(2) + "\n";
}

Comparisons::News Comparisons::newsSince(const std::string& known, const std::string& id,
                                         const Cancellation& cancelled) {
  const auto end = std::chrono::steady_clock::now() + kLongestWatch;
  const bool mayWait = ++watchers_ <= kMostWatchers;
  const std::shared_ptr<void> watching(nullptr, [this](void*) { --watchers_; });
  for (;; std::this_thread::sleep_for(kWatchPause)) {
    const Json job = status(id);
    News news;
    news.final = job["state"] != "queued" && job["state"] != "running";
    std::string text = job.dump(-1, ' ', false, Json::error_handler_t::replace);
    news.version = digestOf(text).hex();
    if (news.version != known) news.status = std::move(text);
    if (!news.status.empty() || news.final || !mayWait || stopping_ || cancelled() ||
        std::chrono::steady_clock::now() >= end)
      return news;
  }
}

Comparisons::State Comparisons::state() const {
  State state{0, 0, store_.options().waiting, store_.options().bytes};
  for (const std::string& id : store_.unfinished())
    ++(store_.running(id) ? state.running : state.queued);
  return state;
}

void Comparisons::stop() {
  stopping_ = true;
  runner_.stop();
}

} // namespace chamfer::http
