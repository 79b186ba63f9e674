// How an instance's transform changes lengths, apart from how it turns: what a rounding radius in world units
// needs.
#pragma once

#include "common/transform.h"

#include <array>
#include <string>

namespace chamfer {

/// The symmetric, positive part S of a linear map L = R S, where R changes no length (polar decomposition).
struct Stretch {
  /// xx, yy, zz, yz, xz, xy; as multiples of 2^-30 of the largest, so that instances which differ by nothing
  /// but rounding errors of their rotations have the same.
  std::array<double, 6> entries{1, 1, 1, 0, 0, 0};

  bool operator==(const Stretch&) const = default;
  auto operator<=>(const Stretch&) const = default;
  /// Is it a plain scale? Then every rounding stays one.
  bool isUniform() const;
  double scale() const { return entries[0]; } ///< of a uniform one
  Transform transform() const;
  std::string text() const; ///< for names: "2", "8 x 0.3 x 3", or "sheared"
};

/// Throws Error(OutOfRange) where the transform squeezes some direction to less than 1e-9 of another.
Stretch stretchOf(const Transform& transform);

} // namespace chamfer
