#include "server/jobs/compare/compare_suite.h"

#include <chrono>
#include <ctime>

namespace chamfer {
namespace {

std::string utcNow() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

} // namespace

SuiteResult compareSuite(const std::vector<CaseChoice>& cases, CompareHost& host,
                         const SuiteControl& control) {
  const auto begin = std::chrono::steady_clock::now();
  SuiteResult result;
  result.program = "chamferd " + control.each.version;
  result.command = control.command;
  result.started = utcNow();
  for (std::size_t i = 0; i < cases.size(); ++i) {
    CompareControl each = control.each;
    if (control.progress)
      each.progress = [&control, i](unsigned done, unsigned most) { control.progress(i, done, most); };
    CaseResult one = compareCase(cases[i], host, each);
    if (control.commandOf) one.command = control.commandOf(cases[i]);
    if (control.finished) control.finished(i, one);
    result.cases.push_back(std::move(one));
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

} // namespace chamfer
