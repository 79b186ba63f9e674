#include "preprocess/core/inradius.h"

#include "preprocess/core/linear_program.h"

#include <algorithm>

namespace chamfer {

InnerBall largestBall(std::span<const Plane> planes, double boundRadius) {
  const double scale = 1 / boundRadius;
  const auto row = [&](std::size_t i) {
    const Plane& p = planes[i];
    return LpRow<4>{{p.normal.x, p.normal.y, p.normal.z, 1}, p.offset * scale};
  };
  const auto z = maximizeLast<4>(planes.size(), row, 1.0);
  InnerBall ball{{0, 0, 0}, 0};
  if (!z) return ball;
  ball.centre = Vector3((*z)[0], (*z)[1], (*z)[2]) * boundRadius;
  ball.radius = INFINITY;
  for (const Plane& p : planes)
    ball.radius = std::min(ball.radius, p.offset - dot(p.normal, ball.centre));
  return ball;
}

} // namespace chamfer
