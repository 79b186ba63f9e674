#include "server/render/request/query.h"

#include "tests/render/expect_refusal.h"

namespace chamfer {
namespace {

using test::refusalOf;

TEST(Query, DecodesEscapesAndNothingElse) {
  EXPECT_EQ(percentDecode("a%2Fb%2c%20c"), "a/b, c");
  EXPECT_EQ(percentDecode("1e+5"), "1e+5"); // a plus is a plus
  EXPECT_EQ(percentDecode("%C3%A9"), "\xC3\xA9");
  EXPECT_EQ(percentDecode(""), "");
}

TEST(Query, RefusesBrokenEscapesAndControlCharacters) {
  for (const char* text : {"%", "%4", "%zz", "a%2", "%00", "%0d%0a", "%7f", "\n"})
    EXPECT_EQ(percentDecode(text), std::nullopt) << text;
}

TEST(Query, EncodingIsReadBack) {
  const std::string all = "a b/c,d%e\"\xC3\xA9~-_.";
  EXPECT_EQ(percentDecode(percentEncode(all)), all);
  EXPECT_EQ(percentEncode("a b/c"), "a%20b/c");
  EXPECT_EQ(percentEncode("a/b", false), "a%2Fb");
}

TEST(Query, SplitsPathsBeforeDecoding) {
  EXPECT_EQ(splitPath("/"), (std::vector<std::string_view>{""}));
  EXPECT_EQ(splitPath("/v1/scenes/a%2Fb"), (std::vector<std::string_view>{"v1", "scenes", "a%2Fb"}));
  EXPECT_EQ(splitPath("/v1/scenes/"), (std::vector<std::string_view>{"v1", "scenes", ""}));
}

TEST(Query, DecodesPathsWhole) {
  const auto decoded = [](std::string_view path) { return decodePath(splitPath(path)); };
  EXPECT_EQ(decoded("/a%2Fb/c%20d"), "a/b/c d");
  EXPECT_EQ(decoded("/a/"), "a/");
  for (const char* path : {"/a/%zz", "/%00/b"})
    refusalOf([&] { decoded(path); }, 400);
}

TEST(Query, ReadsQueriesInOrder) {
  EXPECT_EQ(parseQuery(""), Query{});
  EXPECT_EQ(parseQuery("camera=1%2C2&seed="), (Query{{"camera", "1,2"}, {"seed", ""}}));
  EXPECT_EQ(parseQuery("a=b=c"), (Query{{"a", "b=c"}}));
}

TEST(Query, RefusesQueriesThatAreNoPairs) {
  for (const char* text : {"seed", "&", "seed=1&", "=1", "a=1&&b=2", "a=%", "%=1"})
    EXPECT_EQ(refusalOf([&] { parseQuery(text); }, 400).parameter(), "query") << text;
}

TEST(Query, RefusesRepeatedParametersAndNamesThem) {
  const ParameterError refused = refusalOf([] { parseQuery("seed=1&aov=beauty&se%65d=2"); }, 400);
  EXPECT_EQ(refused.parameter(), "seed");
  EXPECT_EQ(refused.value(), "2");
}

} // namespace
} // namespace chamfer
