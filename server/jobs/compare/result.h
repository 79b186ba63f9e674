// What a comparison found. Plain data: the engine fills it in, reports (JSON, JUnit, HTML) print it.
#pragma once

#include "server/jobs/image/picture.h"
#include "server/jobs/image/region.h"
#include "server/jobs/metrics/metrics.h"

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace chamfer {

enum class Outcome : std::uint8_t {
  Same,
  Differs,
  CannotTell, ///< the budget ended before either could be said
  Error,      ///< not compared: an input is missing, malformed or not comparable
};
/// "same", "differs", "cannot-tell", "error".
const char* outcomeWord(Outcome outcome);
/// Of several cases: the worst, Error before Differs before CannotTell before Same.
Outcome worse(Outcome a, Outcome b);
/// Of `chamferd compare`: 0 same, 1 differs, 2 error or cannot tell.
int exitStatusOf(Outcome outcome);

struct SideResult {
  std::string label; ///< as the user wrote it
  bool isRender = false;
  std::string sceneId; ///< of a render, hexadecimal
  /// Of a render, for people: ("rounding", "mesh:64"), ("radius", "0.1") ...; what is as by default is left
  /// out.
  std::vector<std::pair<std::string, std::string>> settings;
  unsigned seeds = 0, samplesPerSeed = 0; ///< 0 of an image
  Picture mean;                           ///< of the crop; empty where it never came to one
  std::string stale; ///< of a reference made by another version or scene: why; empty: it is not
};

/// One scale at which means were tested: single pixels, blocks, the whole.
struct LevelResult {
  std::string level;  ///< "pixel", "block", "image"
  unsigned block = 1; ///< side in pixels; of "image" 0
  std::size_t tests = 0;
  Outcome outcome = Outcome::CannotTell;
  double pValue = 1; ///< of the worst place, corrected for the number of places and levels
  /// The place whose difference stands out most from its noise, in the frame.
  TileRect worst;
  unsigned channel = 0;
  double a = 0, b = 0; ///< means there
  /// Relative to the brightness there (statistics.h says how): the smallest difference that would have been
  /// seen wherever it was; what every true difference is below, at the stated significance; what "same" asks
  /// of the latter.
  double seenFrom = 0, boundedBy = 0, resolution = 0;
};

struct StatisticsResult {
  std::string method; ///< a sentence: how sides were paired, what was tested
  double significance = 0;
  unsigned seeds = 0, mostSeeds = 0; ///< of each side: rendered, and what the budget allows
  bool identical = false;            ///< no value differed, in any seed or in the means
  std::vector<LevelResult> levels;
  Outcome outcome() const; ///< of all levels together
};

struct MetricResult {
  Metric metric = Metric::Mae;
  double value = 0;
  std::optional<double> standardError; ///< of renders: from their seeds; nothing: exact
  std::optional<double> limit;         ///< nothing: shown only
  Outcome outcome = Outcome::Same;     ///< against the limit
};

struct CaseResult {
  std::string name;
  Outcome outcome = Outcome::Error;
  std::string reason;  ///< one sentence, for people: what decided
  std::string command; ///< that repeats this case alone
  double seconds = 0;
  SideResult a, b; ///< a is judged by b
  Region region;
  PixelTolerance tolerance; ///< of failing_share
  std::vector<MetricResult> metrics;
  std::optional<LargestError> largest;
  std::optional<StatisticsResult> statistics;
  std::vector<std::string> warnings;
};

struct SuiteResult {
  std::string program; ///< "chamferd 0.1.0"
  std::string command;
  std::string started; ///< UTC, "2026-01-31T12:00:00Z"
  double seconds = 0;
  std::vector<CaseResult> cases;
  Outcome outcome() const;
};

} // namespace chamfer
