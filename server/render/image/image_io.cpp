#include "server/render/image/image_io.h"

#include "common/atomic_file.h"
#include "common/error.h"
#include "common/text.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <OpenImageIO/strutil.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <memory>

namespace chamfer {
namespace {

static_assert(std::endian::native == std::endian::little,
              "f16 tiles are copied as they are: little-endian only");

constexpr int kMaxTextureSide = 16384;

/// From here on a number rounds to more than the largest half.
constexpr float kBeyondHalf = 65520, kLargestHalf = 65504;

/// Nearest half-precision number, ties to even; beyond its range the largest, NaN stays NaN.
std::uint16_t toHalf(float value) {
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(value), sign = (bits >> 16) & 0x8000u;
  const std::uint32_t magnitude = bits & 0x7fffffffu;
  if (magnitude > 0x7f800000u) return std::uint16_t(sign | 0x7e00u);
  if (magnitude >= std::bit_cast<std::uint32_t>(kBeyondHalf)) return std::uint16_t(sign | 0x7bffu);
  if (magnitude < 0x38800000u) // below 2^-14: a multiple of 2^-24, rounded by the float unit
    return std::uint16_t(sign |
                         std::uint32_t(std::nearbyint(std::ldexp(std::bit_cast<float>(magnitude), 24))));
  const std::uint32_t rounded = magnitude - 0x38000000u + 0xfffu + ((magnitude >> 13) & 1u);
  return std::uint16_t(sign | (rounded >> 13));
}

float sRgbFromLinear(float v) {
  return v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f;
}

std::uint8_t toByte(float v) {
  if (!(v > 0)) return 0; // NaN too
  return std::uint8_t(std::lround(std::min(v, 1.f) * 255));
}

void checkShape(const Image& image) {
  if (image.width == 0 || image.height == 0 ||
      image.rgba.size() != std::size_t(image.width) * image.height * 4)
    throw Error(ErrorKind::Internal, "an image's values do not fill its width and height");
}

[[noreturn]] void failWriting(const char* format, const std::string& why) {
  throw Error(ErrorKind::CannotWrite, std::string("cannot encode ") + format + ": " + why);
}

/// Of float pixels, linear. Their file holds nothing of the time and place of its making.
OIIO::ImageSpec exrSpec(unsigned width, unsigned height, const std::vector<std::string>& names) {
  OIIO::ImageSpec spec(int(width), int(height), int(names.size()), OIIO::TypeDesc::FLOAT);
  spec.channelnames = names;
  const auto alpha = std::find(names.begin(), names.end(), "A");
  spec.alpha_channel = alpha == names.end() ? -1 : int(alpha - names.begin());
  spec.attribute("oiio:ColorSpace", "Linear");
  spec.attribute("compression", "zip");
  spec.attribute("DateTime", ""); // else the library writes the time of day, and no two files are the same
  return spec;
}

/// `pixels`: [height][width][channels] of the spec's type.
std::vector<std::byte> encode(const char* format, const OIIO::ImageSpec& spec, const void* pixels) {
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  const auto output = OIIO::ImageOutput::create(format, &memory);
  if (!output) failWriting(format, OIIO::geterror());
  if (!output->supports("ioproxy")) failWriting(format, "no encoding into memory");
  if (!output->open(format, spec)) failWriting(format, output->geterror());
  if (!output->write_image(spec.format, pixels)) failWriting(format, output->geterror());
  if (!output->close()) failWriting(format, output->geterror());
  std::vector<std::byte> result(bytes.size());
  std::memcpy(result.data(), bytes.data(), bytes.size());
  return result;
}

[[noreturn]] void failReading(const std::string& name, const std::string& why) {
  throw Error(ErrorKind::Malformed, fileInQuotes(name) + ": " + why);
}

/// What the library says of errors names paths of this machine: it is thrown away.
std::unique_ptr<OIIO::ImageInput> openImage(const std::filesystem::path& file, const std::string& name) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored))
    throw Error(ErrorKind::NotFound, fileInQuotes(name) + ": there is no such file");
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1); // colours as they are in the file, not times alpha
  auto input = OIIO::ImageInput::open(file.string(), &config);
  if (!input) {
    (void)OIIO::geterror();
    failReading(name, "is not an image of a known format");
  }
  const OIIO::ImageSpec& spec = input->spec();
  if (spec.width < 1 || spec.height < 1 || spec.width > kMaxTextureSide || spec.height > kMaxTextureSide)
    failReading(name, "is " + std::to_string(spec.width) + "x" + std::to_string(spec.height) +
                          ", the largest image is " + std::to_string(kMaxTextureSide) + " pixels a side");
  return input;
}

