// A fixed number of threads and a bounded list of tasks for them.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace chamfer::http {

class WorkerPool {
public:
  /// `pending`: tasks that may wait for a thread.
  WorkerPool(unsigned threads, std::size_t pending);
  /// Runs what is still waiting, then joins.
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// False, with `task` untouched, when the list is full. Tasks must not throw.
  bool submit(std::function<void()>&& task);

private:
  void run();

  const std::size_t pendingLimit_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::function<void()>> tasks_;
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

} // namespace chamfer::http
