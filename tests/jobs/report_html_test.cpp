// The HTML report without a browser: what is in it, and its pictures, decoded.
#include "server/jobs/report/color_map.h"
#include "server/jobs/report/reports.h"
#include "server/jobs/report/shown_picture.h"
#include "server/render/image/image_io.h"

#include "server/jobs/image/picture.h"
#include "tests/jobs/report_samples.h"
#include "tests/support/temporary_folder.h"

#include <boost/archive/iterators/binary_from_base64.hpp>
#include <boost/archive/iterators/transform_width.hpp>
#include <cmath>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <regex>

namespace chamfer {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kDataBegin = "<script type=\"application/json\" id=\"data\">";

std::string dataOf(const std::string& html) {
  const std::size_t begin = html.find(kDataBegin) + std::string(kDataBegin).size();
  return html.substr(begin, html.find("</script>", begin) - begin);
}

/// Of a data URI, as linear values.
Picture decoded(const std::string& uri) {
  using namespace boost::archive::iterators;
  using Decoder = transform_width<binary_from_base64<std::string::const_iterator>, 8, 6>;
  const std::string head = "data:image/png;base64,";
  EXPECT_TRUE(uri.starts_with(head));
  std::string text = uri.substr(head.size());
  EXPECT_EQ(text.size() % 4, 0u);
  const std::size_t padding = text.ends_with("==") ? 2 : text.ends_with("=") ? 1 : 0;
  std::replace(text.end() - std::ptrdiff_t(padding), text.end(), '=', 'A');
  std::string bytes(Decoder(text.cbegin()), Decoder(text.cend()));
  bytes.resize(bytes.size() - padding);
  const test::TemporaryFolder folder;
  return readPicture(folder.write("a.png", bytes));
}

/// sRGB-encoded, 0 to 255, as a viewer sees it.
std::array<int, 3> seenAt(const Picture& picture, unsigned x, unsigned y) {
  std::array<int, 3> seen{};
  for (unsigned c = 0; c < 3; ++c) {
    const double v = double(picture.values[(std::size_t(y) * picture.width + x) * picture.channels + c]);
    seen[c] = int(std::lround(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055)));
  }
  return seen;
}

std::array<int, 3> bytesOf(const MapColor& color) {
  return {int(std::lround(255 * double(color[0]))), int(std::lround(255 * double(color[1]))),
          int(std::lround(255 * double(color[2])))};
}

Picture flat(unsigned width, unsigned height, unsigned channels, float value) {
  Picture picture;
  picture.width = width, picture.height = height, picture.channels = channels;
  picture.values.assign(picture.pixels() * channels, value);
  return picture;
}

TEST(ReportHtml, IsOneFileThatAsksForNothing) {
  const std::string html = comparisonHtml(test::makeSuite());
  const std::string frame =
      html.substr(0, html.find(kDataBegin)) + html.substr(html.find("</script>", html.find(kDataBegin)));
  EXPECT_FALSE(std::regex_search(frame, std::regex("https?:|(src|href)=\"(?!data:)|@import|url\\(")));
  EXPECT_THAT(frame, HasSubstr("default-src 'none'"));
  EXPECT_THAT(frame, HasSubstr("<title>error: 2 same, 3 differ, 1 cannot be told, 3 errors</title>"));
  EXPECT_FALSE(std::regex_search(frame, std::regex("@[A-Z]+@"))); // every place of the template is filled
}

