#include "server/jobs/image/picture.h"

#include "common/atomic_file.h"
#include "common/error.h"
#include "common/text.h"
#include "server/render/image/image_io.h"

#include <cmath>

namespace chamfer {
namespace {

constexpr std::string_view kVariance = "variance.", kOurs = "chamfer:";

using Names = std::vector<std::string>;

[[noreturn]] void fail(const std::string& file, const std::string& why) {
  throw Error(ErrorKind::Malformed, fileInQuotes(file) + ": " + why);
}

std::string listText(const Names& names) {
  constexpr std::size_t kMost = 24;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i)
    text += (i ? ", " : "") + printable(names[i], 60);
  return names.size() > kMost ? text + " and " + std::to_string(names.size() - kMost) + " more" : text;
}

/// The components that a picture can have, and where they are in the file's list of channels.
struct Components {
  std::optional<std::size_t> r, g, b, y, a;
  bool chroma = false; ///< RY, BY: then Y alone is not the picture

  bool isColor() const { return r && g && b; }
  bool isPicture() const { return isColor() || (y && !chroma); }
  /// In the picture's order.
  std::vector<std::size_t> places() const {
    std::vector<std::size_t> result = isColor() ? std::vector{*r, *g, *b} : std::vector{*y};
    if (a) result.push_back(*a);
    return result;
  }
};

/// By layer: what stands before the last point of a channel's name; without one: "".
std::map<std::string, Components> layersOf(const Names& names) {
  std::map<std::string, Components> layers;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].starts_with(kVariance)) continue;
    const std::size_t point = names[i].rfind('.');
    Components& layer = layers[point == std::string::npos ? "" : names[i].substr(0, point)];
    const std::string component = lowerCase(names[i].substr(point + 1)); // npos + 1 is 0
    const auto take = [&](std::optional<std::size_t>& place) {
      if (!place) place = i;
    };
    if (component == "r") take(layer.r);
    if (component == "g") take(layer.g);
    if (component == "b") take(layer.b);
    if (component == "y") take(layer.y);
    if (component == "a") take(layer.a);
    if (component == "ry" || component == "by") layer.chroma = true;
  }
  return layers;
}

/// The places of the picture's channels.
std::vector<std::size_t> colorPlaces(const Names& names, const std::string& file) {
  const auto layers = layersOf(names);
  if (const auto top = layers.find(""); top != layers.end() && top->second.isPicture())
    return top->second.places();
  const Components* only = nullptr;
  for (const auto& [name, layer] : layers) {
    if (!layer.isPicture()) continue;
    if (only)
      fail(file, "has several layers that may be meant; keep one, or name its channels R, G, B. Channels: " +
                     listText(names));
    only = &layer;
  }
  if (only) return only->places();
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (!names[i].starts_with(kVariance)) others.push_back(i);
  if (others.size() == 1) return others; // a picture of one channel is grey, whatever its name
  fail(file, "has no channels R, G and B and no channel Y. Channels: " + listText(names));
}

/// "R" of "ViewLayer.Combined.R".
std::string componentOf(const std::string& name) { return name.substr(name.rfind('.') + 1); }

/// The picture's channels, then those of their variance, if there is one.
std::vector<std::size_t> placesOf(const Names& names, const std::string& file) {
  std::vector<std::size_t> places = colorPlaces(names, file);
  std::size_t variances = 0;
  for (const std::string& name : names)
    variances += name.starts_with(kVariance);
  if (variances == 0) return places;
  const std::size_t channels = places.size();
  for (std::size_t k = 0; k < channels; ++k) {
    const std::string wanted = std::string(kVariance) + componentOf(names[places[k]]);
    std::size_t at = 0;
    while (at < names.size() && names[at] != wanted)
      ++at;
    if (at == names.size())
      fail(file, "has a variance of some channels only: there is no " + printable(wanted) +
                     ". Channels: " + listText(names));
    places.push_back(at);
  }
  if (variances != channels)
    fail(file, "has a variance of channels that its picture has not. Channels: " + listText(names));
  return places;
}

