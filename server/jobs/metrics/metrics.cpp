#include "server/jobs/metrics/metrics.h"

#include "common/error.h"
#include "common/text.h"
#include "server/jobs/metrics/flip.h"

#include <array>
#include <cmath>
#include <limits>

namespace chamfer {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr MetricRow kRows[] = {
    {Metric::Mae, "mae", "", false, kInfinity, "mean of the absolute differences"},
    {Metric::Rmse, "rmse", "", false, kInfinity, "root of the mean squared difference"},
    {Metric::RelMse, "relmse", "", false, kInfinity,
     "mean of the squared differences over the squared reference plus 0.01"},
    {Metric::Psnr, "psnr", "dB", true, kInfinity, "peak signal-to-noise ratio of linear values, peak 1"},
    {Metric::MaxError, "max_error", "", false, kInfinity, "largest absolute difference of any value"},
    {Metric::BiasPercent, "bias_percent", "%", false, kInfinity,
     "difference of the means, relative to the reference's"},
    {Metric::FailingShare, "failing_share", "", false, 1, "share of the pixels beyond the tolerance"},
    {Metric::Flip, "flip", "", false, 1, "mean of the FLIP error map: how visible the difference is"},
};

/// The rows stand in the order of the enumeration.
constexpr bool inOrder() {
  for (std::size_t i = 0; i < std::size(kRows); ++i)
    if (std::size_t(kRows[i].metric) != i) return false;
  return true;
}
static_assert(inOrder());

std::string sizeText(const Picture& picture) {
  return std::to_string(picture.width) + "x" + std::to_string(picture.height);
}

void requireShape(const Picture& picture, const Region& region) {
  if (picture.width != region.crop.width || picture.height != region.crop.height ||
      picture.values.size() != picture.pixels() * picture.channels || picture.channels == 0 ||
      region.pixels == 0 || (!region.counts.empty() && region.counts.size() != picture.pixels()))
    throw Error(ErrorKind::Internal, "a picture that does not fit the region it is measured over");
}

void requireShape(const Picture& a, const Picture& b, const Region& region) {
  requireShape(a, region);
  requireShape(b, region);
  if (a.channels != b.channels) throw Error(ErrorKind::Internal, "pictures of other channels are measured");
}

/// Calls for every counting pixel with its number.
template <class F>
void forPixels(const Picture& picture, const Region& region, F&& f) {
  for (std::size_t i = 0; i < picture.pixels(); ++i)
    if (region.counts.empty() || region.counts[i]) f(i);
}

/// The mean of f(a, b) over the counting pixels' channels.
template <class F>
double meanOf(const Picture& a, const Picture& b, const Region& region, F&& f) {
  double sum = 0;
  forPixels(a, region, [&](std::size_t pixel) {
    for (std::size_t i = pixel * a.channels; i < (pixel + 1) * a.channels; ++i)
      sum += f(double(a.values[i]), double(b.values[i]));
  });
  return sum / (double(region.pixels) * a.channels);
}

double meanSquare(const Picture& a, const Picture& b, const Region& region) {
  return meanOf(a, b, region, [](double x, double y) { return (x - y) * (x - y); });
}

double biasPercent(const Picture& a, const Picture& b, const Region& region) {
  const double difference = meanOf(a, b, region, [](double x, double y) { return x - y; });
  if (difference == 0) return 0; // of two black pictures, too
  return 100 * difference / meanOf(a, b, region, [](double, double y) { return std::abs(y); });
}

double failingShare(const Picture& a, const Picture& b, const Region& region,
                    const PixelTolerance& tolerance) {
  std::size_t failing = 0;
  forPixels(a, region, [&](std::size_t pixel) {
    bool fails = false;
    for (std::size_t i = pixel * a.channels; i < (pixel + 1) * a.channels; ++i) {
      const double x = double(a.values[i]), y = double(b.values[i]);
      fails = fails || std::abs(x - y) > tolerance.absolute + tolerance.relative * std::abs(y);
    }
    failing += fails;
  });
  return double(failing) / double(region.pixels);
}

double flipMean(const Picture& a, const Picture& b, const Region& region) {
  // An error map's pixel sees its neighbours: what does not count is made equal, else it would leak in.
  Picture seen = a;
  if (!region.counts.empty())
    for (std::size_t i = 0; i < seen.values.size(); ++i)
      if (!region.counts[i / seen.channels]) seen.values[i] = b.values[i];
  const std::vector<float> map = flipMap(seen, b);
  double sum = 0;
  forPixels(a, region, [&](std::size_t pixel) { sum += double(map[pixel]); });
  return sum / double(region.pixels);
}

const char* kindText(const Picture& picture) {
  return picture.display ? "made of sRGB-encoded integer pixels" : "made of linear pixels";
}

std::string channelsText(const Picture& picture) {
  switch (picture.channels) {
  case 1:
    return "1 channel (grey)";
  case 3:
    return "3 channels (RGB)";
  case 4:
    return "4 channels (RGB and alpha)";
  default:
    return std::to_string(picture.channels) + " channels";
  }
}

void requireFinite(const Picture& picture, const std::string& name) {
  const NonFinite bad = nonFiniteOf(picture);
  if (bad.count == 0) return;
  throw Error(ErrorKind::OutOfRange, name + " has " + std::to_string(bad.count) +
                                         (bad.count == 1 ? " value that is no finite number, "
                                                         : " values that are no finite numbers, the first ") +
                                         "at pixel " + std::to_string(bad.x) + "," + std::to_string(bad.y) +
                                         " (column, row from the top), channel " +
                                         std::to_string(bad.channel))
      .with("non_finite", double(bad.count));
}

} // namespace