TEST(ReportHtml, HoldsTheSameResultAsTheJson) {
  const SuiteResult suite = test::makeSuite();
  const json data = json::parse(dataOf(comparisonHtml(suite)));
  EXPECT_EQ(data["result"], json::parse(comparisonJson(suite)));
  ASSERT_EQ(data["pictures"].size(), suite.cases.size());
  EXPECT_EQ(data["pictures"][4].dump(), R"({"a":null,"b":null,"heat":null})"); // nothing was ever rendered
  EXPECT_EQ(data["pictures"][6]["heat"], nullptr);                             // of two sizes
  EXPECT_EQ(data["pictures"][6]["b"]["width"], 80);
  EXPECT_EQ(data["pictures"][5]["a"]["not_finite"], 3);
  EXPECT_EQ(data["pictures"][8]["a"]["factor"], 2);
  EXPECT_EQ(data["pictures"][8]["heat"]["width"], 1440);
  for (std::size_t i = 0; i < suite.cases.size(); ++i)
    for (const char* side : {"a", "b", "heat"}) {
      const json& shown = data["pictures"][i][side];
      if (shown.is_null() || i == 8) continue;
      const Picture picture = decoded(shown["uri"]);
      EXPECT_EQ(picture.width, shown["width"].get<unsigned>()) << i << side;
      EXPECT_EQ(picture.height, shown["height"].get<unsigned>()) << i << side;
    }
}

TEST(ReportHtml, KeepsHostileTextInItsPlace) {
  SuiteResult suite = test::makeSuite();
  suite.cases = {test::makeHostileCase()};
  suite.command = "</script><script>";
  const std::string html = comparisonHtml(suite), data = dataOf(html);
  EXPECT_EQ(data.find('<'), std::string::npos);
  EXPECT_EQ(json::parse(data)["result"], json::parse(comparisonJson(suite)));
  // The frame's own elements and no others: data, two scripts.
  std::size_t scripts = 0;
  for (std::size_t at = 0; (at = html.find("</script", at)) != std::string::npos; ++at)
    ++scripts;
  EXPECT_EQ(scripts, 3u);
  EXPECT_THAT(html, Not(HasSubstr("<img src=x")));
}

TEST(ReportHtml, ShowsPicturesOfOneThreeAndFourChannels) {
  for (const unsigned channels : {1u, 3u, 4u}) {
    Picture picture = flat(3, 2, channels, 0.5f);
    if (channels > 1) picture.values[channels] = 0.25f; // red of the second pixel
    if (channels == 4) picture.values[3] = 0;           // transparent, yet shown
    const Picture seen = decoded(pngUri(shownPicture(picture, 1).image));
    EXPECT_EQ(seenAt(seen, 0, 0), (std::array<int, 3>{188, 188, 188})) << channels;
    EXPECT_EQ(seenAt(seen, 1, 0), (std::array<int, 3>{channels > 1 ? 137 : 188, 188, 188})) << channels;
  }
}

TEST(ReportHtml, ReducesByMeansOfLight) {
  Picture picture = flat(5, 3, 3, 0);
  picture.values[0] = 2; // above what can be shown: counts whole
  const ShownPicture shown = shownPicture(picture, 2);
  EXPECT_EQ(shown.image.width, 3u);
  EXPECT_EQ(shown.image.height, 2u);
  EXPECT_FLOAT_EQ(shown.image.rgba[0], 0.5f);
  EXPECT_FLOAT_EQ(shown.image.rgba[1], 0);
  EXPECT_FLOAT_EQ(shown.image.rgba[3], 1);
  EXPECT_EQ(reductionFor(1920, 1080, 1920), 1u);
  EXPECT_EQ(reductionFor(1921, 1080, 1920), 2u);
  EXPECT_EQ(reductionFor(1, 9000, 1920), 5u);
}

