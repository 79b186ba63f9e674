// Will a render end before its deadline? Told from its own pace, so that one that cannot gives its slot back
// after moments instead of at the deadline, and its client hears what would fit.
#pragma once

#include "server/http/connection/message.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>

namespace chamfer::http {

class RenderPace {
public:
  /// `looks`: how often the render will ask whether it is cancelled, at equal steps of its work.
  RenderPace(const Cancellation& cancelled, std::uint64_t looks)
      : cancelled_(cancelled), looks_(looks), begin_(std::chrono::steady_clock::now()),
        patience_(cancelled.deadline - begin_) {}

  /// To be asked by the render, from any thread: has the work lost its purpose, or is it hopeless?
  bool stop() {
    const std::uint64_t done = ++done_;
    if (hopeless_ || cancelled_()) return true;
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin_;
    // Parts of a picture differ in cost, and for a while others may have the cores: only what is far off.
    if (took.count() < std::max(kProbe * patience_.count(), kLeastSeconds)) return false;
    const double expected = took.count() * static_cast<double>(looks_) / static_cast<double>(done);
    if (expected < kFarOff * patience_.count()) return false;
    share_ = patience_.count() / expected;
    hopeless_ = true;
    return true;
  }

  bool hopeless() const { return hopeless_; }
  /// Once hopeless: the part of the work that would be done at the deadline, 0..1.
  double share() const { return share_; }

private:
  static constexpr double kProbe = 0.1;        ///< of the time there is, and at least
  static constexpr double kLeastSeconds = 0.5; ///< so much: then the pace is known
  static constexpr double kFarOff = 4;         ///< times the time there is

  const Cancellation& cancelled_;
  const std::uint64_t looks_;
  const std::chrono::steady_clock::time_point begin_;
  const std::chrono::duration<double> patience_;
  std::atomic<std::uint64_t> done_ = 0;
  std::atomic<bool> hopeless_ = false;
  std::atomic<double> share_ = 0;
};

} // namespace chamfer::http
