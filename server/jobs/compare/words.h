// What results and reports say to people in words; one place, so that all of them say the same.
#pragma once

#include "server/jobs/compare/result.h"

#include <string>
#include <string_view>

namespace chamfer {

/// "same", "differs", "cannot tell", "error".
std::string outcomeText(Outcome outcome);

/// "R", "G", "B", "A" of pictures with 3 or 4 channels, "grey" of those with one.
std::string channelText(unsigned channel, unsigned channels);

/// "0.0012 +- 0.0001", "38.2 dB".
std::string metricValueText(const MetricResult& metric);
/// "at most 0.01", "at least 40 dB"; empty: no limit.
std::string metricLimitText(const MetricResult& metric);

/// "0.3 %" of 0.003.
std::string percentText(double share);

/// What a level found, and what would have been found, in one or two sentences that end with a full stop.
std::string levelText(const LevelResult& level, unsigned channels);

/// The level that decided: the worst, of equal ones the coarsest, which sees the smallest differences.
/// nullptr: there is none.
const LevelResult* decidingLevel(const StatisticsResult& statistics);

/// What decided a case, for its `reason`. `ended`: why the budget ended before its seeds did; empty: it did
/// not.
std::string reasonText(const CaseResult& result, const std::string& ended);

/// "1 same, 2 differ, 1 cannot be told, 3 errors": kinds that did not happen are left out.
std::string countsText(const SuiteResult& result);

/// `text` as valid UTF-8: what is none becomes U+FFFD.
std::string validUtf8(const std::string& text);

} // namespace chamfer
