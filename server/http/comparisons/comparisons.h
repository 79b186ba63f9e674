// Comparisons as jobs of the server: submitted, looked at, cancelled.
#pragma once

#include "server/http/comparisons/job_runner.h"
#include "server/http/comparisons/job_store.h"

#include <atomic>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace chamfer::http {

class Comparisons {
public:
  /// As JobStore's. Begins to work on what the folder holds once the scenes are loaded.
  Comparisons(const JobOptions& options, const Parts& parts);

  struct Submitted {
    std::string id;
    bool finished; ///< it was asked for before, and its result is there
  };
  /// As readSubmission(); ProblemError (503) where too many wait.
  Submitted submit(const std::string& body);
  /// A job as clients see it, a component "Comparison" of openapi_schemas.h. ProblemError (404).
  nlohmann::ordered_json status(const std::string& id) const;
  /// All of them, the newest first, without their cases.
  nlohmann::ordered_json list() const;
  /// A job that has not ended is cancelled, one that has is removed. ProblemError (404).
  void end(const std::string& id);
  /// result.json, report.html, junit.xml. ProblemError (404).
  std::string file(const std::string& id, const char* name) const;
  /// The suite as it was submitted. ProblemError (404).
  std::string suite(const std::string& id) const;

  struct News {
    std::string version; ///< of the status
    std::string status;  ///< JSON on one line; empty: it is what was known
    bool final = false;  ///< it will not change any more
  };
  /// The status once its version is another than `known`, or after some seconds that there is none; at once
  /// where it cannot change any more, and while many wait already. ProblemError (404).
  News newsSince(const std::string& known, const std::string& id, const Cancellation& cancelled);

  struct State {
    unsigned queued = 0, running = 0, places = 0;
    std::uint64_t limitBytes = 0;
  };
  State state() const;
  /// As JobRunner's; who waits for a change is answered.
  void stop();

private:
  void require(const std::string& id) const;
  nlohmann::ordered_json facts(const std::string& id) const;

  const JobStore store_;
  const Parts& parts_;
  std::mutex submitting_;
  std::atomic<bool> stopping_ = false;
  std::atomic<unsigned> watchers_ = 0;
  JobRunner runner_;
};

/// Requests that may wait for a change at one time; each has a thread.
inline constexpr unsigned kMostWatchers = 16;

} // namespace chamfer::http
