// Threads for work on a mesh, by the number that the user asked for.
#pragma once

#include <optional>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <utility>

namespace chamfer {

class WorkerArena {
public:
  /// 0: all cores. More than there are cores are allowed: TBB alone would refuse them where it has been used
  /// before, with a warning on standard error.
  explicit WorkerArena(unsigned threads) : arena_(threads ? int(threads) : tbb::task_arena::automatic) {
    if (threads) limit_.emplace(tbb::global_control::max_allowed_parallelism, threads);
  }

  template <class F>
  void execute(F&& f) {
    arena_.execute(std::forward<F>(f));
  }

private:
  std::optional<tbb::global_control> limit_;
  tbb::task_arena arena_; // takes its workers at its first use
};

} // namespace chamfer
