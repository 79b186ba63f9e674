#include "common/text.h"

#include <cstdlib>
#include <gmock/gmock.h>

namespace chamfer {
namespace {

TEST(Text, LowerCaseChangesAsciiLettersAlone) {
  EXPECT_EQ(lowerCase("Map_Kd.PNG \xc3\x84"), "map_kd.png \xc3\x84");
}

TEST(Text, TrimmedTakesBlanksFromTheEndsAlone) {
  EXPECT_EQ(trimmed(" \ta b\t "), "a b");
  EXPECT_EQ(trimmed(" \t"), "");
}

TEST(Text, QuotesHoldNothingThatIsNotPrintable) {
  const struct {
    std::string text, quoted;
  } kRows[] = {
      {"wood.png", R"("wood.png")"},
      {"Gr\xc3\xb6\xc3\x9f"
       "e \xe6\x9c\xa8",
       "\"Gr\xc3\xb6\xc3\x9f"
       "e \xe6\x9c\xa8\""}, // UTF-8 of two and three bytes
      {std::string("\0\x01\x1b[2J\n\x7f", 8), R"("\x00\x01\x1b[2J\x0a\x7f")"},
      {"\xff\xfe", R"("\xff\xfe")"},                         // never in UTF-8
      {"\xc0\xaf\xed\xa0\x80", R"("\xc0\xaf\xed\xa0\x80")"}, // overlong, surrogate
      {"\xc3", R"("\xc3")"},                                 // cut off
      {"\xc2\x9b"
       "31m",
       R"("\xc2\x9b31m")"}, // CSI as one character
      {"\xe2\x80\xae"
       "gnp",
       R"("\xe2\x80\xaegnp")"}, // right to left
      {"\xf0\x9f\x98\x80", "\"\xf0\x9f\x98\x80\""},
  };
  for (const auto& row : kRows)
    EXPECT_EQ(inQuotes(row.text), row.quoted);
}

TEST(Text, QuotesAreAbbreviatedByCharacters) {
  EXPECT_EQ(inQuotes("abcdef", 6), "\"abcdef\"");
  EXPECT_EQ(inQuotes("abcdef", 5), "\"abcde...\"");
  EXPECT_EQ(inQuotes("\xc3\x84\xc3\x84\xc3\x84", 2), "\"\xc3\x84\xc3\x84...\"");
  EXPECT_LT(inQuotes(std::string(100000, '\0')).size(), 200u);
}

TEST(Text, NumbersAreShort) {
  EXPECT_EQ(numberText(0.1), "0.1");
  EXPECT_EQ(numberText(1.0 / 3), "0.333333333");
  EXPECT_EQ(numberText(2.0 / 3, 3), "0.667");
  EXPECT_EQ(pointText(1, -2.5, 1e10), "(1, -2.5, 1e+10)");
  EXPECT_EQ(pointText(1.0 / 3, 0, 0, 2), "(0.33, 0, 0)");
}

TEST(Text, ExactNumbersReadBack) {
  for (const double value : {0.1, 1.0 / 3, 1e300, 5e-324, -0.25})
    EXPECT_EQ(std::strtod(exactNumberText(value).c_str(), nullptr), value);
  EXPECT_EQ(exactNumberText(1.0 / 3), "0.3333333333333333");
}

TEST(Text, LongListsSayHowManyWent) {
  std::vector<std::string> list{"a", "b", "c"};
  keepFirst(list, 3);
  EXPECT_THAT(list, testing::ElementsAre("a", "b", "c"));
  keepFirst(list, 1);
  EXPECT_THAT(list, testing::ElementsAre("a", "and 2 more"));
}

} // namespace
} // namespace chamfer
