// What a terminal shows of comparisons, and the words that all reports share.
#include "server/jobs/compare/words.h"
#include "server/jobs/report/reports.h"

#include "tests/jobs/report_samples.h"

#include <algorithm>
#include <gmock/gmock.h>
#include <sstream>

namespace chamfer {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::vector<std::string> linesOf(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);)
    lines.push_back(line);
  return lines;
}

std::string textOf(const CaseResult& one) {
  SuiteResult suite;
  suite.cases = {one};
  return comparisonText(suite);
}

TEST(ReportText, IsShortAlignedAndEndsWithTheVerdict) {
  for (const CaseResult& one : test::makeSuite().cases) {
    SCOPED_TRACE(one.name);
    const auto lines = linesOf(textOf(one));
    EXPECT_LE(lines.size(), 12u);
    EXPECT_EQ(lines.front(), one.name);
    EXPECT_TRUE(lines.back().starts_with("  verdict      " + outcomeText(one.outcome) + ": "))
        << lines.back();
    for (std::size_t i = 1; i < lines.size(); ++i)
      EXPECT_EQ(lines[i].find_last_of(' ', 15), 14u) << lines[i];
  }
}

TEST(ReportText, HasTheNumbersBesideTheirLimits) {
  const auto lines = linesOf(textOf(test::makeSuite().cases[0]));
  const auto with = [&](const std::string& begin) {
    const auto line =
        std::find_if(lines.begin(), lines.end(), [&](const auto& l) { return l.starts_with(begin); });
    return line == lines.end() ? "none" : *line;
  };
  EXPECT_EQ(with("  mae"), "  mae          0.0213 ± 0.0004      at most 0.005      differs");
  EXPECT_EQ(with("  psnr"), "  psnr         31.72 ± 0.05 dB      at least 30 dB     same");
  EXPECT_THAT(with("  a "), HasSubstr("rounding analytic, radius 0.05, 8 seeds of 64 samples"));
  EXPECT_THAT(with("  statistics"), HasSubstr("The block at 144, 40 differs (G: 0.5231 against 0.4987)"));
  EXPECT_EQ(with("  repeat"), "none"); // the user has just typed it
}

TEST(ReportText, OfManyCasesEndsWithTheirCounts) {
  const SuiteResult suite = test::makeSuite();
  const auto lines = linesOf(comparisonText(suite));
  EXPECT_EQ(lines.back(), "2 same, 3 differ, 1 cannot be told, 3 errors in 61.8 s: error");
  EXPECT_THAT(comparisonText(suite),
              HasSubstr("  repeat       chamferd compare room.scene.json references/none.exr\n"));
  EXPECT_EQ(comparisonText({}), "no cases in 0 s: error\n");
}

TEST(ReportText, StaysShortWithManyLimitsAndWarnings) {
  CaseResult one = test::makeCase("many", 32, 32, 3);
  one.metrics.clear();
  for (const MetricRow& row : metricRows())
    one.metrics.push_back({row.metric, 0.5, std::nullopt, 0.25, Outcome::Differs});
  one.warnings.assign(40, "a warning");
  const std::string text = textOf(one);
  EXPECT_LE(linesOf(text).size(), 14u);
  EXPECT_THAT(text, HasSubstr("and 38 more"));
  for (const MetricRow& row : metricRows())
    EXPECT_THAT(text, HasSubstr(std::string(row.name)));
}

TEST(ReportText, DoesNotCommandATerminal) {
  const std::string text = textOf(test::makeHostileCase());
  for (const char c : text)
    EXPECT_TRUE(static_cast<unsigned char>(c) >= 0x20 || c == '\n') << int(c);
  EXPECT_THAT(text, AllOf(HasSubstr("\\x1b[31m"), Not(HasSubstr("\xe2\x80\xae"))));
  EXPECT_EQ(text.find("\xff"), std::string::npos);
}

TEST(ReportWords, LevelsSayWhatWouldHaveBeenSeen) {
  LevelResult level;
  level.block = 8;
  level.seenFrom = 0.003, level.boundedBy = 0.0042, level.resolution = 0.005;
  level.outcome = Outcome::Same;
  EXPECT_EQ(levelText(level, 3),
            "Any difference above 0.3 % of an 8 x 8 block would have been seen; every true one is "
            "below 0.42 %.");
  level.outcome = Outcome::CannotTell;
  level.block = 16;
  level.boundedBy = 0.0131;
  EXPECT_EQ(levelText(level, 3),
            "Any difference above 0.3 % of a 16 x 16 block would have been seen, but a true one "
            "may be as large as 1.31 %, and \"same\" asks for less than 0.5 %.");
  level.outcome = Outcome::Differs;
  level.worst = {12, 34, 1, 1};
  level.block = 1;
  level.a = 0.5, level.b = 0.25, level.pValue = 1e-9;
  EXPECT_EQ(levelText(level, 1),
            "The pixel at 12, 34 differs (grey: 0.5 against 0.25): noise alone does so with a "
            "probability of at most 1e-09.");
  level.block = 0;
  EXPECT_THAT(levelText(level, 3), testing::StartsWith("The whole picture's mean differs (R: "));
}

TEST(ReportWords, Metrics) {
  EXPECT_EQ(metricLimitText({Metric::Psnr, 0, std::nullopt, 40.0, Outcome::Same}), "at least 40 dB");
  EXPECT_EQ(metricLimitText({Metric::Mae, 0, std::nullopt, std::nullopt, Outcome::Same}), "");
  EXPECT_EQ(metricValueText({Metric::BiasPercent, -0.123456, 0.0456, 1.0, Outcome::Same}),
            "-0.1235 ± 0.046 %");
  EXPECT_EQ(metricValueText({Metric::Psnr, HUGE_VAL, std::nullopt, std::nullopt, Outcome::Same}), "inf dB");
}

} // namespace
} // namespace chamfer
