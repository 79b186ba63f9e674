// Pearson's chi-squared test of a sampler against its density, as a judge of tests.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace chamfer::test {

struct ChiSquaredResult {
  double pValue = 0;     ///< probability of a fit this bad or worse if the sampler is right
  std::size_t cells = 0; ///< that were compared, after pooling cells of few expected samples
  std::string text() const;
};

/// Compares counts with expectations (sums should agree; what either has beyond the other counts as misfit).
/// Cells with fewer than 5 expected samples are pooled.
ChiSquaredResult chiSquared(const std::vector<double>& observed, const std::vector<double>& expected);

/// The chance of `statistic` or more with `degrees` degrees of freedom.
double chiSquaredTail(double statistic, double degrees);

/// Integral of f over [x0, x1] x [y0, y1] by the midpoint rule with n x n points.
double integrate(const std::function<double(double, double)>& f, double x0, double x1, double y0, double y1,
                 int n);

/// Below this a sampler is judged wrong.
inline constexpr double kSignificance = 1e-4;

} // namespace chamfer::test
