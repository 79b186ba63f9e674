// Durations of the stages of one answer: for its Server-Timing header and for the metrics.
#pragma once

#include "server/http/monitoring/metrics.h"

#include <chrono>
#include <cstdio>
#include <string>

namespace chamfer::http {

class StageTiming {
public:
  explicit StageTiming(Metrics& metrics) : metrics_(metrics) {}

  /// A stage ends now; it began when the one before it ended.
  void lap(Stage stage) {
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double> took = now - since_;
    metrics_.took(stage, took.count());
    char text[64];
    std::snprintf(text, sizeof text, "%s%s;dur=%.3f", text_.empty() ? "" : ", ", stageWord(stage),
                  took.count() * 1000);
    text_ += text;
    since_ = now;
  }
  /// Server-Timing (W3C), in milliseconds.
  const std::string& text() const { return text_; }

private:
  Metrics& metrics_;
  std::string text_;
  std::chrono::steady_clock::time_point since_ = std::chrono::steady_clock::now();
};

} // namespace chamfer::http
