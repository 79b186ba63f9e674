// The thread that works on jobs, one after the other, behind everything else that the server does.
#pragma once

#include "server/http/comparisons/job_lock.h"
#include "server/http/comparisons/job_store.h"
#include "server/http/routes/routes.h"
#include "server/jobs/compare/result.h"

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace chamfer::http {

class JobRunner {
public:
  JobRunner(const JobStore& store, const Parts& parts);
  /// As stop(), and waits for it.
  ~JobRunner();
  JobRunner(const JobRunner&) = delete;
  JobRunner& operator=(const JobRunner&) = delete;

  /// There may be a new job.
  void wake();
  /// The job under way ends at once, and goes on with whoever starts next.
  void stop();
  /// If it is this job that is under way here, it looks whether it has been cancelled.
  void look(const std::string& id);
  /// Of the job if it is under way here, as in progress.json, up to the moment; null: it is not.
  nlohmann::ordered_json progressOf(const std::string& id) const;

private:
  using Json = nlohmann::ordered_json;
  using Clock = std::chrono::steady_clock;
  void run();
  void workOnOne();
  void work(const std::string& id);
  void compare(const std::string& id);
  void finish(const std::string& id, SuiteResult result);
  void fail(const std::string& id, const std::string& why);
  void countTry(const std::string& id) const;
  /// Asked by the work, from any thread: has it lost its purpose? Tells other processes how far it is
  /// meanwhile.
  bool lostPurpose();
  std::string clean(std::string message) const;

  const JobStore& store_;
  const Parts& parts_;
  std::atomic<bool> stopping_ = false, cancelled_ = false;
  std::atomic<Clock::rep> nextLook_ = 0;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  bool woken_ = false;
  std::string current_; ///< id; empty: none
  Json progress_;
  std::thread thread_;
};

} // namespace chamfer::http
