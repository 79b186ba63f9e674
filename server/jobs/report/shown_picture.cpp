#include "server/jobs/report/shown_picture.h"

#include "server/jobs/report/color_map.h"
#include "server/render/image/image_io.h"

#include <algorithm>
#include <boost/archive/iterators/base64_from_binary.hpp>
#include <boost/archive/iterators/transform_width.hpp>
#include <cmath>

namespace chamfer {
namespace {

constexpr unsigned kMostSide = 1920, kLeastSide = 480;
/// Pixels of all first pictures together: with the second ones and the heat maps about 110 MB of noisy PNG.
constexpr double kMostPixels = 16e6;

void setPixel(Image& image, std::size_t pixel, float r, float g, float b) {
  float* const p = &image.rgba[4 * pixel];
  p[0] = r, p[1] = g, p[2] = b, p[3] = 1;
}

/// encodePng() encodes: what is sRGB already must become linear first.
void setEncoded(Image& image, std::size_t pixel, const MapColor& color) {
  setPixel(image, pixel, linearFromSRgb(color[0]), linearFromSRgb(color[1]), linearFromSRgb(color[2]));
}

Image emptyImage(const Picture& picture, unsigned factor) {
  Image image;
  image.width = (picture.width + factor - 1) / factor;
  image.height = (picture.height + factor - 1) / factor;
  image.rgba.resize(4 * std::size_t(image.width) * image.height);
  return image;
}

/// Calls visit(pixel) for the picture's pixels of one of the image.
template <class Visit>
void forPixelsOf(const Picture& picture, unsigned factor, unsigned x, unsigned y, Visit&& visit) {
  const unsigned right = std::min((x + 1) * factor, picture.width),
                 bottom = std::min((y + 1) * factor, picture.height);
  for (unsigned row = y * factor; row < bottom; ++row)
    for (unsigned column = x * factor; column < right; ++column)
      visit(std::size_t(row) * picture.width + column);
}

/// Largest |a - b| of a pixel; NaN where any value is not finite.
double differenceAt(const Picture& a, const Picture& b, std::size_t pixel) {
  double largest = 0;
  for (unsigned c = 0; c < a.channels; ++c) {
    const double difference =
        std::abs(double(a.values[pixel * a.channels + c]) - double(b.values[pixel * a.channels + c]));
    if (!std::isfinite(difference)) return std::nan("");
    largest = std::max(largest, difference);
  }
  return largest;
}

float heatPosition(double difference, double largest) {
  if (difference <= 0 || largest <= 0) return 0;
  return float(1 + std::log10(difference / largest) / kHeatDecades);
}

double pixelsAt(const CaseResult& one, unsigned most) {
  const Picture& picture = one.a.mean.values.empty() ? one.b.mean : one.a.mean;
  if (picture.values.empty()) return 0;
  const double factor = reductionFor(picture.width, picture.height, most);
  return double(picture.pixels()) / (factor * factor);
}

} // namespace

unsigned reductionFor(unsigned width, unsigned height, unsigned most) {
  return std::max(1u, (std::max(width, height) + most - 1) / most);
}

ShownPicture shownPicture(const Picture& picture, unsigned factor) {
  ShownPicture shown;
  shown.factor = factor;
  shown.image = emptyImage(picture, factor);
  shown.notFinite = std::size_t(
      std::count_if(picture.values.begin(), picture.values.end(), [](float v) { return !std::isfinite(v); }));
  for (unsigned y = 0; y < shown.image.height; ++y)
    for (unsigned x = 0; x < shown.image.width; ++x) {
      double sum[3] = {0, 0, 0};
      unsigned count = 0;
      bool isFinite = true;
      forPixelsOf(picture, factor, x, y, [&](std::size_t pixel) {
        const float* const value = &picture.values[pixel * picture.channels];
        for (unsigned c = 0; c < 3; ++c) {
          const float v = value[picture.channels < 3 ? 0 : c];
          isFinite = isFinite && std::isfinite(v);
          sum[c] += double(v);
        }
        ++count;
      });
      const std::size_t pixel = std::size_t(y) * shown.image.width + x;
      if (isFinite)
        setPixel(shown.image, pixel, float(sum[0] / count), float(sum[1] / count), float(sum[2] / count));
      else
        setEncoded(shown.image, pixel, colorOf(kNotFiniteColor));
    }
  return shown;
}

HeatMap heatMapOf(const Picture& a, const Picture& b, const Region& region, unsigned factor) {
  const bool allCount = region.counts.size() != a.pixels();
  const auto counts = [&](std::size_t pixel) { return allCount || region.counts[pixel] != 0; };
  HeatMap map;
  map.picture.factor = factor;
  map.picture.image = emptyImage(a, factor);
  for (std::size_t pixel = 0; pixel < a.pixels(); ++pixel) {
    const double difference = differenceAt(a, b, pixel);
    if (!std::isfinite(difference))
      ++map.picture.notFinite;
    else if (counts(pixel))
      map.largest = std::max(map.largest, difference);
  }
  Image& image = map.picture.image;
  for (unsigned y = 0; y < image.height; ++y)
    for (unsigned x = 0; x < image.width; ++x) {
      double largest = 0, largestLeftOut = 0;
      bool isFinite = true, anyCounts = false;
      forPixelsOf(a, factor, x, y, [&](std::size_t pixel) {
        const double difference = differenceAt(a, b, pixel);
        isFinite = isFinite && std::isfinite(difference);
        anyCounts = anyCounts || counts(pixel);
        double& most = counts(pixel) ? largest : largestLeftOut;
        if (difference > most) most = difference;
      });
      MapColor color = colorOf(kNotFiniteColor);
      if (isFinite && anyCounts) {
        color = mapColor(heatPosition(largest, map.largest));
      } else if (isFinite) { // a hint of the difference on grey, which the map has not
        map.hasLeftOut = true;
        color = mapColor(heatPosition(largestLeftOut, map.largest));
        for (unsigned c = 0; c < 3; ++c)
          color[c] = 0.2f * color[c] + 0.8f * colorOf(kLeftOutColor)[c];
      }
      setEncoded(image, std::size_t(y) * image.width + x, color);
    }
  return map;
}

std::string pngUri(const Image& image) {
  using namespace boost::archive::iterators;
  using Encoder = base64_from_binary<transform_width<const char*, 6, 8>>;
  const std::vector<std::byte> png = encodePng(image);
  std::string bytes(reinterpret_cast<const char*>(png.data()), png.size());
  const std::size_t padding = (3 - bytes.size() % 3) % 3;
  bytes.append(padding, '\0'); // the encoder knows no partial groups
  std::string uri = "data:image/png;base64,";
  uri.append(Encoder(bytes.data()), Encoder(bytes.data() + bytes.size()));
  std::fill_n(uri.end() - std::ptrdiff_t(padding), padding, '=');
  return uri;
}

MostSides mostSidesFor(const SuiteResult& result) {
  MostSides sides{kMostSide, kMostSide};
  const auto pixels = [&] {
    double sum = 0;
    for (const CaseResult& one : result.cases)
      sum += pixelsAt(one, one.outcome == Outcome::Same ? sides.same : sides.other);
    return sum;
  };
  while (pixels() > kMostPixels && sides.other > kLeastSide) {
    unsigned& side = sides.same > kLeastSide ? sides.same : sides.other;
    side = std::max(kLeastSide, side * 2 / 3);
  }
  return sides;
}

} // namespace chamfer
