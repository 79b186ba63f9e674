#include "server/jobs/image/picture.h"

#include "server/jobs/metrics/metrics.h"
#include "server/render/image/image_io.h"
#include "tests/jobs/picture_of.h"
#include "tests/support/temporary_folder.h"

#include <cmath>
#include <gmock/gmock.h>
#include <limits>

namespace chamfer {
namespace {

namespace fs = std::filesystem;
using test::pictureOf;
using test::TemporaryFolder;
using test::thrownBy;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();

std::string textOf(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string contentOf(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// One pixel whose channels of these names hold 1, 2, 3 ...
Picture readChannelsNamed(const TemporaryFolder& folder, const std::vector<std::string>& names) {
  ChannelImage image{1, 1, names, {}, false, {}};
  for (std::size_t i = 0; i < names.size(); ++i)
    image.values.push_back(float(i + 1));
  return readPicture(folder.write("channels.exr", textOf(encodeExr(image))));
}

TEST(ReadPicture, IntegerPixelsAreDisplayAndDecoded) {
  const TemporaryFolder folder;
  writeImage(folder.path() / "a.png", {2, 1, {0.18f, 1, 0, 0.25f, 0, 0.5f, 1, 1}});
  const Picture p = readPicture(folder.path() / "a.png");
  EXPECT_TRUE(p.display);
  EXPECT_EQ(p.width, 2u);
  EXPECT_EQ(p.height, 1u);
  ASSERT_EQ(p.channels, 4u);
  EXPECT_NEAR(p.values[0], 0.18, 2e-3);
  EXPECT_EQ(p.values[1], 1);
  EXPECT_NEAR(p.values[3], 64 / 255., 1e-6) << "alpha is not encoded";
  EXPECT_NEAR(p.values[5], 0.5, 3e-3);
  EXPECT_THAT(p.variance, IsEmpty());
}

TEST(ReadPicture, FloatPixelsAreLinearAndAsTheyAre) {
  const TemporaryFolder folder;
  writeImage(folder.path() / "a.exr", {2, 1, {-1, 1e20f, kNaN, 1, kInf, -kInf, 0, 0.5f}});
  const Picture p = readPicture(folder.path() / "a.exr");
  EXPECT_FALSE(p.display);
  ASSERT_EQ(p.channels, 4u);
  EXPECT_EQ(p.values[0], -1);
  EXPECT_EQ(p.values[1], 1e20f);
  EXPECT_TRUE(std::isnan(p.values[2]));
  EXPECT_EQ(p.values[4], kInf);
  EXPECT_EQ(p.values[5], -kInf);
  EXPECT_EQ(nonFiniteOf(p).count, 3u);
}

TEST(ReadPicture, ReadsRadianceFiles) {
  const TemporaryFolder folder;
  std::string text = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n";
  for (int byte : {128, 64, 0, 129, 128, 128, 128, 136})
    text += char(byte);
  const Picture p = readPicture(folder.write("a.hdr", text));
  EXPECT_FALSE(p.display);
  EXPECT_EQ(p.channels, 3u);
  EXPECT_THAT(p.values, ElementsAre(1, 0.5f, 0, 128, 128, 128));
}

TEST(ReadPicture, TakesChannelsByName) {
  const TemporaryFolder folder;
  EXPECT_THAT(readChannelsNamed(folder, {"B", "A", "G", "R"}).values, ElementsAre(4, 3, 1, 2));
  EXPECT_THAT(readChannelsNamed(folder, {"r", "g", "b"}).values, ElementsAre(1, 2, 3));
  EXPECT_THAT(readChannelsNamed(folder, {"Y"}).values, ElementsAre(1));
  EXPECT_THAT(readChannelsNamed(folder, {"Z"}).values, ElementsAre(1)) << "one channel is grey";
  const Picture greyAlpha = readChannelsNamed(folder, {"Y", "A"});
  EXPECT_EQ(greyAlpha.channels, 4u);
  EXPECT_THAT(greyAlpha.values, ElementsAre(1, 1, 1, 2));
}

TEST(ReadPicture, LeavesOtherChannelsOut) {
  const TemporaryFolder folder;
  EXPECT_THAT(
      readChannelsNamed(folder, {"Z", "R", "G", "B", "normal.X", "normal.Y", "light.R", "light.G", "light.B"})
          .values,
      ElementsAre(2, 3, 4))
      << "what stands outside of layers is meant";
}

TEST(ReadPicture, TakesTheOnlyLayerThatHasColours) {
  const TemporaryFolder folder;
  const Picture p =
      readChannelsNamed(folder, {"ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B",
                                 "ViewLayer.Combined.A", "ViewLayer.Depth.Z", "ViewLayer.Mist.V"});
  EXPECT_THAT(p.values, ElementsAre(1, 2, 3, 4));
}

TEST(ReadPicture, RefusesSeveralLayersAndNoneAndListsTheChannels) {
  const TemporaryFolder folder;
  const auto thrown = [&](const std::vector<std::string>& names) {
    return thrownBy([&] { readChannelsNamed(folder, names); });
  };
  EXPECT_THAT(
      thrown({"a.R", "a.G", "a.B", "b.R", "b.G", "b.B"}),
      AllOf(StartsWith("malformed: "), HasSubstr("several layers"), HasSubstr("a.R"), HasSubstr("b.B")));
  EXPECT_THAT(thrown({"R", "G"}), AllOf(StartsWith("malformed: "), HasSubstr("Channels: R, G")));
  EXPECT_THAT(thrown({"U", "V"}), AllOf(StartsWith("malformed: "), HasSubstr("Channels: U, V")));
  EXPECT_THAT(thrown({"Y", "RY", "BY"}), StartsWith("malformed: ")) << "its colour would be lost";
  std::vector<std::string> many;
  for (int i = 100; i < 200; ++i)
    many.push_back("c" + std::to_string(i));
  EXPECT_THAT(thrown(many), HasSubstr("and 76 more"));
}

TEST(ReadPicture, RefusesWhatIsNotOne) {
  const TemporaryFolder folder;
  const auto thrown = [&](const fs::path& file) { return thrownBy([&] { readPicture(file); }); };
  EXPECT_THAT(thrown(folder.path() / "none.exr"), StartsWith("not-found: "));
  EXPECT_THAT(thrown(folder.write("text.png", "not an image")), StartsWith("malformed: "));
  EXPECT_THAT(thrown(folder.write("empty.exr", "")), StartsWith("malformed: "));
  EXPECT_THAT(thrown(folder.path()), StartsWith("malformed: ")) << "a folder";
  writePicture(folder.path() / "whole.exr", pictureOf(64, 64, 3, std::vector<float>(64 * 64 * 3, 0.5f)));
  const std::string whole = contentOf(folder.path() / "whole.exr");
  const std::string said = thrown(folder.write("cut.exr", whole.substr(0, whole.size() - 40)));
  EXPECT_THAT(said, AllOf(StartsWith("malformed: "), HasSubstr("cut.exr"), HasSubstr("is damaged")));
}

TEST(Variance, StandsBesideThePictureAndComesBack) {
  const TemporaryFolder folder;
  for (unsigned channels : {1u, 3u, 4u}) {
    Picture p = pictureOf(3, 2, channels, {});
    for (unsigned i = 0; i < 6 * channels; ++i) {
      p.values.push_back(float(i) * 0.7f - 3);
      p.variance.push_back(float(i) * 1e-6f);
    }
    p.values[5] = kInf;
    p.about = {{"chamfer:scene", "a1b2 \"c\""}, {"chamfer:version", "0.1.0"}};
    writePicture(folder.path() / "a.exr", p);
    const Picture read = readPicture(folder.path() / "a.exr");
    EXPECT_EQ(read.channels, channels);
    EXPECT_EQ(read.width, 3u);
    EXPECT_EQ(read.values, p.values);
    EXPECT_EQ(read.variance, p.variance);
    EXPECT_EQ(read.about, p.about);
    EXPECT_FALSE(read.display);
  }
}

TEST(Variance, OfGreyWithAlphaGrowsWithThePicture) {
  const TemporaryFolder folder;
  const Picture p = readChannelsNamed(folder, {"Y", "A", "variance.Y", "variance.A"});
  EXPECT_THAT(p.values, ElementsAre(1, 1, 1, 2));
  EXPECT_THAT(p.variance, ElementsAre(3, 3, 3, 4));
}

TEST(Variance, MustBeWholeAndNotNegative) {
  const TemporaryFolder folder;
  const auto thrown = [&](const std::vector<std::string>& names) {
    return thrownBy([&] { readChannelsNamed(folder, names); });
  };
  EXPECT_THAT(thrown({"R", "G", "B", "variance.R", "variance.B"}),
              AllOf(StartsWith("malformed: "), HasSubstr("there is no variance.G")));
  EXPECT_THAT(thrown({"R", "G", "B", "A", "variance.R", "variance.G", "variance.B"}),
              HasSubstr("there is no variance.A"));
  EXPECT_THAT(thrown({"R", "G", "B", "variance.R", "variance.G", "variance.B", "variance.A"}),
              AllOf(StartsWith("malformed: "), HasSubstr("channels that its picture has not")));

  Picture p = pictureOf(2, 1, 3, {1, 1, 1, 1, 1, 1});
  p.variance = {0, 0, 0, 0, -0.25f, 0};
  writePicture(folder.path() / "a.exr", p);
  EXPECT_THAT(thrownBy([&] { readPicture(folder.path() / "a.exr"); }),
              AllOf(StartsWith("malformed: "), HasSubstr("-0.25 at pixel 1,0"), HasSubstr("channel 1")));
  p.variance = {0, 0, 0, 0, kNaN, -kInf};
  writePicture(folder.path() / "a.exr", p);
  EXPECT_EQ(nonFiniteOf(readPicture(folder.path() / "a.exr")).count, 2u) << "counted, as in the values";
}

TEST(WritePicture, IsDeterministicAndKeepsOnlyOurAttributes) {
  const TemporaryFolder folder;
  Picture p = pictureOf(2, 2, 3, std::vector<float>(12, 0.5f));
  p.about = {{"chamfer:scene", "x"}, {"owner", "somebody"}};
  writePicture(folder.path() / "a.exr", p);
  writePicture(folder.path() / "b.exr", p);
  EXPECT_EQ(contentOf(folder.path() / "a.exr"), contentOf(folder.path() / "b.exr"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 2) << "nothing else is left";
  EXPECT_EQ(readPicture(folder.path() / "a.exr").about.size(), 1u);
}

TEST(WritePicture, SaysWhereItCannot) {
  const TemporaryFolder folder;
  const Picture good = pictureOf(1, 1, 1, {1});
  EXPECT_THAT(thrownBy([&] { writePicture(folder.path() / "none" / "a.exr", good); }),
              StartsWith("cannot-write: "));
  EXPECT_THAT(thrownBy([&] { writePicture(folder.path() / "a.exr", pictureOf(1, 1, 3, {1})); }),
              StartsWith("internal: "));
  EXPECT_THAT(thrownBy([&] {
                writePicture(folder.path() / "a.exr", pictureOf(1, 1, 2, {1, 1}));
              }),
              StartsWith("internal: "));
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(NonFinite, IsFoundWhereverItIs) {
  const Picture clean = pictureOf(4, 3, 3, std::vector<float>(36, 0.f));
  EXPECT_EQ(nonFiniteOf(clean).count, 0u);
  for (float bad : {kNaN, -kNaN, kInf, -kInf})
    for (unsigned i = 0; i < 36; ++i) {
      Picture p = clean;
      p.values[i] = bad;
      const NonFinite found = nonFiniteOf(p);
      ASSERT_EQ(found.count, 1u);
      ASSERT_EQ((found.y * 4 + found.x) * 3 + found.channel, i);
      Picture q = clean;
      q.variance.assign(36, 0.f);
      q.variance[i] = bad;
      ASSERT_EQ(nonFiniteOf(q).count, 1u);
      ASSERT_EQ(nonFiniteOf(q).channel, i % 3);
    }
  Picture both = clean;
  both.variance.assign(36, 0.f);
  both.values[20] = kNaN;
  both.variance[7] = kInf;
  EXPECT_EQ(nonFiniteOf(both).count, 2u);
  EXPECT_EQ(nonFiniteOf(both).x, 2u) << "the first of either";
  EXPECT_EQ(nonFiniteOf(both).y, 0u);
}

/// What idiff says is the same.
TEST(NonFinite, AllNaNIsNotBlack) {
  const TemporaryFolder folder;
  const Picture black = pictureOf(8, 8, 3, std::vector<float>(192, 0.f));
  writePicture(folder.path() / "nan.exr", pictureOf(8, 8, 3, std::vector<float>(192, kNaN)));
  const Picture nan = readPicture(folder.path() / "nan.exr");
  EXPECT_EQ(nonFiniteOf(nan).count, 192u);
  EXPECT_THAT(thrownBy([&] { requireComparable(nan, black, "A", "B"); }),
              AllOf(StartsWith("out-of-range: A has 192 values"), HasSubstr("pixel 0,0")));
  EXPECT_THAT(thrownBy([&] { requireComparable(black, nan, "A", "B"); }),
              StartsWith("out-of-range: B has 192 values"));
  EXPECT_THAT(thrownBy([&] { requireComparable(nan, nan, "A", "B"); }), Not(StartsWith("nothing")));
}

} // namespace
} // namespace chamfer
