#include "server/jobs/image/region.h"

#include "server/render/image/image_io.h"
#include "tests/support/temporary_folder.h"

#include <cmath>
#include <gmock/gmock.h>
#include <limits>
#include <numeric>

namespace chamfer {
namespace {

using test::TemporaryFolder;
using test::thrownBy;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

/// A mask of these grey levels, 8-bit; alpha 1 or as given.
std::filesystem::path writeMask(const TemporaryFolder& folder, unsigned width, std::vector<int> bytes,
                                std::vector<float> alpha = {}) {
  Image image{width, unsigned(bytes.size()) / width, {}};
  const auto linear = [](int byte) { // the middle of what the file's byte stands for
    const double v = byte / 255.;
    return float(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
  };
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    image.rgba.insert(image.rgba.end(), 3, linear(bytes[i]));
    image.rgba.push_back(alpha.empty() ? 1 : alpha[i]);
  }
  writeImage(folder.path() / "mask.png", image);
  return folder.path() / "mask.png";
}

TEST(PixelRect, IsReadFromFourNumbers) {
  EXPECT_EQ(parsePixelRect("1,2,3,4"), (TileRect{1, 2, 3, 4}));
  EXPECT_EQ(parsePixelRect("0,0,4294967295,1").width, 4294967295u);
  for (const char* bad : {"", "1,2,3", "1,2,3,", "1,2,3,4,5", "1,2,3,4 ", " 1,2,3,4", "1;2;3;4", "-1,2,3,4",
                          "+1,2,3,4", "1.5,2,3,4", "a,b,c,d", "1,,3,4", "1,2,3,4294967296"})
    EXPECT_THAT(thrownBy([&] { parsePixelRect(bad); }), StartsWith("usage: ")) << bad;
  EXPECT_THAT(thrownBy([] { parsePixelRect("1,2,0,4"); }), StartsWith("out-of-range: "));
  EXPECT_THAT(thrownBy([] { parsePixelRect("1,2,4,0"); }), StartsWith("out-of-range: "));
}

TEST(Region, IsTheWholePictureByDefault) {
  const Region r = regionOf({}, 5, 4);
  EXPECT_EQ(r.crop, (TileRect{0, 0, 5, 4}));
  EXPECT_EQ(r.pixels, 20u);
  EXPECT_THAT(r.counts, IsEmpty());
  EXPECT_EQ(r.text, "");
  const Region cropped = regionOf({TileRect{1, 2, 3, 2}, {}, {}, {}}, 5, 4);
  EXPECT_EQ(cropped.pixels, 6u);
  EXPECT_EQ(cropped.text, "") << "every pixel of the crop counts";
}

TEST(Region, RectanglesAreInTheFrame) {
  RegionChoice choice;
  choice.crop = TileRect{1, 1, 3, 2};
  choice.only = {{0, 0, 3, 2}, {3, 2, 1, 1}};
  choice.except = {{1, 1, 1, 1}};
  const Region r = regionOf(choice, 5, 4);
  EXPECT_THAT(r.counts, ElementsAre(0, 1, 0, /**/ 0, 0, 1));
  EXPECT_EQ(r.pixels, 2u);
  EXPECT_EQ(r.text, "only 0,0,3,2 3,2,1,1, except 1,1,1,1: 2 of 6 pixels");
  choice.only.clear();
  EXPECT_THAT(regionOf(choice, 5, 4).counts, ElementsAre(0, 1, 1, /**/ 1, 1, 1));
}

TEST(Region, MaskCountsAboveHalfAndIsOfTheFrame) {
  const TemporaryFolder folder;
  RegionChoice choice;
  choice.mask = writeMask(folder, 3, {0, 127, 128, 255, 254, 1});
  EXPECT_THAT(regionOf(choice, 3, 2).counts, ElementsAre(0, 0, 1, 1, 1, 0));
  choice.crop = TileRect{1, 0, 2, 2};
  const Region r = regionOf(choice, 3, 2);
  EXPECT_THAT(r.counts, ElementsAre(0, 1, 1, 0));
  EXPECT_EQ(r.pixels, 2u);
  EXPECT_THAT(r.text, AllOf(StartsWith("mask "), HasSubstr("mask.png"), HasSubstr("2 of 4 pixels")));
  choice.except = {{2, 0, 1, 1}};
  EXPECT_THAT(regionOf(choice, 3, 2).counts, ElementsAre(0, 0, 1, 0)) << "both together";
}

TEST(Region, MaskMayBeDrawnInAlphaOrInFloat) {
  const TemporaryFolder folder;
  RegionChoice choice;
  choice.mask = writeMask(folder, 3, {255, 255, 255}, {0, 1, 0.25f});
  EXPECT_THAT(regionOf(choice, 3, 1).counts, ElementsAre(0, 1, 0));
  Picture grey;
  grey.width = 3;
  grey.height = grey.channels = 1;
  grey.values = {0.5f, 0.51f, 7};
  choice.mask = folder.path() / "mask.exr";
  writePicture(choice.mask, grey);
  EXPECT_THAT(regionOf(choice, 3, 1).counts, ElementsAre(0, 1, 1));
  grey.values[1] = std::numeric_limits<float>::quiet_NaN();
  writePicture(choice.mask, grey);
  EXPECT_THAT(thrownBy([&] { regionOf(choice, 3, 1); }),
              AllOf(StartsWith("malformed: "), HasSubstr("pixel 1,0")));
}

TEST(Region, RefusesWhatLeavesNothingOrLiesBeyond) {
  const TemporaryFolder folder;
  const auto thrown = [](const RegionChoice& choice) { return thrownBy([&] { regionOf(choice, 4, 3); }); };
  for (const TileRect& r :
       {TileRect{0, 0, 5, 1}, TileRect{0, 0, 1, 4}, TileRect{4, 0, 1, 1}, TileRect{1, 0, 4294967295u, 1},
        TileRect{0, 4294967295u, 1, 1}, TileRect{0, 0, 0, 1}}) {
    RegionChoice crop, only, except;
    crop.crop = r;
    only.only = {r};
    except.except = {r};
    for (const RegionChoice* choice : {&crop, &only, &except})
      EXPECT_THAT(thrown(*choice), StartsWith("out-of-range: ")) << r.x << ' ' << r.width;
  }
  RegionChoice choice;
  choice.crop = TileRect{0, 0, 5, 1};
  EXPECT_THAT(thrown(choice), AllOf(HasSubstr("0,0,5,1"), HasSubstr("4x3")));

  choice = {};
  choice.except = {{0, 0, 4, 3}};
  EXPECT_THAT(thrown(choice), AllOf(StartsWith("out-of-range: no pixel"), HasSubstr("except 0,0,4,3")));
  choice = {};
  choice.crop = TileRect{0, 0, 1, 1};
  choice.only = {{1, 1, 1, 1}};
  EXPECT_THAT(thrown(choice), StartsWith("out-of-range: no pixel"));

  choice = {};
  choice.mask = writeMask(folder, 4, std::vector<int>(12, 0));
  EXPECT_THAT(thrown(choice), AllOf(StartsWith("out-of-range: "), HasSubstr("is empty")));
  choice.mask = writeMask(folder, 3, std::vector<int>(12, 255));
  EXPECT_THAT(thrown(choice), AllOf(StartsWith("out-of-range: "), HasSubstr("3x4"), HasSubstr("4x3")));
  choice.mask = folder.path() / "none.png";
  EXPECT_THAT(thrown(choice), StartsWith("not-found: "));
  choice.mask = folder.write("text.png", "no image");
  EXPECT_THAT(thrown(choice), StartsWith("malformed: "));
  EXPECT_THAT(thrownBy([] { regionOf({}, 0, 3); }), StartsWith("out-of-range: "));
}

TEST(Cropped, TakesVarianceAndAttributesAlong) {
  Picture p;
  p.width = 4;
  p.height = 3;
  p.channels = 3;
  p.display = true;
  p.about = {{"chamfer:scene", "x"}};
  p.values.resize(36);
  std::iota(p.values.begin(), p.values.end(), 0.f);
  p.variance = p.values;
  for (float& v : p.variance)
    v += 100;
  const Picture c = cropped(p, {2, 1, 1, 2});
  EXPECT_EQ(c.width, 1u);
  EXPECT_EQ(c.height, 2u);
  EXPECT_THAT(c.values, ElementsAre(18, 19, 20, 30, 31, 32));
  EXPECT_THAT(c.variance, ElementsAre(118, 119, 120, 130, 131, 132));
  EXPECT_TRUE(c.display);
  EXPECT_EQ(c.about, p.about);
  EXPECT_EQ(cropped(p, {0, 0, 4, 3}).values, p.values);
  EXPECT_THAT(thrownBy([&] { cropped(p, {2, 1, 3, 2}); }), StartsWith("out-of-range: "));
}

} // namespace
} // namespace chamfer