/// Channels first .. end-1, [height][width][end - first].
std::vector<float> readValues(OIIO::ImageInput& input, int first, int end, const std::string& name) {
  const OIIO::ImageSpec& spec = input.spec();
  std::vector<float> values(std::size_t(spec.width) * std::size_t(spec.height) * std::size_t(end - first));
  if (!input.read_image(0, 0, first, end, OIIO::TypeDesc::FLOAT, values.data())) {
    (void)input.geterror();
    failReading(name, "is damaged: its pixels cannot be read");
  }
  return values;
}

/// As readTexture() replaces values.
float withinLight(float v) {
  constexpr float kMostLight = 1e9f;
  if (!(v >= 0)) return 0; // NaN, too
  return std::isinf(v) ? kLargestHalf : std::min(v, kMostLight);
}

std::string colorText(const Color& c) {
  return "(" + numberText(double(c.r), 6) + ' ' + numberText(double(c.g), 6) + ' ' +
         numberText(double(c.b), 6) + ')';
}

} // namespace

float linearFromSRgb(float v) { return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f); }

std::vector<std::byte> encodeF16(const Image& image, unsigned samples) {
  checkShape(image);
  const std::uint32_t numbers[3] = {image.width, image.height, samples};
  std::vector<std::byte> bytes(16 + image.rgba.size() * 2);
  std::memcpy(bytes.data(), "CT16", 4);
  std::memcpy(bytes.data() + 4, numbers, 12);
  for (std::size_t i = 0; i < image.rgba.size(); ++i) {
    const std::uint16_t half = toHalf(image.rgba[i]);
    std::memcpy(bytes.data() + 16 + 2 * i, &half, 2);
  }
  return bytes;
}

std::size_t beyondHalf(const Image& image) {
  return std::size_t(std::count_if(image.rgba.begin(), image.rgba.end(),
                                   [](float v) { return std::abs(v) >= kBeyondHalf; }));
}

std::vector<std::byte> encodePng(const Image& image) {
  checkShape(image);
  std::vector<std::uint8_t> pixels(image.rgba.size());
  for (std::size_t i = 0; i < pixels.size(); ++i)
    pixels[i] = toByte(i % 4 == 3 ? image.rgba[i] : sRgbFromLinear(std::clamp(image.rgba[i], 0.f, 1.f)));
  OIIO::ImageSpec spec(int(image.width), int(image.height), 4, OIIO::TypeDesc::UINT8);
  spec.channelnames = {"R", "G", "B", "A"};
  spec.alpha_channel = 3;
  spec.attribute("oiio:ColorSpace", "sRGB");
  spec.attribute("oiio:UnassociatedAlpha", 1); // alpha is coverage beside the colour: nothing to divide
  spec.attribute("png:compressionLevel", 6);
  return encode("png", spec, pixels.data());
}

std::vector<std::byte> encodeExr(const Image& image) {
  checkShape(image);
  return encode("exr", exrSpec(image.width, image.height, {"R", "G", "B", "A"}), image.rgba.data());
}

std::vector<std::byte> encodeExr(const ChannelImage& image) {
  if (image.width == 0 || image.height == 0 || image.names.empty() ||
      image.values.size() != std::size_t(image.width) * image.height * image.names.size())
    throw Error(ErrorKind::Internal, "an image's values do not fill its width, height and channels");
  OIIO::ImageSpec spec = exrSpec(image.width, image.height, image.names);
  for (const auto& [key, text] : image.attributes)
    spec.attribute(key, text);
  return encode("exr", spec, image.values.data());
}

void writeImage(const std::filesystem::path& path, const Image& image) {
  const std::string extension = lowerCase(path.extension().string());
  if (extension != ".png" && extension != ".exr")
    throw Error(ErrorKind::Usage, "\"" + path.string() + "\": images are written as .png or .exr");
  const std::vector<std::byte> bytes = extension == ".png" ? encodePng(image) : encodeExr(image);
  writeAtomically(path, bytes);
}

