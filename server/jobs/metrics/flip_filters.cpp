#include "server/jobs/metrics/flip_filters.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

namespace chamfer {
namespace {

constexpr double kPi = std::numbers::pi;
/// Gaussians of the contrast sensitivity functions (HPG 2020, table 1): amplitude and width.
constexpr double kAchromaticWidth = 0.0047, kRedGreenWidth = 0.0053;
constexpr double kBlueYellow[2][2] = {{34.1, 0.04}, {13.5, 0.025}};
constexpr double kFeatureWidth = 0.082; ///< degrees

/// Weights too small for a float's sum are left out.
FlipFilter trimmed(const std::vector<double>& weights) {
  const double most = std::abs(*std::max_element(
      weights.begin(), weights.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }));
  std::size_t cut = 0;
  while (cut < weights.size() / 2 && std::abs(weights[cut]) < 1e-9 * most)
    ++cut;
  return {{weights.begin() + std::ptrdiff_t(cut), weights.end() - std::ptrdiff_t(cut)}};
}

template <class F>
std::vector<double> sampled(int radius, F&& f) {
  std::vector<double> result;
  for (int x = -radius; x <= radius; ++x)
    result.push_back(f(double(x)));
  return result;
}

double sumOf(const std::vector<double>& weights) {
  double sum = 0;
  for (double w : weights)
    sum += w;
  return sum;
}

std::vector<double> scaled(std::vector<double> weights, double factor) {
  for (double& w : weights)
    w *= factor;
  return weights;
}

/// Positive weights sum to 1, negative ones to -1.
std::vector<double> balanced(std::vector<double> weights) {
  double positive = 0, negative = 0;
  for (double w : weights)
    (w > 0 ? positive : negative) += std::abs(w);
  for (double& w : weights)
    w /= w > 0 ? positive : negative;
  return weights;
}

// Explicit vectors: the dev build's optimiser makes none of such loops.
using Lanes [[gnu::vector_size(32)]] = float;
static_assert(kFlipLanes == 4 * sizeof(Lanes) / sizeof(float));
inline Lanes lanesAt(const float* from) {
  Lanes v;
  std::memcpy(&v, from, sizeof v);
  return v;
}

} // namespace

FlipFilters::FlipFilters(double pixelsPerDegree) {
  const int spatial = int(std::ceil(3 * std::sqrt(kBlueYellow[0][1] / (2 * kPi * kPi)) * pixelsPerDegree));
  const auto gaussian = [&](double width) {
    return sampled(spatial, [&](double x) {
      const double degrees = x / pixelsPerDegree;
      return std::exp(-kPi * kPi * degrees * degrees / width);
    });
  };
  const auto normalised = [](const std::vector<double>& w) { return trimmed(scaled(w, 1 / sumOf(w))); };
  achromatic = normalised(gaussian(kAchromaticWidth));
  redGreen = normalised(gaussian(kRedGreenWidth));
  // Amplitudes belong to the two-dimensional kernels: half of each, as a root, goes to either direction.
  std::vector<double> parts[2];
  double sum = 0;
  for (int i = 0; i < 2; ++i) {
    const auto [amplitude, width] = kBlueYellow[i];
    parts[i] = scaled(gaussian(width), std::sqrt(amplitude * std::sqrt(kPi / width)));
    sum += sumOf(parts[i]) * sumOf(parts[i]);
  }
  for (int i = 0; i < 2; ++i)
    blueYellow[i] = trimmed(scaled(parts[i], 1 / std::sqrt(sum)));

  const double deviation = kFeatureWidth / 2 * pixelsPerDegree;
  const int feature = int(std::ceil(3 * deviation));
  const auto bell = [&](double x) { return std::exp(-x * x / (2 * deviation * deviation)); };
  gauss = normalised(sampled(feature, bell));
  first = trimmed(balanced(sampled(feature, [&](double x) { return -x * bell(x); })));
  second = trimmed(
      balanced(sampled(feature, [&](double x) { return (x * x / (deviation * deviation) - 1) * bell(x); })));
  for (const FlipFilter* f :
       {&achromatic, &redGreen, &blueYellow[0], &blueYellow[1], &gauss, &first, &second})
    radius = std::max(radius, f->radius());
}

void weightedSum(const float* const* rows, const FlipFilter& filter, float* to, std::size_t count) {
  for (std::size_t i = 0; i < count; i += kFlipLanes) {
    Lanes s0{}, s1{}, s2{}, s3{}; // an array would live in memory
    for (std::size_t k = 0; k < filter.weights.size(); ++k) {
      const float* v = rows[k] + i;
      const float w = filter.weights[k];
      s0 += w * lanesAt(v);
      s1 += w * lanesAt(v + 8);
      s2 += w * lanesAt(v + 16);
      s3 += w * lanesAt(v + 24);
    }
    std::memcpy(to + i, &s0, sizeof s0);
    std::memcpy(to + i + 8, &s1, sizeof s1);
    std::memcpy(to + i + 16, &s2, sizeof s2);
    std::memcpy(to + i + 24, &s3, sizeof s3);
  }
}

} // namespace chamfer
