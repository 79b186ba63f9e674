// The line of progress that commands show while they work.
#pragma once

#include <chrono>
#include <mutex>
#include <string>
#include <unistd.h>

namespace chamfer {

/// One line on a terminal: a stage, a bar, percents. It appears where the work takes longer than a second,
/// changes ten times a second at most, and is gone at the end. Any thread may report.
class ProgressLine {
public:
  /// Nothing is shown unless it is `wanted` and `terminal` is one.
  explicit ProgressLine(bool wanted, int terminal = STDERR_FILENO);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  /// `share`: 0..1 of the stage; less than was shown of the same stage is not shown.
  void operator()(const char* stage, double share);

private:
  using Clock = std::chrono::steady_clock;

  void print(const std::string& text) const;

  int terminal_; ///< below 0: show nothing
  std::mutex mutex_;
  bool shown_ = false;
  std::string stage_;
  int percent_ = 0;
  Clock::time_point start_ = Clock::now(), last_{};
};

} // namespace chamfer
