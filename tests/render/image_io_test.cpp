#include "server/render/image/image_io.h"

#include "tests/render/scene_files_fixture.h"

#include <OpenImageIO/imageio.h>
#include <chrono>
#include <cstring>
#include <fstream>
#include <gmock/gmock.h>
#include <thread>

namespace chamfer {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;
using testing::HasSubstr;

Image testImage() {
  Image image{5, 3, {}};
  for (unsigned i = 0; i < 15; ++i)
    image.rgba.insert(image.rgba.end(),
                      {float(i) / 14, 0.18f, i == 7 ? 100.f : 1e-3f * float(i), float(i % 2)});
  return image;
}

void writeBytes(const fs::path& path, const std::vector<std::byte>& bytes) {
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
}

std::vector<float> decode(const fs::path& path, int& width, int& height) {
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);
  const auto in = OIIO::ImageInput::open(path.string(), &config);
  if (!in) return {};
  width = in->spec().width;
  height = in->spec().height;
  EXPECT_EQ(in->spec().nchannels, 4);
  std::vector<float> values(std::size_t(width) * std::size_t(height) * 4);
  EXPECT_TRUE(in->read_image(0, 0, 0, 4, OIIO::TypeDesc::FLOAT, values.data()));
  return values;
}

/// Decodes by the definition of binary16.
double fromHalf(std::uint16_t h) {
  const int exponent = (h >> 10) & 31, mantissa = h & 1023;
  const double sign = h & 0x8000 ? -1 : 1;
  if (exponent == 31) return mantissa ? NAN : sign * INFINITY;
  if (exponent == 0) return sign * std::ldexp(mantissa, -24);
  return sign * std::ldexp(1024 + mantissa, exponent - 25);
}

double throughF16(float value) {
  Image image{1, 1, {value, 0, 0, 1}};
  const auto bytes = encodeF16(image, 1);
  std::uint16_t h;
  std::memcpy(&h, bytes.data() + 16, 2);
  return fromHalf(h);
}

TEST(F16, HeaderAndLayoutAreAsDocumented) {
  const auto bytes = encodeF16(testImage(), 42);
  ASSERT_EQ(bytes.size(), 16u + 5 * 3 * 4 * 2);
  EXPECT_EQ(std::memcmp(bytes.data(), "CT16\5\0\0\0\3\0\0\0\x2a\0\0\0", 16), 0);
  std::uint16_t last;
  std::memcpy(&last, bytes.data() + bytes.size() - 8, 2);
  EXPECT_EQ(fromHalf(last), 1); // red of the lower right pixel
}

TEST(F16, RoundsToNearestEvenOverTheWholeRange) {
  // Every half is itself; halfway between two goes to the even one, just beyond it to the nearer.
  for (unsigned h = 0; h < 0x7c00; ++h) {
    const double a = fromHalf(std::uint16_t(h)), b = h < 0x7bff ? fromHalf(std::uint16_t(h + 1)) : 65536;
    ASSERT_EQ(throughF16(float(a)), a) << h;
    const double even = h % 2 && h < 0x7bff ? b : a;
    const auto middle = float((a + b) / 2);
    ASSERT_EQ(throughF16(middle), even) << h;
    ASSERT_EQ(throughF16(std::nextafter(middle, 0.f)), a) << h;
    ASSERT_EQ(throughF16(-float(a)), -a) << h;
  }
  EXPECT_EQ(throughF16(65504), 65504);
  EXPECT_EQ(throughF16(1e30f), 65504) << "a finite number stays one";
  EXPECT_EQ(throughF16(-INFINITY), -65504);
  EXPECT_TRUE(std::isnan(throughF16(NAN)));
  EXPECT_EQ(beyondHalf({2, 1, {65504, 65519, 65520, 1, -1e9f, INFINITY, 0, 1}}), 3u);
}

