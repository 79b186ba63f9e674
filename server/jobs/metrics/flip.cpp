#include "server/jobs/metrics/flip.h"

#include "common/error.h"
#include "common/text.h"
#include "server/jobs/metrics/flip_ldr.h"

#include <algorithm>
#include <cmath>

namespace chamfer {
namespace {

std::vector<double> luminances(const Picture& picture) {
  std::vector<double> result;
  result.reserve(picture.pixels());
  const auto light = [](float v) { return v > 0 ? double(v) : 0; };
  for (std::size_t i = 0; i < picture.values.size(); i += picture.channels) {
    const float* v = picture.values.data() + i;
    result.push_back(picture.channels < 3
                         ? light(v[0])
                         : 0.2126 * light(v[0]) + 0.7152 * light(v[1]) + 0.0722 * light(v[2]));
  }
  return result;
}

/// From the one that shows the brightest pixel at the tone curve's shoulder to the one that does so with the
/// median, at steps of at most about a stop. A picture more than half black has its median among what is not;
/// none where all of it is.
std::vector<double> exposuresFor(const Picture& picture) {
  std::vector<double> light = luminances(picture);
  const auto median = [&] {
    const auto middle = light.begin() + std::ptrdiff_t(light.size() / 2);
    std::nth_element(light.begin(), middle, light.end());
    return *middle;
  };
  double half = median();
  if (half == 0) {
    std::erase(light, 0.);
    if (light.empty()) return {};
    half = median();
  }
  const double start = std::log2(toneCurveShoulder() / *std::max_element(light.begin(), light.end()));
  const double stop = std::log2(toneCurveShoulder() / half);
  if (start == stop) return {start};
  const auto count = std::size_t(std::max(2., std::ceil(stop - start)));
  std::vector<double> exposures;
  for (std::size_t i = 0; i < count; ++i)
    exposures.push_back(start + double(i) * (stop - start) / double(count - 1));
  return exposures;
}

} // namespace

std::vector<float> flipMap(const Picture& a, const Picture& b, double pixelsPerDegree) {
  const auto fills = [](const Picture& p) {
    return (p.channels == 1 || p.channels == 3 || p.channels == 4) &&
           p.values.size() == p.pixels() * p.channels && !p.values.empty();
  };
  if (a.width != b.width || a.height != b.height || a.channels != b.channels || a.display != b.display ||
      !fills(a) || !fills(b))
    throw Error(ErrorKind::Internal, "FLIP of pictures of other shapes or kinds");
  if (!(pixelsPerDegree >= 1 && pixelsPerDegree <= 1000))
    throw Error(ErrorKind::OutOfRange,
                numberText(pixelsPerDegree) + " pixels per degree: FLIP is computed for 1 to 1000 of them");
  std::vector<float> map(a.pixels(), 0.f);
  if (a.display) {
    raiseToLdrFlip(Shown(a, {}), Shown(b, {}), pixelsPerDegree, map);
    return map;
  }
  std::vector<double> exposures = exposuresFor(b);
  if (exposures.empty()) exposures = exposuresFor(a); // black asks for none: what lights up decides
  for (double exposure : exposures)
    raiseToLdrFlip(Shown(a, exposure), Shown(b, exposure), pixelsPerDegree, map);
  return map;
}

} // namespace chamfer
