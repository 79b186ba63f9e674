#include "server/jobs/report/words.h"

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
    return where + " differs (" + channelText(level.channel, channels) + ": " + numberText(level.a, kDigits) +
           " against " + numberText(level.b, kDigits) + "): noise alone does so with a probability of " +
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
