// Chi-squared test of direction samplers on the sphere.
#pragma once

#include "server/render/path/warp.h"
#include "tests/render/chi_squared.h"

#include <optional>

namespace chamfer::test {

/// Independent uniform numbers in [0, 1) for judging samplers: no stratification that would flatter them.
class UniformNumbers {
public:
  explicit UniformNumbers(std::uint64_t seed) : state_(seed) {}
  float operator()() { return float(mixBits(state_ += 0x9e3779b97f4a7c15ull) >> 40) * 0x1p-24f; }
  Float2 pair() {
    const float x = (*this)();
    return {x, (*this)()};
  }
  /// Uniform on the sphere.
  Vector3f direction() {
    const float z = 2 * (*this)() - 1, phi = 2 * kPi * (*this)(), s = std::sqrt(std::max(0.f, 1 - z * z));
    return {s * std::cos(phi), s * std::sin(phi), z};
  }

private:
  std::uint64_t state_;
};

/// `sample` gives a unit direction or nothing (a sample that ends the path); `pdf` is its density per solid
/// angle. Cells divide cosine and azimuth about z.
template <class Sample, class Pdf>
ChiSquaredResult directionChiSquared(Sample&& sample, Pdf&& pdf, int samples = 200000, int cosines = 24,
                                     int azimuths = 24, int quadrature = 24) {
  std::vector<double> observed(std::size_t(cosines * azimuths) + 1), expected(observed.size());
  UniformNumbers random(7);
  for (int i = 0; i < samples; ++i) {
    const std::optional<Vector3f> d = sample(random);
    if (!d) {
      ++observed.back();
      continue;
    }
    const int c = std::min(int((d->z + 1) / 2 * float(cosines)), cosines - 1);
    double phi = std::atan2(d->y, d->x) / (2 * std::numbers::pi);
    if (phi < 0) phi += 1;
    ++observed[std::size_t(c * azimuths + std::min(int(phi * azimuths), azimuths - 1))];
  }
  double sum = 0;
  for (int c = 0; c < cosines; ++c)
    for (int a = 0; a < azimuths; ++a) {
      const double share = integrate(
          [&](double z, double phi) {
            const double s = std::sqrt(std::max(0.0, 1 - z * z));
            return double(pdf(Vector3f(float(s * std::cos(phi)), float(s * std::sin(phi)), float(z))));
          },
          -1 + 2.0 * c / cosines, -1 + 2.0 * (c + 1) / cosines, 2 * std::numbers::pi * a / azimuths,
          2 * std::numbers::pi * (a + 1) / azimuths, quadrature);
      expected[std::size_t(c * azimuths + a)] = share * samples;
      sum += share;
    }
  expected.back() = std::max(0.0, 1 - sum) * samples;
  if (expected.back() < 1e-9 * samples && observed.back() == 0) {
    observed.pop_back();
    expected.pop_back();
  }
  return chiSquared(observed, expected);
}

} // namespace chamfer::test
