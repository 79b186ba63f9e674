// Light from infinitely far away, by direction: one colour, a sky gradient or an image, with a table to
// sample it by.
//
// Image and table are latitude-longitude maps: v runs from `up` (0, top row) to down (1), u once around `up`,
// counter-clockwise seen from above; the centre column faces the frame's x axis, turned by the rotation.
#pragma once

#include "common/vec.h"
#include "server/render/light/distribution.h"
#include "server/render/material/texture.h"

#include <memory>
#include <optional>

namespace chamfer {

/// Radiance by height above the horizon: `horizon` at it, `zenith` straight up, `ground` below.
struct SkyGradient {
  Color zenith, horizon, ground;
};

class Environment {
public:
  static Environment constant(const Color& radiance);
  static Environment sky(const SkyGradient& gradient, const Vector3& up);
  static Environment image(std::shared_ptr<const Texture> image, float strength, double rotationDegrees,
                           const Vector3& up);

  /// Radiance that arrives from unit direction `d` (pointing away from the scene).
  Color radiance(const Vector3f& d) const;
  struct Sample {
    Vector3f direction; ///< unit
    float pdf;          ///< per solid angle; 0: none
  };
  Sample sample(const Float2& u) const;
  float pdf(const Vector3f& d) const;
  /// Mean radiance over all directions, luminance.
  float meanLuminance() const { return meanLuminance_; }
  /// Largest luminance over the mean: how much sampling by the table has to gain.
  float contrast() const { return contrast_; }
  std::size_t memoryBytes() const;

private:
  explicit Environment(const Vector3& up);
  void tabulate(unsigned width, unsigned height);
  Float2 mapFromDirection(const Vector3f& local) const;

  Vector3f x_, y_, up_; ///< world axes of the map's frame
  SkyGradient gradient_;
  std::shared_ptr<const Texture> image_;
  float strength_ = 1;
  float turn_ = 0; ///< rotation as a share of a full turn
  Distribution2D table_;
  float meanLuminance_ = 0, contrast_ = 1;
};

} // namespace chamfer
