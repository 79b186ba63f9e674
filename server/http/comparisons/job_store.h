// Jobs as files, which several servers may share:
//   DIR/{id}/request.json   what was asked for; its time is that of the submission
//            lock           held by whoever works on it
//            progress.json  written by them about once a second
//            seeds/         of an unfinished job: what was rendered so far
//            result.json report.html junit.xml
//            state.json     written last: the job has ended, and how
// A file is written at once or not at all, so that a process may be killed at any time: what has no
// state.json is taken up again where it was.
#pragma once

#include "server/http/comparisons/job_options.h"

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace chamfer::http {

class JobStore {
public:
  /// Makes the folder if there is none. Error(Usage) where it lies below the served folder `root`, or that
  /// below it; Error(CannotWrite).
  JobStore(JobOptions options, const std::filesystem::path& root);

  static bool isId(std::string_view text);
  /// Of all jobs, by the time of their submission.
  std::vector<std::string> ids() const;
  std::vector<std::string> unfinished() const;
  bool has(const std::string& id) const;
  bool ended(const std::string& id) const;
  /// Does a process work on it?
  bool running(const std::string& id) const;
  /// UTC, "2026-01-31T12:00:00Z".
  std::string submitted(const std::string& id) const;

  std::filesystem::path path(const std::string& id, const char* name) const;
  /// Nothing where there is no such file.
  std::optional<std::string> read(const std::string& id, const char* name) const;
  /// The same as JSON; null where there is none.
  nlohmann::ordered_json readJson(const std::string& id, const char* name) const;
  /// Error(CannotWrite).
  void write(const std::string& id, const char* name, const std::string& text) const;

  /// A new job; nothing happens where there is one already. Error(CannotWrite).
  void add(const std::string& id, const std::string& request) const;
  /// An ended job is to begin again.
  void restart(const std::string& id, const std::string& request) const;
  void remove(const std::string& id) const;
  void dropSeeds(const std::string& id) const;
  /// Removes ended jobs that are too old, the oldest where all take too much room or are too many, and what a
  /// killed process left.
  void tidy() const;

  const JobOptions& options() const { return options_; }

private:
  std::filesystem::path scratch(const char* why) const;
  JobOptions options_;
};

/// UTC now, as submitted().
std::string utcNowText();

} // namespace chamfer::http
