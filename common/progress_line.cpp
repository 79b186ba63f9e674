#include "common/progress_line.h"

#include <algorithm>
#include <cstdio>

namespace chamfer {

ProgressLine::ProgressLine(bool wanted, int terminal)
    : terminal_(wanted && ::isatty(terminal) ? terminal : -1) {}

ProgressLine::~ProgressLine() {
  if (shown_) print("\r\033[K");
}

void ProgressLine::operator()(const char* stage, double share) {
  if (terminal_ < 0) return;
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock) return; // another thread's report is as good
  const int percent = int(std::clamp(share, 0.0, 1.0) * 100);
  const auto now = Clock::now();
  if (now - start_ < std::chrono::seconds(1) || now - last_ < std::chrono::milliseconds(100)) return;
  if (stage == stage_ && percent < percent_) return; // threads overtake each other
  last_ = now;
  shown_ = true;
  stage_ = stage;
  percent_ = percent;
  const int width = 30, filled = percent * width / 100;
  char text[96];
  std::snprintf(text, sizeof text, "\r%-12.20s [%.*s%*s] %3d %%", stage, filled,
                "##############################", width - filled, "", percent);
  print(text);
}

void ProgressLine::print(const std::string& text) const {
  // A terminal that takes nothing is no reason to stop.
  if (::write(terminal_, text.data(), text.size()) < 0) return;
}

} // namespace chamfer
