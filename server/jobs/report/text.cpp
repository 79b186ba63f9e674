#include "server/jobs/compare/words.h"
#include "server/jobs/report/reports.h"

#include "common/text.h"

#include <algorithm>

namespace chamfer {
namespace {

/// A terminal obeys some characters: printable() leaves none of those. Longer than any line that is of use.
constexpr std::size_t kMostCharacters = 2000;
std::string safe(const std::string& text) { return printable(text, kMostCharacters); }

/// Characters, not bytes, up to a column.
std::string padded(std::string text, std::size_t columns) {
  const auto characters = std::size_t(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
  if (characters < columns) text.append(columns - characters, ' ');
  return text;
}

std::string row(const char* head, const std::string& text) { return "  " + padded(head, 13) + text + '\n'; }

std::string sideText(const SideResult& side) {
  std::string text = safe(side.label), more;
  for (const auto& [name, value] : side.settings)
    more += (more.empty() ? "" : ", ") + name + " " + value;
  if (side.seeds > 0)
    more += (more.empty() ? "" : ", ") + std::to_string(side.seeds) + (side.seeds == 1 ? " seed" : " seeds") +
            " of " + std::to_string(side.samplesPerSeed) + " samples";
  if (!more.empty()) text += " (" + safe(more) + ")";
  if (!side.stale.empty()) text += "; stale: " + safe(side.stale);
  return text;
}

/// One row a limit; when there are many, those that hold share one, as those without a limit do.
std::string metricRowsText(const CaseResult& one) {
  constexpr std::ptrdiff_t kMostRows = 3;
  const auto limits = std::count_if(one.metrics.begin(), one.metrics.end(),
                                    [](const MetricResult& metric) { return metric.limit.has_value(); });
  std::string rows, kept, shown;
  std::ptrdiff_t written = 0;
  for (const MetricResult& metric : one.metrics) {
    const std::string name(metricRow(metric.metric).name), value = metricValueText(metric);
    if (!metric.limit) {
      shown += (shown.empty() ? "" : ", ") + name + ' ' + value;
    } else if (limits > kMostRows && (metric.outcome == Outcome::Same || written == kMostRows)) {
      const bool isBroken = metric.outcome != Outcome::Same;
      kept += (kept.empty() ? "" : ", ") + name + ' ' + value + " (" + metricLimitText(metric) +
              (isBroken ? "; " + outcomeText(metric.outcome) : "") + ')';
    } else {
      rows += row(name.c_str(), padded(value, 20) + ' ' + padded(metricLimitText(metric), 18) + ' ' +
                                    outcomeText(metric.outcome));
      ++written;
    }
  }
  if (!kept.empty()) rows += row("other limits", kept);
  if (!shown.empty()) rows += row("no limits", shown);
  return rows;
}

std::string warningsText(const CaseResult& one) {
  std::vector<std::string> warnings = one.warnings;
  keepFirst(warnings, 2);
  std::string rows;
  for (const std::string& warning : warnings)
    rows += row("warning", safe(warning));
  return rows;
}

std::string caseText(const CaseResult& one, bool isSuite) {
  std::string text = safe(one.name) + '\n';
  text += row("a", sideText(one.a)) + row("b", sideText(one.b));
  if (!one.region.text.empty()) text += row("region", safe(one.region.text));
  text += metricRowsText(one);
  if (one.largest)
    text +=
        row("largest", numberText(one.largest->error, 4) + " at " + std::to_string(one.largest->x) + ", " +
                           std::to_string(one.largest->y) + " (" +
                           channelText(one.largest->channel, one.a.mean.channels) + ": " +
                           numberText(one.largest->a, 4) + " against " + numberText(one.largest->b, 4) + ")");
  if (one.statistics) {
    if (one.statistics->identical)
      text += row("statistics", "no value differs");
    else if (const LevelResult* level = decidingLevel(*one.statistics))
      text += row("statistics", levelText(*level, one.a.mean.channels));
  }
  text += warningsText(one);
  // Of a single comparison the user has just typed it.
  if (isSuite && one.outcome != Outcome::Same && !one.command.empty())
    text += row("repeat", safe(one.command));
  return text + row("verdict", outcomeText(one.outcome) + ": " + safe(one.reason));
}

} // namespace

std::string comparisonText(const SuiteResult& result) {
  const bool isSuite = result.cases.size() != 1;
  std::string text;
  for (const CaseResult& one : result.cases)
    text += caseText(one, isSuite) + (isSuite ? "\n" : "");
  if (isSuite)
    text += countsText(result) + " in " + numberText(result.seconds, 3) +
            " s: " + outcomeText(result.outcome()) + '\n';
  return text;
}

} // namespace chamfer
