// The grid that the albedo tables are made on (make_albedo_tables.cpp, when the program is built) and read by
// (albedo_table.cpp).
#pragma once

#include <algorithm>
#include <cmath>

namespace chamfer::albedo_grid {

inline constexpr int kCosines = 32, kRoughnesses = 32, kIndices = 24;
/// Largest relative index; the smallest is its inverse.
inline constexpr float kLargestIndex = 4;

/// Place on the grid of a direction cosine in [0, 1]: by its square root, since albedos bend most at grazing
/// angles.
inline float cosinePlace(float mu) { return std::sqrt(std::clamp(mu, 0.f, 1.f)) * (kCosines - 1); }
/// Cosine of a node; the first stands where the surface is still seen.
inline float cosineOf(int node) {
  const float t = float(node) / (kCosines - 1);
  return std::max(t * t, 1e-4f);
}

inline float roughnessPlace(float roughness) { return std::clamp(roughness, 0.f, 1.f) * (kRoughnesses - 1); }
inline float roughnessOf(int node) { return float(node) / (kRoughnesses - 1); }

/// Place of a relative index on either side of 1. (eta - 1) / (eta + 1) is but for its sign the same seen
/// from either side of a surface, and its root spreads the nodes where total reflection sets in.
inline float indexPlace(float eta) {
  constexpr float kMost = (kLargestIndex - 1) / (kLargestIndex + 1);
  return std::sqrt(std::min(std::abs(eta - 1) / (eta + 1) / kMost, 1.f)) * (kIndices - 1);
}
/// Index of a node, 1 or above.
inline float indexOf(int node) {
  constexpr float kMost = (kLargestIndex - 1) / (kLargestIndex + 1);
  const float t = float(node) / (kIndices - 1), x = kMost * t * t;
  return (1 + x) / (1 - x);
}

} // namespace chamfer::albedo_grid