TEST(Png, IsSRgbAndDeterministic) {
  const TemporaryFolder folder;
  const auto bytes = encodePng(testImage());
  EXPECT_EQ(bytes, encodePng(testImage()));
  writeBytes(folder.path() / "a.png", bytes);
  int width = 0, height = 0;
  const auto values = decode(folder.path() / "a.png", width, height);
  ASSERT_EQ(width, 5);
  ASSERT_EQ(height, 3);
  EXPECT_EQ(std::lround(values[1] * 255), 118) << "middle grey, 18 % linear";
  EXPECT_EQ(std::lround(values[14 * 4] * 255), 255);
  EXPECT_EQ(std::lround(values[7 * 4 + 2] * 255), 255) << "clamped";
  EXPECT_EQ(std::lround(values[1 * 4 + 3] * 255), 255) << "alpha";
  EXPECT_EQ(values[2 * 4 + 3], 0) << "alpha";
  EXPECT_EQ(std::lround(values[2 * 4 + 1] * 255), 118) << "colour is not multiplied by alpha";
}

TEST(Png, NaNIsBlack) {
  const TemporaryFolder folder;
  writeImage(folder.path() / "a.png", {1, 1, {NAN, INFINITY, -1, 1}});
  int width, height;
  const auto values = decode(folder.path() / "a.png", width, height);
  EXPECT_EQ(values[0], 0);
  EXPECT_EQ(values[1], 1);
  EXPECT_EQ(values[2], 0);
}

TEST(Exr, BytesDoNotDependOnTheTimeOfDay) {
  const auto before = encodeExr(testImage());
  std::this_thread::sleep_for(std::chrono::milliseconds(1100)); // the library's dates have whole seconds
  EXPECT_EQ(encodeExr(testImage()), before);
}

TEST(Exr, KeepsEveryBit) {
  const TemporaryFolder folder;
  const Image image = testImage();
  writeImage(folder.path() / "a.exr", image);
  int width, height;
  EXPECT_EQ(decode(folder.path() / "a.exr", width, height), image.rgba);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1) << "nothing else is left";
}

TEST(WriteImage, RefusesOtherFormatsAndPlacesThatAreNot) {
  const TemporaryFolder folder;
  EXPECT_THAT(test::thrownBy([&] { writeImage(folder.path() / "a.gif", testImage()); }),
              testing::StartsWith("usage: "));
  EXPECT_THAT(test::thrownBy([&] { writeImage(folder.path() / "none" / "a.png", testImage()); }),
              testing::StartsWith("cannot-write: "));
  EXPECT_THAT(test::thrownBy([&] {
                encodePng(Image{2, 2, std::vector<float>(4)});
              }),
              HasSubstr("do not fill"));
}

TEST(ReadTexture, DecodesByTheKindOfItsPixels) {
  const TemporaryFolder folder;
  const Image image{2, 2, {0.18f, 0.5f, 0, 1, 1, 0, 0, 1, 0, 1, 0, 1, 0, 0, 1, 1}};
  writeImage(folder.path() / "a.png", image);
  writeImage(folder.path() / "a.exr", image);
  std::vector<std::string> warnings;
  const Texture png = readTexture(folder.path() / "a.png", PixelEncoding::Automatic, "a.png", warnings);
  EXPECT_NEAR(png.pixel(0, 0).r, 0.18, 2e-3);
  EXPECT_EQ(png.pixel(1, 0), (Color{1, 0, 0}));
  EXPECT_EQ(png.pixel(0, 1), (Color{0, 1, 0}));
  const Texture raw = readTexture(folder.path() / "a.png", PixelEncoding::Linear, "a.png", warnings);
  EXPECT_NEAR(raw.pixel(0, 0).r, 118 / 255.0, 1e-6);
  EXPECT_EQ(readTexture(folder.path() / "a.exr", PixelEncoding::Automatic, "a", warnings).pixel(0, 0).r,
            0.18f);
  EXPECT_THAT(warnings, testing::IsEmpty());
  EXPECT_FALSE(png.contentDigest() == raw.contentDigest());
  // v runs up, and the image repeats.
  EXPECT_EQ(png.at(0.75f, 0.75f), (Color{1, 0, 0}));
  EXPECT_EQ(png.at(-0.25f, 3.75f), (Color{1, 0, 0}));
  EXPECT_NEAR(png.at(0.5f, 0.25f).g, 0.5, 1e-6) << "between two pixels";
}

