#include "server/http/comparisons/job_store.h"

#include "common/atomic_file.h"
#include "common/error.h"
#include "common/text.h"
#include "server/http/comparisons/job_lock.h"

#include <algorithm>
#include <ctime>
#include <fstream>
#include <iterator>
#include <random>
#include <sys/stat.h>

namespace chamfer::http {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostEnded = 1000; ///< jobs; a list of them stays readable
constexpr std::time_t kLeftAlone = 3600; ///< seconds after which half a job is nobody's

bool isWithin(const fs::path& inner, const fs::path& outer) {
  return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

void requireApart(const fs::path& folder, const fs::path& root) {
  if (isWithin(folder, root) || isWithin(root, folder))
    throw Error(ErrorKind::Usage, "the folder of jobs " + fileInQuotes(folder.string()) +
                                      " and the served one " + fileInQuotes(root.string()) +
                                      " must not lie within each other; name a place outside with --jobs");
}

timespec timeOf(const fs::path& file) {
  struct stat facts {};
  return ::stat(file.c_str(), &facts) == 0 ? facts.st_mtim : timespec{};
}

std::uint64_t bytesBelow(const fs::path& folder) {
  std::uint64_t bytes = 0;
  std::error_code error;
  for (auto entry = fs::recursive_directory_iterator(folder, error);
       !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
    std::error_code gone;
    if (const auto size = entry->is_regular_file(gone) ? entry->file_size(gone) : 0; !gone) bytes += size;
  }
  return bytes;
}

std::string utcText(std::time_t time) {
  std::tm utc{};
  ::gmtime_r(&time, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

} // namespace

std::string utcNowText() { return utcText(std::time(nullptr)); }

JobStore::JobStore(JobOptions options, const fs::path& root) : options_(std::move(options)) {
  std::error_code error;
  const fs::path wanted = fs::weakly_canonical(fs::absolute(options_.folder, error), error);
  if (!error) requireApart(wanted, root); // before anything is made
  fs::create_directories(options_.folder, error);
  const fs::path real = fs::canonical(options_.folder, error);
  if (error || !fs::is_directory(real, error))
    throw Error(ErrorKind::CannotWrite, "cannot make the folder of jobs " +
                                            fileInQuotes(options_.folder.string()) +
                                            (error ? ": " + error.message() : ": it is no folder"));
  requireApart(real, root);
  options_.folder = real;
  JobLock::tryTake(real / ".locks"); // can it be written to, and are there locks? Throws
}

bool JobStore::isId(std::string_view text) {
  return text.size() == 32 && std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
         });
}

std::vector<std::string> JobStore::ids() const {
  std::vector<std::pair<std::pair<std::time_t, long>, std::string>> found;
  std::error_code error;
  for (auto entry = fs::directory_iterator(options_.folder, error);
       !error && entry != fs::directory_iterator(); entry.increment(error)) {
    const std::string id = entry->path().filename().string();
    if (!isId(id)) continue;
    const timespec time = timeOf(path(id, "request.json"));
    if (time.tv_sec > 0) found.push_back({{time.tv_sec, time.tv_nsec}, id});
  }
  std::sort(found.begin(), found.end());
  std::vector<std::string> ids;
  for (auto& [time, id] : found)
    ids.push_back(std::move(id));
  return ids;
}

std::vector<std::string> JobStore::unfinished() const {
  std::vector<std::string> all = ids();
  std::erase_if(all, [this](const std::string& id) { return ended(id); });
  return all;
}

bool JobStore::has(const std::string& id) const {
  std::error_code error;
  return isId(id) && fs::exists(path(id, "request.json"), error);
}

bool JobStore::ended(const std::string& id) const {
  std::error_code error;
  return fs::exists(path(id, "state.json"), error);
}

bool JobStore::running(const std::string& id) const { return JobLock::held(path(id, "lock")); }

std::string JobStore::submitted(const std::string& id) const {
  return utcText(timeOf(path(id, "request.json")).tv_sec);
}

fs::path JobStore::path(const std::string& id, const char* name) const { return options_.folder / id / name; }

std::optional<std::string> JobStore::read(const std::string& id, const char* name) const {
  std::ifstream stream(path(id, name), std::ios::binary);
  if (!stream) return {};
  return std::string(std::istreambuf_iterator<char>(stream), {});
}

nlohmann::ordered_json JobStore::readJson(const std::string& id, const char* name) const {
  const std::optional<std::string> text = read(id, name);
  auto json = nlohmann::ordered_json::parse(text.value_or("null"), nullptr, false);
  return json.is_discarded() ? nlohmann::ordered_json() : json;
}

void JobStore::write(const std::string& id, const char* name, const std::string& text) const {
  writeAtomically(path(id, name), std::as_bytes(std::span(text)));
}

/// A name that nobody else has and no job is called by.
fs::path JobStore::scratch(const char* why) const {
  std::random_device random;
  const std::uint64_t number = (std::uint64_t{random()} << 32) | random();
  return options_.folder / ("." + std::string(why) + "-" + std::to_string(number));
}

void JobStore::add(const std::string& id, const std::string& request) const {
  const fs::path folder = scratch("new");
  std::error_code error;
  fs::create_directory(folder, error);
  if (error) throw Error(ErrorKind::CannotWrite, "cannot make a folder for the job: " + error.message());
  try {
    writeAtomically(folder / "request.json", std::as_bytes(std::span(request)));
  } catch (...) {
    fs::remove_all(folder, error);
    throw;
  }
  fs::rename(folder, options_.folder / id, error);
  if (error && !has(id)) { // what is there was left of a job that is gone
    remove(id);
    fs::rename(folder, options_.folder / id, error);
  }
  if (!error) return;
  const bool there = has(id);
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  if (!there) throw Error(ErrorKind::CannotWrite, "cannot make a folder for the job: " + error.message());
}

void JobStore::restart(const std::string& id, const std::string& request) const {
  write(id, "request.json", request); // its time is new
  std::error_code ignored;
  for (const char* name : {"result.json", "report.html", "junit.xml", "progress.json", "state.json"})
    fs::remove(path(id, name), ignored);
}

void JobStore::remove(const std::string& id) const {
  const fs::path gone = scratch("gone");
  std::error_code error;
  fs::rename(options_.folder / id, gone, error); // at once, for whoever looks
  if (!error) fs::remove_all(gone, error);
}

void JobStore::dropSeeds(const std::string& id) const {
  std::error_code ignored;
  fs::remove_all(path(id, "seeds"), ignored);
}

void JobStore::tidy() const {
  const std::time_t now = std::time(nullptr);
  std::error_code error;
  for (auto entry = fs::directory_iterator(options_.folder, error);
       !error && entry != fs::directory_iterator(); entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    std::error_code ignored;
    if ((name.starts_with(".new-") || name.starts_with(".gone-")) &&
        now - timeOf(entry->path()).tv_sec > kLeftAlone)
      fs::remove_all(entry->path(), ignored);
  }

  struct Ended {
    std::time_t time;
    std::string id;
    std::uint64_t bytes;
  };
  std::vector<Ended> all;
  std::uint64_t bytes = 0;
  for (const std::string& id : ids()) {
    if (ended(id) && !running(id)) dropSeeds(id); // whoever ended it was killed right then
    const std::uint64_t own = bytesBelow(options_.folder / id);
    bytes += own;
    if (ended(id) && !running(id)) all.push_back({timeOf(path(id, "state.json")).tv_sec, id, own});
  }
  std::sort(all.begin(), all.end(), [](const Ended& a, const Ended& b) { return a.time < b.time; });
  std::size_t left = all.size();
  for (const Ended& job : all) {
    const bool old = now - job.time > options_.age.count();
    if (!old && bytes <= options_.bytes && left <= kMostEnded) break;
    remove(job.id);
    bytes -= job.bytes;
    --left;
  }
}

} // namespace chamfer::http
