#include "server/jobs/cli/compare_command.h"

#include "common/atomic_file.h"
#include "common/error.h"
#include "common/progress_line.h"
#include "common/text.h"
#include "server/jobs/cli/accept_references.h"
#include "server/jobs/cli/local_host.h"
#include "server/jobs/cli/scratch_folder.h"
#include "server/jobs/compare/compare_suite.h"
#include "server/jobs/report/reports.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <sstream>

namespace chamfer {
namespace {

std::string readText(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  if (!stream || !(text << stream.rdbuf()))
    throw Error(ErrorKind::NotFound, "cannot read " + fileInQuotes(file.string()));
  return text.str();
}

std::vector<CaseChoice> casesOf(const CompareCommandOptions& o) {
  if (o.suite.empty()) {
    if (o.sides.size() != 2)
      throw Error(ErrorKind::Usage, "compare takes two sides, A and B, or --suite FILE");
    if (!o.onlyCases.empty()) throw Error(ErrorKind::Usage, "--case names cases of a --suite");
    CaseChoice one = o.one;
    one.name = o.sides[0] + " against " + o.sides[1];
    one.a = parseSide(o.sides[0]);
    one.b = parseSide(o.sides[1]);
    one.wantsStatistics = o.statistics;
    checkCase(one);
    return {one};
  }
  if (!o.sides.empty()) throw Error(ErrorKind::Usage, "give two sides, or --suite FILE, not both");
  std::vector<CaseChoice> all = parseSuite(readText(o.suite), o.suite.filename().string());
  if (o.onlyCases.empty()) return all;
  std::vector<CaseChoice> chosen;
  for (const std::string& name : o.onlyCases) {
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const CaseChoice& c) { return c.name == name; });
    if (found == all.end())
      throw Error(ErrorKind::Usage, fileInQuotes(o.suite.string()) + " has no case " + inQuotes(name, 100));
    chosen.push_back(*found);
  }
  return chosen;
}

void put(const std::string& target, const std::string& text) {
  if (target == "-")
    std::fwrite(text.data(), 1, text.size(), stdout);
  else if (!target.empty())
    writeAtomically(target, std::as_bytes(std::span(text)));
}

} // namespace

std::string shellText(const std::vector<std::string>& arguments) {
  std::string text;
  for (const std::string& argument : arguments) {
    const bool plain = !argument.empty() && std::all_of(argument.begin(), argument.end(), [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
             std::string_view("-_./:,=+@%").find(c) != std::string_view::npos;
    });
    text += text.empty() ? "" : " ";
    if (plain) {
      text += argument;
      continue;
    }
    text += '\'';
    for (const char c : argument)
      text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    text += '\'';
  }
  return text;
}

int runCompareCommand(const CompareCommandOptions& o) {
  const std::vector<CaseChoice> cases = casesOf(o);
  const std::filesystem::path base = o.suite.empty() ? std::filesystem::path() : o.suite.parent_path();
  LocalHost host(base, o.root, o.threads);
  // Seeds that only one case asks for are not written: they would be read by nobody.
  std::optional<ScratchFolder> scratch;
  std::optional<SeedStore> store;
  if (!o.keep.empty())
    store.emplace(o.keep);
  else if (rendersTwice(cases)) {
    scratch.emplace();
    store.emplace(scratch->path());
  }

  SuiteControl control;
  control.each.version = o.version;
  control.each.threads = o.threads;
  control.each.store = store ? &*store : nullptr;
  control.command = o.command;
  control.commandOf = [&](const CaseChoice& c) {
    if (o.suite.empty()) return o.command;
    std::vector<std::string> words = {"chamferd", "compare", "--suite", o.suite.string(), "--case", c.name};
    if (!o.root.empty()) words.insert(words.end(), {"--root", o.root.string()});
    return shellText(words);
  };
  ProgressLine line(!o.quiet);
  control.progress = [&](std::size_t i, unsigned done, unsigned most) {
    line(printable(cases[i].name, 50).c_str(), double(done) / std::max(1u, most));
  };
  if (o.update) {
    const std::string told = acceptReferences(cases, o.suite, host, control);
    if (!o.quiet) std::fputs(told.c_str(), stdout);
    return 0;
  }
  const SuiteResult result = compareSuite(cases, host, control);
  const bool taken = o.json == "-" || o.junit == "-" || o.html == "-";
  if (!o.quiet && !taken) std::fputs(comparisonText(result).c_str(), stdout);
  if (!o.json.empty()) put(o.json, comparisonJson(result));
  if (!o.junit.empty()) put(o.junit, comparisonJUnit(result));
  if (!o.html.empty()) put(o.html, comparisonHtml(result));
  return exitStatusOf(result.outcome());
}

} // namespace chamfer
