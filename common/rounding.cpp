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

PackedHalfEdge packHalfEdge(const HalfEdge& e) {
  return {std::uint16_t(e.sphere), std::uint16_t(e.twin), std::uint16_t(e.facet)};
}

WideHalfEdge packWideHalfEdge(const HalfEdge& e) {
  WideHalfEdge w{};
  const std::uint32_t numbers[3] = {e.sphere, e.twin, e.facet};
  for (int k = 0; k < 9; ++k)
    w.bytes[k] = std::uint8_t(numbers[k / 3] >> 8 * (k % 3));
  return w;
}

} // namespace chamfer
