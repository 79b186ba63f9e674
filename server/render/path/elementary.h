// Elementary functions of our own, for float and for lanes of floats (wavefront/lanes.h) alike, so that one
// path gets the same bits whichever way it is shaded, and on every machine: a library may choose by
// processor. Errors are about 1e-7, absolute. The polynomials are those of S. Moshier's Cephes library (sinf,
// cosf, atanf).
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>

namespace chamfer {

/// `condition`: bool, or the mask of lanes.
template <class Condition, class T>
[[gnu::always_inline]] inline T select(const Condition& condition, const T& yes, const T& no) {
  if constexpr (std::is_same_v<Condition, bool>) {
    return condition ? yes : no;
  } else {
    T result = no;
    where(condition, result) = yes;
    return result;
  }
}

/// Of an angle within some turns of 0.
template <class F>
void sineCosine(const F& angle, F& sine, F& cosine) {
  using std::floor;
  const F quarters = floor(angle * F(2 * std::numbers::inv_pi_v<float>) + F(0.5f));
  // Off by what pi / 2 is more than its parts: nothing, for float.
  const F r = ((angle - quarters * F(1.5703125f)) - quarters * F(4.837512969970703125e-4f)) -
              quarters * F(7.549789948768648e-8f);
  const F z = r * r;
  const F s = r + r * z * (F(-1.6666654611e-1f) + z * (F(8.3321608736e-3f) + z * F(-1.9515295891e-4f)));
  const F c =
      F(1) - F(0.5f) * z +
      z * z * (F(4.166664568298827e-2f) + z * (F(-1.388731625493765e-3f) + z * F(2.443315711809948e-5f)));
  const F turns = quarters - F(4) * floor(quarters * F(0.25f)); // 0, 1, 2 or 3
  const auto odd = turns == F(1) || turns == F(3);
  const F sineSize = select(odd, c, s), cosineSize = select(odd, s, c);
  sine = select(turns >= F(2), F(-sineSize), sineSize);
  cosine = select(turns == F(1) || turns == F(2), F(-cosineSize), cosineSize);
}
inline void sineCosine(const double& angle, double& sine, double& cosine) {
  sine = std::sin(angle);
  cosine = std::cos(angle);
}

/// Of the point (x, y), not both 0: 0 to pi, y not below 0.
template <class F>
F angleOf(const F& y, const F& x) {
  using std::abs, std::max, std::min;
  constexpr float kPi4 = std::numbers::pi_v<float> / 4;
  const F across = abs(x);
  const F ratio = min(y, across) / max(y, across); // 0 to 1
  const auto large = ratio > F(0.41421356f);       // tan(pi / 8)
  const F a = select(large, (ratio - F(1)) / (ratio + F(1)), ratio);
  const F z = a * a;
  const F within =
      a + a * z *
              (F(-3.33329491539e-1f) +
               z * (F(1.99777106478e-1f) + z * (F(-1.38776856032e-1f) + z * F(8.05374449538e-2f))));
  const F eighth = select(large, F(kPi4) + within, within);
  const F quarter = select(y > across, F(2 * kPi4) - eighth, eighth);
  return select(x < F(0), F(4 * kPi4) - quarter, quarter);
}
inline double angleOf(const double& y, const double& x) { return std::atan2(y, x); }

} // namespace chamfer