TEST(ReadTexture, ReplacesWhatIsNoLightAndNamesTheFirst) {
  const TemporaryFolder folder;
  const auto read = [&](const Image& image, std::vector<std::string>& warnings) {
    writeImage(folder.path() / "a.exr", image);
    return readTexture(folder.path() / "a.exr", PixelEncoding::Automatic, "a.exr", warnings);
  };
  std::vector<std::string> warnings;
  const Texture t =
      read({2, 2, {0, 0, 0, 1, -0.5f, 2, 0.25f, 1, INFINITY, 1, 1e20f, 1, NAN, 1, 1, 1}}, warnings);
  EXPECT_EQ(t.pixel(0, 0), (Color{0, 0, 0}));
  EXPECT_EQ(t.pixel(1, 0), (Color{0, 2, 0.25f}));
  EXPECT_EQ(t.pixel(0, 1), (Color{65504, 1, 1e9f}));
  EXPECT_EQ(t.pixel(1, 1), (Color{0, 1, 1}));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_THAT(warnings[0], testing::StartsWith("\"a.exr\": 3 pixels are negative or not finite"));
  EXPECT_THAT(warnings[0],
              HasSubstr("pixel 1,0 (column, row from the top) is (-0.5 2 0.25), (0 2 0.25) is used"));
  warnings.clear();
  read({1, 1, {50000, 0, 1e8f, 1}}, warnings);
  EXPECT_THAT(warnings, testing::IsEmpty()) << "a bright sun is light";
}

TEST(ReadTexture, RefusesWhatIsNotAnImage) {
  const TemporaryFolder folder;
  folder.write("text.png", "not an image");
  std::vector<std::string> warnings;
  const auto thrown = [&](const char* name) {
    return test::thrownBy(
        [&] { readTexture(folder.path() / name, PixelEncoding::Automatic, name, warnings); });
  };
  EXPECT_THAT(thrown("text.png"), testing::StartsWith("malformed: \"text.png\""));
  EXPECT_THAT(thrown("none.png"), testing::StartsWith("not-found: "));
  const auto bytes = encodeExr(testImage());
  writeBytes(folder.path() / "cut.exr", {bytes.begin(), bytes.begin() + std::ptrdiff_t(bytes.size() - 60)});
  EXPECT_THAT(thrown("cut.exr"), testing::StartsWith("malformed: \"cut.exr\""));
}

/// Writes pictures of one spec into one file; what a file says of its colours is in the spec.
void writeWith(const fs::path& path, const std::vector<OIIO::ImageSpec>& specs,
               const std::vector<float>& values) {
  const auto out = OIIO::ImageOutput::create(path.string());
  ASSERT_TRUE(out && out->open(path.string(), int(specs.size()), specs.data())) << OIIO::geterror();
  for (std::size_t i = 0; i < specs.size(); ++i) {
    if (i > 0) {
      ASSERT_TRUE(out->open(path.string(), specs[i], OIIO::ImageOutput::AppendSubimage));
    }
    ASSERT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, values.data()));
  }
  ASSERT_TRUE(out->close());
}

ChannelImage allChannels(const fs::path& path) {
  return readChannels(path, path.filename().string(), [](const std::vector<std::string>& names) {
    std::vector<std::size_t> all(names.size());
    for (std::size_t i = 0; i < all.size(); ++i)
      all[i] = i;
    return all;
  });
}

