// JUnit XML of comparisons, read back as other programs read it.
#include "server/jobs/report/reports.h"

#include "tests/jobs/report_samples.h"

#include <gmock/gmock.h>
#include <pugixml.hpp>

namespace chamfer {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

pugi::xml_document parsed(const SuiteResult& suite) {
  pugi::xml_document document;
  const std::string text = comparisonJUnit(suite);
  const auto result = document.load_buffer(text.data(), text.size(), pugi::parse_full, pugi::encoding_utf8);
  EXPECT_TRUE(result) << result.description() << " at " << result.offset;
  return document;
}

pugi::xml_node testOf(const pugi::xml_document& document, unsigned index) {
  pugi::xml_node test = document.child("testsuites").child("testsuite").child("testcase");
  while (index-- > 0)
    test = test.next_sibling("testcase");
  return test;
}

TEST(ReportJUnit, CountsAndNames) {
  const pugi::xml_document document = parsed(test::makeSuite());
  const pugi::xml_node suites = document.child("testsuites");
  for (const pugi::xml_node node : {suites, suites.child("testsuite")}) {
    EXPECT_STREQ(node.attribute("name").value(), "chamferd compare");
    EXPECT_EQ(node.attribute("tests").as_int(), 9);
    EXPECT_EQ(node.attribute("failures").as_int(), 3);
    EXPECT_EQ(node.attribute("errors").as_int(), 4); // "cannot tell" is no pass
    EXPECT_STREQ(node.attribute("time").value(), "61.800");
  }
  EXPECT_STREQ(suites.child("testsuite").attribute("timestamp").value(), "2026-01-31T12:00:00");
  const pugi::xml_node room = testOf(document, 0);
  EXPECT_STREQ(room.attribute("name").value(), "room, radius 0.05");
  EXPECT_STREQ(room.attribute("classname").value(), "chamfer.compare");
  EXPECT_STREQ(room.attribute("time").value(), "3.710");
}

TEST(ReportJUnit, SaysWhatFailedAndHowToSeeItAgain) {
  const pugi::xml_document document = parsed(test::makeSuite());
  const pugi::xml_node room = testOf(document, 0), same = testOf(document, 1);
  const pugi::xml_node failure = room.child("failure");
  EXPECT_THAT(failure.attribute("message").value(), HasSubstr("mae is 0.0213"));
  EXPECT_STREQ(failure.attribute("type").value(), "differs");
  EXPECT_THAT(failure.text().get(),
              AllOf(HasSubstr("mae: 0.0213 ± 0.0004, at most 0.005: differs\n"),
                    HasSubstr("bias_percent: -0.62 ± 0.9 %, at most 0.5 %: cannot tell\n"),
                    Not(HasSubstr("psnr")), HasSubstr("The block at 144, 40 differs"),
                    HasSubstr("To repeat this case: chamferd compare --suite cases.json")));
  EXPECT_THAT(room.child("system-out").text().get(),
              AllOf(HasSubstr("psnr: 31.72 ± 0.05 dB, at least 30 dB: same\n"), HasSubstr("flip: 0.0417\n"),
                    HasSubstr("warning: 2 solids")));
  EXPECT_FALSE(same.child("failure"));
  EXPECT_FALSE(same.child("error"));
  EXPECT_THAT(same.child("system-out").text().get(),
              HasSubstr("Any difference above 0.3 % of an 8 x 8 block"));
  for (const unsigned index : {3u, 4u, 5u, 6u}) {
    EXPECT_TRUE(testOf(document, index).child("error")) << index;
    EXPECT_FALSE(testOf(document, index).child("failure")) << index;
  }
  EXPECT_STREQ(testOf(document, 3).child("error").attribute("type").value(), "cannot-tell");
  EXPECT_STREQ(testOf(document, 4).child("error").attribute("type").value(), "error");
}

/// Is every character one that XML 1.0 allows, none of them escaped into one that it does not?
void expectXmlCharacters(const std::string& text) {
  for (const char c : text)
    EXPECT_TRUE(static_cast<unsigned char>(c) >= 0x20 || c == '\n' || c == '\t' || c == '\r') << int(c);
  EXPECT_EQ(text.find("\xef\xbf\xbf"), std::string::npos);
  for (int code = 0; code < 32; ++code) {
    if (code == 9 || code == 10 || code == 13) continue;
    char decimal[16], padded[16], hexadecimal[16];
    std::snprintf(decimal, sizeof decimal, "&#%d;", code);
    std::snprintf(padded, sizeof padded, "&#%02d;", code);
    std::snprintf(hexadecimal, sizeof hexadecimal, "&#x%x;", unsigned(code));
    for (const char* escaped : {decimal, padded, hexadecimal})
      EXPECT_EQ(text.find(escaped), std::string::npos) << escaped;
  }
}

TEST(ReportJUnit, SurvivesHostileText) {
  SuiteResult suite = test::makeSuite();
  CaseResult hostile = test::makeHostileCase();
  hostile.seconds = std::nan("");
  suite.cases = {hostile, hostile};
  suite.cases[1].outcome = Outcome::Same;
  expectXmlCharacters(comparisonJUnit(suite));
  const pugi::xml_document document = parsed(suite);
  const pugi::xml_node test = testOf(document, 0);
  EXPECT_STREQ(test.attribute("name").value(),
               "</script><!-- \"'&]]>\xef\xbf\xbd\xef\xbf\xbd[31m \xef\xbf\xbd\xef\xbf\xbd "
               "\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd \xef\xbf\xbd @DATA@");
  EXPECT_STREQ(test.attribute("time").value(), "0.000");
  EXPECT_THAT(test.child("failure").attribute("message").value(), HasSubstr("a\nb\t\xef\xbf\xbd <b>no</b>"));
  EXPECT_THAT(test.child("system-out").text().get(), HasSubstr("warning: ]]></system-out>\xef\xbf\xbd\n"));
  EXPECT_TRUE(testOf(document, 1).child("system-out"));
  EXPECT_FALSE(testOf(document, 2));
}

TEST(ReportJUnit, OfNothingHasNoTests) {
  const pugi::xml_document document = parsed({});
  EXPECT_EQ(document.child("testsuites").attribute("tests").as_int(-1), 0);
  EXPECT_FALSE(testOf(document, 0));
}

} // namespace
} // namespace chamfer