Texture readTexture(const std::filesystem::path& file, PixelEncoding encoding, const std::string& name,
                    std::vector<std::string>& warnings) {
  const auto input = openImage(file, name);
  const OIIO::ImageSpec& spec = input->spec();
  const bool sRgb = encoding == PixelEncoding::Automatic && !spec.format.is_floating_point();
  const int channels = std::min(spec.nchannels, 3);
  const std::vector<float> values = readValues(*input, 0, channels, name);
  std::vector<Color> pixels(std::size_t(spec.width) * std::size_t(spec.height));
  std::size_t replaced = 0;
  std::string first;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const float* v = values.data() + i * std::size_t(channels);
    const auto linear = [&](float x) { return sRgb ? linearFromSRgb(x) : x; };
    pixels[i] = channels == 3 ? Color{linear(v[0]), linear(v[1]), linear(v[2])} : grey(linear(v[0]));
    const Color fit{withinLight(pixels[i].r), withinLight(pixels[i].g), withinLight(pixels[i].b)};
    if (fit == pixels[i]) continue;
    if (replaced++ == 0)
      first = "pixel " + std::to_string(i % std::size_t(spec.width)) + "," +
              std::to_string(i / std::size_t(spec.width)) + " (column, row from the top) is " +
              colorText(pixels[i]) + ", " + colorText(fit) + " is used";
    pixels[i] = fit;
  }
  if (replaced > 0)
    warnings.push_back("\"" + name + "\": " + std::to_string(replaced) +
                       (replaced == 1 ? " pixel is" : " pixels are") + " negative or not finite; " + first);
  return {unsigned(spec.width), unsigned(spec.height), std::move(pixels)};
}

std::pair<unsigned, unsigned> imageSize(const std::filesystem::path& file, const std::string& name) {
  const auto input = openImage(file, name);
  return {unsigned(input->spec().width), unsigned(input->spec().height)};
}

ChannelImage readChannels(const std::filesystem::path& file, const std::string& name,
                          const ChannelChoice& choice) {
  const auto input = openImage(file, name);
  const OIIO::ImageSpec spec = input->spec(); // a copy: looking for a second picture below changes the spec
  const auto sizeText = [](int width, int height) {
    return std::to_string(width) + "x" + std::to_string(height);
  };
  if (spec.deep || spec.depth > 1) failReading(name, "is a deep image or a volume, not a picture");
  if (spec.width != spec.full_width || spec.height != spec.full_height)
    failReading(name, "holds a part of " + sizeText(spec.width, spec.height) + " pixels of a frame of " +
                          sizeText(spec.full_width, spec.full_height) + "; write the whole frame");
  ChannelImage image{unsigned(spec.width), unsigned(spec.height), {}, {}, false, {}};
  const std::vector<std::size_t> chosen = choice(spec.channelnames);
  if (chosen.empty()) throw Error(ErrorKind::Internal, "no channel of an image was chosen");
  if (input->seek_subimage(1, 0)) failReading(name, "holds several pictures; keep one");
  (void)input->geterror();
  if (!input->seek_subimage(0, 0)) failReading(name, "is damaged: its pixels cannot be read");

  // One read of all channels between the first and the last: a reader decodes them together anyway.
  const auto [first, last] = std::minmax_element(chosen.begin(), chosen.end());
  const std::vector<float> all = readValues(*input, int(*first), int(*last) + 1, name);
  const std::size_t stride = *last - *first + 1;
  const OIIO::string_view space = spec.get_string_attribute("oiio:ColorSpace");
  image.fromSRgb = !spec.format.is_floating_point() && !OIIO::Strutil::iequals(space, "linear");
  image.values.resize(std::size_t(image.width) * image.height * chosen.size());
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    image.names.push_back(spec.channelnames[chosen[k]]);
    const bool decode = image.fromSRgb && int(chosen[k]) != spec.alpha_channel;
    const float* from = all.data() + (chosen[k] - *first);
    for (std::size_t i = k; i < image.values.size(); i += chosen.size(), from += stride)
      image.values[i] = decode ? linearFromSRgb(*from) : *from;
  }
  for (const OIIO::ParamValue& attribute : spec.extra_attribs)
    if (attribute.type() == OIIO::TypeDesc::STRING)
      image.attributes.emplace(attribute.name().string(), attribute.get_string());
  return image;
}

} // namespace chamfer
