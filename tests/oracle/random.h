// Seeded random numbers that are the same with every standard library.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

namespace chamfer::oracle {

class Random {
public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform() { return double(engine_() >> 11) * 0x1p-53; } ///< [0, 1)
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  double logUniform(double low, double high) { return low * std::pow(high / low, uniform()); }
  std::size_t below(std::size_t count) { return std::size_t(uniform() * double(count)); } ///< [0, count)
  double normal() {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    return radius * std::cos(2 * std::numbers::pi * uniform());
  }
  /// Unit vector, uniform on the sphere.
  Eigen::Vector3d direction() {
    const double z = uniform(-1, 1), angle = uniform(0, 2 * std::numbers::pi), s = std::sqrt(1 - z * z);
    return {s * std::cos(angle), s * std::sin(angle), z};
  }

private:
  std::mt19937_64 engine_;
};

} // namespace chamfer::oracle