TEST(ReadChannels, IntegerPixelsAreSRgbUnlessTheFileSaysLinear) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "a.png";
  for (const OIIO::TypeDesc type : {OIIO::TypeDesc::UINT8, OIIO::TypeDesc::UINT16}) {
    OIIO::ImageSpec spec(1, 1, 2, type);
    spec.channelnames = {"Y", "A"};
    spec.alpha_channel = 1;
    spec.attribute("oiio:UnassociatedAlpha", 1);
    writeWith(path, {spec}, {0.5f, 0.5f});
    const ChannelImage sRgb = allChannels(path);
    EXPECT_TRUE(sRgb.fromSRgb);
    EXPECT_THAT(sRgb.names, testing::ElementsAre("Y", "A"));
    EXPECT_NEAR(sRgb.values[0], 0.21404, 3e-3);
    EXPECT_NEAR(sRgb.values[1], 0.5, 3e-3) << "alpha is not encoded";
    spec.attribute("oiio:ColorSpace", "Linear");
    writeWith(path, {spec}, {0.5f, 0.5f});
    const ChannelImage linear = allChannels(path);
    EXPECT_FALSE(linear.fromSRgb);
    EXPECT_NEAR(linear.values[0], 0.5, 3e-3);
  }
}

TEST(ReadChannels, TakesWhatIsChosenInThatOrder) {
  const TemporaryFolder folder;
  ChannelImage image{2, 1, {"R", "G", "B", "Z"}, {1, 2, 3, 4, 5, 6, NAN, 8}, false, {{"chamfer:a", "text"}}};
  writeBytes(folder.path() / "a.exr", encodeExr(image));
  std::vector<std::string> offered;
  const ChannelImage read =
      readChannels(folder.path() / "a.exr", "a.exr", [&](const std::vector<std::string>& names) {
        offered = names;
        return std::vector<std::size_t>{3, 1};
      });
  EXPECT_THAT(offered, testing::ElementsAre("R", "G", "B", "Z"));
  EXPECT_THAT(read.names, testing::ElementsAre("Z", "G"));
  EXPECT_THAT(read.values, testing::ElementsAre(4, 2, 8, 6));
  EXPECT_EQ(read.attributes.at("chamfer:a"), "text");
  EXPECT_FALSE(read.fromSRgb);
  EXPECT_TRUE(std::isnan(allChannels(folder.path() / "a.exr").values[6])) << "as it is";
  image.values.pop_back();
  EXPECT_THAT(test::thrownBy([&] { encodeExr(image); }), testing::StartsWith("internal: "));
}

TEST(ReadChannels, RefusesSeveralPicturesAndPartsOfOne) {
  const TemporaryFolder folder;
  const auto thrown = [](const fs::path& path) { return test::thrownBy([&] { allChannels(path); }); };
  OIIO::ImageSpec spec(2, 2, 3, OIIO::TypeDesc::FLOAT), other = spec;
  spec.attribute("oiio:subimagename", "left");
  other.attribute("oiio:subimagename", "right");
  writeWith(folder.path() / "two.exr", {spec, other}, std::vector<float>(12, 1));
  EXPECT_THAT(thrown(folder.path() / "two.exr"),
              testing::AllOf(testing::StartsWith("malformed: "), HasSubstr("several pictures")));
  OIIO::ImageSpec part(2, 2, 3, OIIO::TypeDesc::FLOAT);
  part.x = 1;
  part.full_width = 8;
  part.full_height = 4;
  writeWith(folder.path() / "part.exr", {part}, std::vector<float>(12, 1));
  EXPECT_THAT(thrown(folder.path() / "part.exr"),
              testing::AllOf(testing::StartsWith("malformed: "), HasSubstr("2x2"), HasSubstr("8x4")));
  writeWith(folder.path() / "one.exr", {OIIO::ImageSpec(2, 2, 3, OIIO::TypeDesc::FLOAT)},
            std::vector<float>(12, 1));
  EXPECT_EQ(allChannels(folder.path() / "one.exr").values.size(), 12u);
}

} // namespace
} // namespace chamfer
