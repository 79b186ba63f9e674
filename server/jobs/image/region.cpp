#include "server/jobs/image/region.h"

#include "common/error.h"
#include "common/text.h"

#include <algorithm>
#include <charconv>

namespace chamfer {
namespace {

std::string sizeText(unsigned width, unsigned height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

std::string rectText(const TileRect& r) {
  return std::to_string(r.x) + "," + std::to_string(r.y) + "," + std::to_string(r.width) + "," +
         std::to_string(r.height);
}

std::string rectsText(const std::vector<TileRect>& rects) {
  std::string text;
  for (const TileRect& r : rects)
    text += (text.empty() ? "" : " ") + rectText(r);
  return text;
}

[[noreturn]] void outOfRange(const std::string& why) { throw Error(ErrorKind::OutOfRange, why); }

void requireWithin(const TileRect& r, unsigned width, unsigned height, const char* what) {
  if (r.width == 0 || r.height == 0) outOfRange(std::string(what) + " " + rectText(r) + " has no pixel");
  if (std::uint64_t(r.x) + r.width > width || std::uint64_t(r.y) + r.height > height)
    outOfRange(std::string(what) + " " + rectText(r) + " (x,y,width,height) goes beyond the picture of " +
               sizeText(width, height));
}

/// Of the whole frame, 1 where the mask lets pixels count.
std::vector<std::uint8_t> readMask(const std::filesystem::path& file, unsigned width, unsigned height) {
  const std::string name = fileInQuotes(file.string());
  const Picture mask = readPicture(file);
  if (mask.width != width || mask.height != height)
    outOfRange("mask " + name + " is " + sizeText(mask.width, mask.height) + ", the pictures are " +
               sizeText(width, height));
  if (const NonFinite bad = nonFiniteOf(mask); bad.count > 0)
    throw Error(ErrorKind::Malformed, "mask " + name + ": " + std::to_string(bad.count) +
                                          " values are no finite numbers, the first at pixel " +
                                          std::to_string(bad.x) + "," + std::to_string(bad.y));
  // Half of the value as it is stored: 0.5 by the sRGB curve is 0.214 of the light.
  const float half = mask.display ? 0.21404114f : 0.5f;
  const unsigned colors = std::min(mask.channels, 3u);
  std::vector<std::uint8_t> counts(mask.pixels());
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const float* v = mask.values.data() + i * mask.channels;
    counts[i] = *std::max_element(v, v + colors) > half && (mask.channels != 4 || v[3] > 0.5f);
  }
  if (std::find(counts.begin(), counts.end(), 1) == counts.end())
    outOfRange("mask " + name + " is empty: none of its pixels is above half");
  return counts;
}

bool contains(const TileRect& r, unsigned x, unsigned y) {
  return x >= r.x && y >= r.y && x - r.x < r.width && y - r.y < r.height;
}

bool inAny(const std::vector<TileRect>& rects, unsigned x, unsigned y) {
  return std::any_of(rects.begin(), rects.end(), [&](const TileRect& r) { return contains(r, x, y); });
}

} // namespace

TileRect parsePixelRect(std::string_view text) {
  unsigned numbers[4];
  const char *at = text.data(), *end = at + text.size();
  bool good = true;
  for (int i = 0; i < 4 && good; ++i) {
    if (i > 0) good = at != end && *at++ == ',';
    const auto [next, problem] = std::from_chars(at, end, numbers[i]);
    good = good && problem == std::errc{};
    at = next;
  }
  if (!good || at != end)
    throw Error(ErrorKind::Usage, inQuotes(text) + " is not a rectangle: x,y,width,height in whole pixels, "
                                                   "as in 0,0,640,480");
  const TileRect rect{numbers[0], numbers[1], numbers[2], numbers[3]};
  if (rect.width == 0 || rect.height == 0)
    outOfRange(inQuotes(text) + " has no pixel: width and height must be 1 or more");
  return rect;
}

Region regionOf(const RegionChoice& choice, unsigned frameWidth, unsigned frameHeight) {
  if (frameWidth == 0 || frameHeight == 0) outOfRange("a picture without any pixel");
  Region region;
  region.crop = choice.crop.value_or(TileRect{0, 0, frameWidth, frameHeight});
  requireWithin(region.crop, frameWidth, frameHeight, "the crop");
  for (const TileRect& r : choice.only)
    requireWithin(r, frameWidth, frameHeight, "the rectangle of what counts,");
  for (const TileRect& r : choice.except)
    requireWithin(r, frameWidth, frameHeight, "the rectangle of what is left out,");
  region.pixels = std::size_t(region.crop.width) * region.crop.height;
  if (choice.mask.empty() && choice.only.empty() && choice.except.empty()) return region;

  std::vector<std::uint8_t> mask;
  if (!choice.mask.empty()) mask = readMask(choice.mask, frameWidth, frameHeight);
  region.counts.reserve(region.pixels);
  for (unsigned y = region.crop.y; y < region.crop.y + region.crop.height; ++y)
    for (unsigned x = region.crop.x; x < region.crop.x + region.crop.width; ++x)
      region.counts.push_back((mask.empty() || mask[std::size_t(y) * frameWidth + x]) &&
                              (choice.only.empty() || inAny(choice.only, x, y)) &&
                              !inAny(choice.except, x, y));
  const std::size_t all = region.pixels;
  region.pixels = std::size_t(std::count(region.counts.begin(), region.counts.end(), 1));
  const auto add = [&](const std::string& part) { region.text += (region.text.empty() ? "" : ", ") + part; };
  if (!choice.mask.empty()) add("mask " + fileInQuotes(choice.mask.string()));
  if (!choice.only.empty()) add("only " + rectsText(choice.only));
  if (!choice.except.empty()) add("except " + rectsText(choice.except));
  if (region.pixels == 0)
    outOfRange("no pixel of the crop " + rectText(region.crop) + " counts: " + region.text);
  region.text += ": " + std::to_string(region.pixels) + " of " + std::to_string(all) + " pixels";
  return region;
}

Picture cropped(const Picture& picture, const TileRect& crop) {
  requireWithin(crop, picture.width, picture.height, "the crop");
  Picture result;
  result.width = crop.width;
  result.height = crop.height;
  result.channels = picture.channels;
  result.display = picture.display;
  result.about = picture.about;
  const auto rowsOf = [&](const std::vector<float>& from, std::vector<float>& to) {
    if (from.empty()) return;
    to.reserve(result.pixels() * picture.channels);
    for (unsigned y = crop.y; y < crop.y + crop.height; ++y) {
      const float* row = from.data() + (std::size_t(y) * picture.width + crop.x) * picture.channels;
      to.insert(to.end(), row, row + std::size_t(crop.width) * picture.channels);
    }
  };
  rowsOf(picture.values, result.values);
  rowsOf(picture.variance, result.variance);
  return result;
}

} // namespace chamfer