std::span<const MetricRow> metricRows() { return kRows; }

const MetricRow& metricRow(Metric metric) { return kRows[std::size_t(metric)]; }

Metric parseMetric(std::string_view name) {
  std::string known;
  for (const MetricRow& row : kRows) {
    if (row.name == name) return row.metric;
    known += (known.empty() ? "" : ", ") + std::string(row.name);
  }
  throw Error(ErrorKind::Usage, inQuotes(name) + " is not a metric; known are " + known);
}

double metricOf(Metric metric, const Picture& a, const Picture& b, const Region& region,
                const PixelTolerance& tolerance) {
  requireShape(a, b, region);
  switch (metric) {
  case Metric::Mae:
    return meanOf(a, b, region, [](double x, double y) { return std::abs(x - y); });
  case Metric::Rmse:
    return std::sqrt(meanSquare(a, b, region));
  case Metric::RelMse:
    return meanOf(a, b, region, [](double x, double y) { return (x - y) * (x - y) / (y * y + 0.01); });
  case Metric::Psnr:
    return -10 * std::log10(meanSquare(a, b, region)); // of 0: +inf
  case Metric::MaxError:
    return largestError(a, b, region).error;
  case Metric::BiasPercent:
    return biasPercent(a, b, region);
  case Metric::FailingShare:
    return failingShare(a, b, region, tolerance);
  case Metric::Flip:
    return flipMean(a, b, region);
  }
  throw Error(ErrorKind::Internal, "a metric without a rule");
}

LargestError largestError(const Picture& a, const Picture& b, const Region& region) {
  requireShape(a, b, region);
  LargestError largest;
  largest.error = -1; // so that equal pictures have a place, too: the first that counts
  forPixels(a, region, [&](std::size_t pixel) {
    for (unsigned c = 0; c < a.channels; ++c) {
      const double x = double(a.values[pixel * a.channels + c]), y = double(b.values[pixel * a.channels + c]);
      if (std::abs(x - y) <= largest.error) continue;
      largest = {region.crop.x + unsigned(pixel % a.width),
                 region.crop.y + unsigned(pixel / a.width),
                 c,
                 x,
                 y,
                 std::abs(x - y)};
    }
  });
  return largest;
}

void requireComparable(const Picture& a, const Picture& b, const std::string& aName,
                       const std::string& bName) {
  const auto differ = [&](const std::string& ofA, const std::string& ofB, const std::string& fix) {
    throw Error(ErrorKind::OutOfRange, aName + " and " + bName + " cannot be compared: " + aName + " is " +
                                           ofA + ", " + bName + " is " + ofB + fix);
  };
  for (const auto& [picture, name] : {std::pair(&a, &aName), std::pair(&b, &bName)}) {
    if (picture->pixels() == 0 || picture->channels == 0)
      throw Error(ErrorKind::OutOfRange, *name + " has no pixels");
    if (picture->values.size() != picture->pixels() * picture->channels ||
        (!picture->variance.empty() && picture->variance.size() != picture->values.size()))
      throw Error(ErrorKind::Internal, *name + ": values do not fill width, height and channels");
  }
  if (a.width != b.width || a.height != b.height) differ(sizeText(a), sizeText(b), "");
  if (a.channels != b.channels) differ("of " + channelsText(a), "of " + channelsText(b), "");
  if (a.display != b.display) differ(kindText(a), kindText(b), "; make both PNG or both EXR");
  requireFinite(a, aName);
  requireFinite(b, bName);
}

} // namespace chamfer
