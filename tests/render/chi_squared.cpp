#include "tests/render/chi_squared.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

namespace chamfer::test {

std::string ChiSquaredResult::text() const {
  std::ostringstream s;
  s << "p = " << pValue << " over " << cells << " cells";
  return s.str();
}

double chiSquaredTail(double statistic, double degrees) {
  // Upper regularised incomplete gamma function Q(a, x) by its series or continued fraction.
  const double a = degrees / 2, x = statistic / 2;
  if (x <= 0) return 1;
  const double scale = std::exp(a * std::log(x) - x - std::lgamma(a));
  if (x < a + 1) {
    double term = 1 / a, sum = term;
    for (int n = 1; n < 10000 && term > sum * 1e-16; ++n)
      sum += term *= x / (a + n);
    return 1 - sum * scale;
  }
  double b = x + 1 - a, c = 1e300, d = 1 / b, h = d;
  for (int n = 1; n < 10000; ++n) {
    const double an = -n * (n - a);
    b += 2;
    d = 1 / (an * d + b);
    c = b + an / c;
    h *= d * c;
    if (std::abs(d * c - 1) < 1e-15) break;
  }
  return scale * h;
}

ChiSquaredResult chiSquared(const std::vector<double>& observed, const std::vector<double>& expected) {
  std::vector<std::size_t> order(expected.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::sort(order.begin(), order.end(),
            [&](std::size_t i, std::size_t j) { return expected[i] < expected[j]; });
  double statistic = 0, poolObserved = 0, poolExpected = 0;
  std::size_t cells = 0;
  const auto add = [&](double o, double e) {
    statistic += (o - e) * (o - e) / e;
    ++cells;
  };
  for (const std::size_t i : order) {
    if (expected[i] == 0 && observed[i] > 0) return {0, 1}; // where nothing can be, something is
    if (expected[i] < 5 || (poolExpected > 0 && poolExpected < 5)) {
      poolObserved += observed[i];
      poolExpected += expected[i];
    } else {
      add(observed[i], expected[i]);
    }
  }
  if (poolExpected > 0) add(poolObserved, poolExpected);
  if (cells < 2) return {0, cells};
  return {chiSquaredTail(statistic, double(cells - 1)), cells};
}

double integrate(const std::function<double(double, double)>& f, double x0, double x1, double y0, double y1,
                 int n) {
  double sum = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      sum += f(x0 + (x1 - x0) * (i + 0.5) / n, y0 + (y1 - y0) * (j + 0.5) / n);
  return sum * (x1 - x0) * (y1 - y0) / (double(n) * n);
}

} // namespace chamfer::test