TEST(ReportHtml, HeatMapIsLogarithmicAndKeepsTheLargest) {
  const Picture b = flat(4, 4, 3, 0.25f);
  Picture a = b;
  const auto set = [&](unsigned x, unsigned y, unsigned c, float by) { a.values[(y * 4 + x) * 3 + c] += by; };
  set(0, 0, 2, -0.5f); // the largest, in one channel, downwards
  set(1, 0, 0, 0.05f);
  set(2, 0, 1, 0.5e-6f);
  const HeatMap map = heatMapOf(a, b, {}, 1);
  EXPECT_FLOAT_EQ(float(map.largest), 0.5f);
  EXPECT_FALSE(map.hasLeftOut);
  const Picture seen = decoded(pngUri(map.picture.image));
  EXPECT_EQ(seenAt(seen, 0, 0), bytesOf(mapColor(1)));
  const auto tenth = seenAt(seen, 1, 0), wanted = bytesOf(mapColor(2.f / 3));
  for (unsigned c = 0; c < 3; ++c)
    EXPECT_NEAR(tenth[c], wanted[c], 1);
  EXPECT_EQ(seenAt(seen, 2, 0), bytesOf(mapColor(0))); // below the scale
  EXPECT_EQ(seenAt(seen, 3, 3), bytesOf(mapColor(0)));
  // One pixel must not vanish among sixteen.
  const Picture reduced = decoded(pngUri(heatMapOf(a, b, {}, 4).picture.image));
  EXPECT_EQ(reduced.pixels(), 1u);
  EXPECT_EQ(seenAt(reduced, 0, 0), bytesOf(mapColor(1)));
}

TEST(ReportHtml, HeatMapDimsWhatDoesNotCount) {
  const Picture b = flat(4, 1, 1, 0);
  Picture a = b;
  a.values = {8, 1, 0, std::nanf("")};
  Region region;
  region.crop = {0, 0, 4, 1};
  region.counts = {0, 1, 0, 1};
  region.pixels = 2;
  const HeatMap map = heatMapOf(a, b, region, 1);
  EXPECT_EQ(map.largest, 1); // not the 8 that is left out
  EXPECT_TRUE(map.hasLeftOut);
  EXPECT_EQ(map.picture.notFinite, 1u);
  const Picture seen = decoded(pngUri(map.picture.image));
  EXPECT_EQ(seenAt(seen, 1, 0), bytesOf(mapColor(1)));
  EXPECT_EQ(seenAt(seen, 3, 0), bytesOf(colorOf(kNotFiniteColor)));
  for (const unsigned x : {0u, 2u}) { // near grey
    const auto color = seenAt(seen, x, 0);
    for (unsigned c = 0; c < 3; ++c)
      EXPECT_NEAR(color[c], 128, 28) << x;
  }
  EXPECT_EQ(heatMapOf(b, b, {}, 1).largest, 0);
}

TEST(ReportHtml, LargeSuitesShrinkWhatIsTheSameFirst) {
  SuiteResult suite;
  CaseResult one;
  one.a.mean = flat(1920, 1080, 1, 0);
  one.b.mean = one.a.mean;
  one.outcome = Outcome::Same;
  suite.cases = {one, one};
  EXPECT_EQ(mostSidesFor(suite).same, 1920u);
  suite.cases.assign(50, one);
  suite.cases[0].outcome = Outcome::Differs;
  const MostSides sides = mostSidesFor(suite);
  EXPECT_EQ(sides.other, 1920u);
  EXPECT_LT(sides.same, 1000u);
  EXPECT_GE(sides.same, 480u);
}

/// CIE lightness of an sRGB colour.
double lightnessOf(const MapColor& color) {
  const double y = 0.2126 * double(linearFromSRgb(color[0])) + 0.7152 * double(linearFromSRgb(color[1])) +
                   0.0722 * double(linearFromSRgb(color[2]));
  return y > 0.008856 ? 116 * std::cbrt(y) - 16 : 903.3 * y;
}

TEST(ReportColorMap, GetsLighterInEvenSteps) {
  for (int i = 0; i < 16; ++i) {
    const double step = lightnessOf(mapColor(float(i + 1) / 16)) - lightnessOf(mapColor(float(i) / 16));
    EXPECT_NEAR(step, 98.0 / 16, 2.5) << i;
  }
  EXPECT_EQ(mapColor(-1), mapColor(0));
  EXPECT_EQ(mapColor(2), mapColor(1));
  EXPECT_THAT(mapGradient(), testing::StartsWith("#000004 0%, #1d1147 12.5%, "));
  EXPECT_THAT(mapGradient(), testing::EndsWith(", #fcfdbf 100%"));
}

} // namespace
} // namespace chamfer