void refuseNegative(const Picture& picture, const std::string& file) {
  for (std::size_t i = 0; i < picture.variance.size(); ++i)
    if (std::isfinite(picture.variance[i]) && picture.variance[i] < 0) {
      const std::size_t pixel = i / picture.channels;
      fail(file, "has a negative variance, " + numberText(double(picture.variance[i]), 6) + " at pixel " +
                     std::to_string(pixel % picture.width) + "," + std::to_string(pixel / picture.width) +
                     " (column, row from the top), channel " + std::to_string(i % picture.channels));
    }
}

/// Channels first .. first+count-1 of every pixel; two of them are grey and alpha, which becomes RGBA.
std::vector<float> planesOf(const ChannelImage& image, std::size_t first, std::size_t count) {
  const std::size_t stride = image.names.size();
  std::vector<float> result;
  result.reserve(std::size_t(image.width) * image.height * (count == 2 ? 4 : count));
  for (const float* v = image.values.data() + first; v < image.values.data() + image.values.size();
       v += stride) {
    if (count == 2) result.insert(result.end(), 2, v[0]);
    result.insert(result.end(), v, v + count);
  }
  return result;
}

} // namespace

NonFinite nonFiniteOf(const Picture& picture) {
  NonFinite result;
  std::size_t first = picture.values.size();
  for (const std::vector<float>* numbers : {&picture.values, &picture.variance})
    for (std::size_t i = 0; i < numbers->size(); ++i)
      if (!std::isfinite((*numbers)[i])) {
        first = std::min(first, i);
        ++result.count;
      }
  if (result.count == 0) return result;
  result.channel = unsigned(first % picture.channels);
  result.x = unsigned(first / picture.channels % picture.width);
  result.y = unsigned(first / picture.channels / picture.width);
  return result;
}

Picture readPicture(const std::filesystem::path& file) {
  const std::string name = file.string();
  std::size_t channels = 0;
  const ChannelImage image = readChannels(file, name, [&](const Names& names) {
    channels = colorPlaces(names, name).size();
    return placesOf(names, name);
  });
  Picture picture;
  picture.width = image.width;
  picture.height = image.height;
  picture.channels = channels == 2 ? 4 : unsigned(channels);
  picture.display = image.fromSRgb;
  picture.values = planesOf(image, 0, channels);
  if (image.names.size() > channels) {
    if (image.fromSRgb) fail(name, "has a variance beside sRGB-encoded pixels, which is not defined");
    picture.variance = planesOf(image, channels, channels);
    refuseNegative(picture, name);
  }
  for (const auto& [key, text] : image.attributes)
    if (key.starts_with(kOurs)) picture.about.emplace(key, text);
  return picture;
}

void writePicture(const std::filesystem::path& file, const Picture& picture) {
  const bool grey = picture.channels == 1;
  if (!grey && picture.channels != 3 && picture.channels != 4)
    throw Error(ErrorKind::Internal, "a picture of " + std::to_string(picture.channels) + " channels");
  if (picture.values.size() != picture.pixels() * picture.channels ||
      (!picture.variance.empty() && picture.variance.size() != picture.values.size()))
    throw Error(ErrorKind::Internal, "a picture's values do not fill its width, height and channels");
  ChannelImage image{picture.width, picture.height, {}, {}, false, {}};
  for (unsigned c = 0; c < picture.channels; ++c)
    image.names.emplace_back(1, grey ? 'Y' : "RGBA"[c]);
  if (picture.variance.empty()) {
    image.values = picture.values;
  } else {
    for (unsigned c = 0; c < picture.channels; ++c)
      image.names.push_back(std::string(kVariance) + image.names[c]);
    for (std::size_t i = 0; i < picture.values.size(); i += picture.channels)
      for (const std::vector<float>* numbers : {&picture.values, &picture.variance})
        image.values.insert(image.values.end(), numbers->begin() + std::ptrdiff_t(i),
                            numbers->begin() + std::ptrdiff_t(i + picture.channels));
  }
  for (const auto& [key, text] : picture.about)
    if (key.starts_with(kOurs)) image.attributes.emplace(key, text);
  writeAtomically(file, encodeExr(image));
}

} // namespace chamfer
