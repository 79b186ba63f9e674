#include "server/jobs/compare/words.h"

#include "common/text.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace chamfer {
namespace {

constexpr int kDigits = 4;

std::string withUnit(double value, std::string_view unit) {
  return numberText(value, kDigits) + (unit.empty() ? "" : " " + std::string(unit));
}

/// "an 8 x 8 block", "a single pixel", "the whole picture's mean".
std::string placeText(const LevelResult& level) {
  if (level.block == 0) return "the whole picture's mean";
  if (level.block == 1) return "a single pixel";
  const std::string side = std::to_string(level.block);
  const bool vowel = side.starts_with('8') || side == "11" || side == "18";
  return (vowel ? "an " : "a ") + side + " x " + side + " block";
}

/// "0.31 against 0.6"; of numbers that differ little with as many digits as show it.
std::string againstText(double a, double b) {
  int digits = kDigits;
  while (a != b && digits < 9 && numberText(a, digits) == numberText(b, digits))
    ++digits;
  return numberText(a, digits) + " against " + numberText(b, digits);
}

} // namespace

std::string outcomeText(Outcome outcome) {
  return outcome == Outcome::CannotTell ? "cannot tell" : outcomeWord(outcome);
}

std::string channelText(unsigned channel, unsigned channels) {
  constexpr const char* kNames[] = {"R", "G", "B", "A"};
  if (channels < 3) return "grey";
  return channel < 4 ? kNames[channel] : std::to_string(channel);
}

std::string metricValueText(const MetricResult& metric) {
  std::string text = numberText(metric.value, kDigits);
  if (metric.standardError) text += " ± " + numberText(*metric.standardError, 2);
  const std::string_view unit = metricRow(metric.metric).unit;
  return unit.empty() ? text : text + " " + std::string(unit);
}

std::string metricLimitText(const MetricResult& metric) {
  if (!metric.limit) return "";
  const MetricRow& row = metricRow(metric.metric);
  return (row.moreIsBetter ? "at least " : "at most ") + withUnit(*metric.limit, row.unit);
}

std::string percentText(double share) { return numberText(100 * share, 3) + " %"; }

std::string levelText(const LevelResult& level, unsigned channels) {
  const std::string seen = "Any difference above " + percentText(level.seenFrom) + " of " + placeText(level) +
                           " would have been seen";
  switch (level.outcome) {
  case Outcome::Same:
    return seen + "; every true one is below " + percentText(level.boundedBy) + ".";
  case Outcome::Differs: {
    std::string where = "The whole picture's mean";
    if (level.block != 0)
      where = (level.block == 1 ? "The pixel at " : "The block at ") + std::to_string(level.worst.x) + ", " +
              std::to_string(level.worst.y);
    return where + " differs (" + channelText(level.channel, channels) + ": " +
           againstText(level.a, level.b) + "): noise alone does so with a probability of at most " +
           numberText(level.pValue, 2) + ".";
  }
  case Outcome::CannotTell:
    return seen + ", but a true one may be as large as " + percentText(level.boundedBy) +
           ", and \"same\" asks for less than " + percentText(level.resolution) + ".";
  case Outcome::Error:
    break;
  }
  return "Not tested.";
}

const LevelResult* decidingLevel(const StatisticsResult& statistics) {
  const LevelResult* found = nullptr;
  for (const LevelResult& level : statistics.levels)
    if (!found || worse(found->outcome, level.outcome) == level.outcome) found = &level;
  return found;
}

std::string reasonText(const CaseResult& result, const std::string& ended) {
  std::string text;
  const auto add = [&](const std::string& sentence) { text += (text.empty() ? "" : " ") + sentence; };
  bool limits = false;
  for (const MetricResult& metric : result.metrics) {
    limits = limits || metric.limit;
    if (!metric.limit || metric.outcome == Outcome::Same || metric.outcome != result.outcome) continue;
    const std::string name(metricRow(metric.metric).name);
    add(name + " is " + metricValueText(metric) + ", the limit " + metricLimitText(metric) +
        (metric.outcome == Outcome::CannotTell ? ": too near for its noise." : "."));
  }
  const LevelResult* level = result.statistics ? decidingLevel(*result.statistics) : nullptr;
  if (level && level->outcome == result.outcome) {
    if (result.statistics->identical && result.outcome == Outcome::Same)
      add(result.a.isRender && result.b.isRender
              ? "No value differs in any of " + std::to_string(result.statistics->seeds) + " seeds."
              : "The mean of " + std::to_string(result.statistics->seeds) +
                    " seeds is the reference, bit by bit.");
    else
      add(levelText(*level, result.a.mean.channels));
  }
  if (result.outcome == Outcome::CannotTell)
    add(ended.empty() ? "The budget of seeds ended; give more, or ask for less."
                      : "The budget ended: " + ended + ".");
  if (text.empty())
    add(limits                            ? "All limits are kept."
        : result.outcome == Outcome::Same ? "No value differs."
                                          : "Values differ.");
  return text;
}

std::string countsText(const SuiteResult& result) {
  struct Words {
    Outcome outcome;
    const char *one, *many;
  };
  constexpr Words kWords[] = {{Outcome::Same, "same", "same"},
                              {Outcome::Differs, "differs", "differ"},
                              {Outcome::CannotTell, "cannot be told", "cannot be told"},
                              {Outcome::Error, "error", "errors"}};
  std::string text;
  for (const Words& words : kWords) {
    const auto count = std::count_if(result.cases.begin(), result.cases.end(),
                                     [&](const CaseResult& one) { return one.outcome == words.outcome; });
    if (count == 0) continue;
    text += (text.empty() ? "" : ", ") + std::to_string(count) + ' ' + (count == 1 ? words.one : words.many);
  }
  return text.empty() ? "no cases" : text;
}

std::string validUtf8(const std::string& text) {
  using nlohmann::json;
  return json::parse(json(text).dump(-1, ' ', false, json::error_handler_t::replace)).get<std::string>();
}

} // namespace chamfer
