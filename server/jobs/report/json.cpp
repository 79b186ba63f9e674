#include "server/jobs/report/json.h"

#include "server/jobs/compare/words.h"
#include "server/jobs/report/reports.h"

#include <cmath>
#include <initializer_list>

namespace chamfer {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "chamfer.comparison/1";

Json optionalNumber(const std::optional<double>& value) { return value ? jsonNumber(*value) : Json(); }
Json optionalText(const std::string& text) { return text.empty() ? Json() : Json(text); }

/// Pairs as an array, not an object: a name may come twice, and order is meant.
template <class Pairs>
Json pairsJson(const Pairs& pairs) {
  Json all = Json::array();
  for (const auto& [name, value] : pairs)
    all.push_back({{"name", name}, {"value", value}});
  return all;
}

Json rectJson(const TileRect& rect) {
  return {{"x", rect.x}, {"y", rect.y}, {"width", rect.width}, {"height", rect.height}};
}

Json pictureJson(const Picture& picture) {
  if (picture.values.empty()) return nullptr;
  return {{"width", picture.width},
          {"height", picture.height},
          {"channels", picture.channels},
          {"display", picture.display},
          {"has_variance", !picture.variance.empty()},
          {"about", pairsJson(picture.about)}};
}

Json sideJson(const SideResult& side) {
  return {{"label", side.label},
          {"is_render", side.isRender},
          {"scene_id", optionalText(side.sceneId)},
          {"settings", pairsJson(side.settings)},
          {"seeds", side.seeds},
          {"samples_per_seed", side.samplesPerSeed},
          {"picture", pictureJson(side.mean)},
          {"stale", optionalText(side.stale)}};
}

Json metricJson(const MetricResult& metric) {
  const MetricRow& row = metricRow(metric.metric);
  return {{"name", row.name},
          {"unit", row.unit},
          {"value", jsonNumber(metric.value)},
          {"standard_error", optionalNumber(metric.standardError)},
          {"limit", optionalNumber(metric.limit)},
          {"limit_kind", !metric.limit ? Json() : Json(row.moreIsBetter ? "least" : "most")},
          {"outcome", outcomeWord(metric.outcome)}};
}

Json levelJson(const LevelResult& level, unsigned channels) {
  return {{"level", level.level},
          {"block", level.block},
          {"tests", level.tests},
          {"outcome", outcomeWord(level.outcome)},
          {"p_value", jsonNumber(level.pValue)},
          {"worst", rectJson(level.worst)},
          {"channel", channelText(level.channel, channels)},
          {"a", jsonNumber(level.a)},
          {"b", jsonNumber(level.b)},
          {"seen_from", jsonNumber(level.seenFrom)},
          {"bounded_by", jsonNumber(level.boundedBy)},
          {"resolution", jsonNumber(level.resolution)},
          {"text", levelText(level, channels)}};
}

Json statisticsJson(const StatisticsResult& statistics, unsigned channels) {
  Json levels = Json::array();
  for (const LevelResult& level : statistics.levels)
    levels.push_back(levelJson(level, channels));
  return {{"method", statistics.method},       {"significance", jsonNumber(statistics.significance)},
          {"seeds", statistics.seeds},         {"most_seeds", statistics.mostSeeds},
          {"identical", statistics.identical}, {"levels", levels}};
}

Json caseJson(const CaseResult& one) {
  const unsigned channels = one.a.mean.channels;
  Json metrics = Json::array();
  for (const MetricResult& metric : one.metrics)
    metrics.push_back(metricJson(metric));
  Json largest;
  if (one.largest)
    largest = {{"x", one.largest->x},
               {"y", one.largest->y},
               {"channel", channelText(one.largest->channel, channels)},
               {"a", jsonNumber(one.largest->a)},
               {"b", jsonNumber(one.largest->b)},
               {"error", jsonNumber(one.largest->error)}};
  return {
      {"name", one.name},
      {"outcome", outcomeWord(one.outcome)},
      {"reason", one.reason},
      {"command", one.command},
      {"seconds", jsonNumber(one.seconds)},
      {"a", sideJson(one.a)},
      {"b", sideJson(one.b)},
      {"region",
       {{"crop", rectJson(one.region.crop)},
        {"pixels", one.region.pixels},
        {"text", optionalText(one.region.text)}}},
      {"tolerance",
       {{"absolute", jsonNumber(one.tolerance.absolute)}, {"relative", jsonNumber(one.tolerance.relative)}}},
      {"metrics", metrics},
      {"largest", largest},
      {"statistics", one.statistics ? statisticsJson(*one.statistics, channels) : Json()},
      {"warnings", one.warnings}};
}

} // namespace

nlohmann::ordered_json jsonNumber(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}

nlohmann::ordered_json suiteJson(const SuiteResult& result) {
  unsigned same = 0, differs = 0, cannotTell = 0, error = 0;
  Json cases = Json::array();
  for (const CaseResult& one : result.cases) {
    switch (one.outcome) {
    case Outcome::Same:
      ++same;
      break;
    case Outcome::Differs:
      ++differs;
      break;
    case Outcome::CannotTell:
      ++cannotTell;
      break;
    case Outcome::Error:
      ++error;
      break;
    }
    cases.push_back(caseJson(one));
  }
  const Outcome outcome = result.outcome();
  return {{"schema", kSchema},
          {"program", result.program},
          {"command", result.command},
          {"started", result.started},
          {"seconds", jsonNumber(result.seconds)},
          {"outcome", outcomeWord(outcome)},
          {"exit_status", exitStatusOf(outcome)},
          {"counts", {{"same", same}, {"differs", differs}, {"cannot_tell", cannotTell}, {"error", error}}},
          {"cases", cases}};
}

std::string textOfJson(const nlohmann::ordered_json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

std::string comparisonJson(const SuiteResult& result) { return textOfJson(suiteJson(result), 2) + "\n"; }

} // namespace chamfer
