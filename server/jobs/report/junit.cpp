#include "server/jobs/compare/words.h"
#include "server/jobs/report/reports.h"

#include <cstdio>
#include <pugixml.hpp>
#include <sstream>

namespace chamfer {
namespace {

/// As XML 1.0 can hold it: valid UTF-8, and U+FFFD for characters that it forbids, even escaped.
std::string forXml(const std::string& text) {
  constexpr const char* kReplacement = "\xef\xbf\xbd";
  const std::string valid = validUtf8(text);
  std::string out;
  for (std::size_t i = 0; i < valid.size(); ++i) {
    const unsigned char c = static_cast<unsigned char>(valid[i]);
    if (c < 0x20 && c != '\t' && c != '\n' && c != '\r') {
      out += kReplacement;
    } else if (valid.compare(i, 3, "\xef\xbf\xbe") == 0 || valid.compare(i, 3, "\xef\xbf\xbf") == 0) {
      out += kReplacement; // U+FFFE, U+FFFF
      i += 2;
    } else {
      out += valid[i];
    }
  }
  return out;
}

void setAttribute(pugi::xml_node node, const char* name, const std::string& value) {
  node.append_attribute(name).set_value(forXml(value).c_str());
}
void setText(pugi::xml_node node, const std::string& text) {
  node.append_child(pugi::node_pcdata).set_value(forXml(text).c_str());
}

std::string secondsText(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f", seconds >= 0 ? seconds : 0); // NaN, too
  return text;
}

std::string metricLine(const MetricResult& metric) {
  std::string line = std::string(metricRow(metric.metric).name) + ": " + metricValueText(metric);
  if (metric.limit) line += ", " + metricLimitText(metric) + ": " + outcomeText(metric.outcome);
  return line;
}

/// Why, what broke a limit, and how to see it again.
std::string detailsOf(const CaseResult& one) {
  std::string text = one.reason + '\n';
  for (const MetricResult& metric : one.metrics)
    if (metric.limit && metric.outcome != Outcome::Same) text += metricLine(metric) + '\n';
  if (one.statistics)
    for (const LevelResult& level : one.statistics->levels)
      if (level.outcome != Outcome::Same) text += levelText(level, one.a.mean.channels) + '\n';
  if (!one.command.empty()) text += "To repeat this case: " + one.command + '\n';
  return text;
}

/// What was found, whatever the verdict.
std::string outputOf(const CaseResult& one) {
  std::string text = "a: " + one.a.label + "\nb: " + one.b.label + '\n';
  for (const MetricResult& metric : one.metrics)
    text += metricLine(metric) + '\n';
  if (one.statistics)
    for (const LevelResult& level : one.statistics->levels)
      text += level.level + ": " + levelText(level, one.a.mean.channels) + '\n';
  for (const std::string& stale : {one.a.stale, one.b.stale})
    if (!stale.empty()) text += "stale: " + stale + '\n';
  for (const std::string& warning : one.warnings)
    text += "warning: " + warning + '\n';
  return text;
}

void setCounts(pugi::xml_node node, const SuiteResult& result) {
  unsigned failures = 0, errors = 0;
  for (const CaseResult& one : result.cases) {
    failures += one.outcome == Outcome::Differs;
    errors += one.outcome != Outcome::Differs && one.outcome != Outcome::Same;
  }
  node.append_attribute("tests").set_value(static_cast<unsigned long>(result.cases.size()));
  node.append_attribute("failures").set_value(failures);
  node.append_attribute("errors").set_value(errors);
  node.append_attribute("time").set_value(secondsText(result.seconds).c_str());
}

} // namespace

std::string comparisonJUnit(const SuiteResult& result) {
  constexpr const char* kName = "chamferd compare";
  pugi::xml_document document;
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  declaration.append_attribute("version").set_value("1.0");
  declaration.append_attribute("encoding").set_value("UTF-8");
  pugi::xml_node suites = document.append_child("testsuites");
  setAttribute(suites, "name", kName);
  setCounts(suites, result);
  pugi::xml_node suite = suites.append_child("testsuite");
  setAttribute(suite, "name", kName);
  setCounts(suite, result);
  // The schema's time stamp has no zone; readers take it as UTC.
  const bool zoned = result.started.ends_with('Z');
  setAttribute(suite, "timestamp",
               zoned ? result.started.substr(0, result.started.size() - 1) : result.started);
  for (const CaseResult& one : result.cases) {
    pugi::xml_node test = suite.append_child("testcase");
    setAttribute(test, "name", one.name);
    setAttribute(test, "classname", "chamfer.compare");
    setAttribute(test, "time", secondsText(one.seconds));
    if (one.outcome != Outcome::Same) {
      pugi::xml_node fault = test.append_child(one.outcome == Outcome::Differs ? "failure" : "error");
      setAttribute(fault, "message", one.reason);
      setAttribute(fault, "type", outcomeWord(one.outcome));
      setText(fault, detailsOf(one));
    }
    setText(test.append_child("system-out"), outputOf(one));
  }
  std::ostringstream text;
  document.save(text, "  ", pugi::format_default, pugi::encoding_utf8);
  return text.str();
}

} // namespace chamfer
