#include "common/rounding.h"

#include <algorithm>

namespace chamfer {

SphereRecord encodeSphere(const Vector3& centre, double quantum) {
  Vector3 snapped;
  for (std::size_t k = 0; k < 3; ++k)
    snapped[k] =
        std::nearbyint(centre[k] / quantum) * quantum + 0.0; // no minus zero: equal centres, equal bytes
  SphereRecord s{toFloat3(snapped), {}};
  const Vector3 left = snapped - Vector3(s.near);
  for (std::size_t k = 0; k < 3; ++k)
    s.rest[k] = std::int16_t(std::clamp(std::nearbyint(left[k] / quantum), -32767.0, 32767.0));
  return s;
}

} // namespace chamfer
