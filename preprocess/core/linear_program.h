// Small dense linear programs in a few variables with many rows: dual simplex on a K x K basis, one row
// exchanged at a time, the most violated row entering. Each step costs O(rows * K); a few steps suffice for
// the geometry here (the largest ball inside a polytope, the deepest point of an edge or a triangle below a
// hull).
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

namespace chamfer {

template <int K>
using LpVector = std::array<double, K>;

template <int K>
struct LpRow {
  LpVector<K> a;
  double b;
};

template <int K>
double lpDot(const LpVector<K>& u, const LpVector<K>& v) {
  double s = 0;
  for (int i = 0; i < K; ++i)
    s += u[i] * v[i];
  return s;
}

/// Inverse by Gauss-Jordan elimination with partial pivoting; nothing for a singular matrix.
template <int K>
std::optional<std::array<LpVector<K>, K>> lpInverse(std::array<LpVector<K>, K> m) {
  std::array<LpVector<K>, K> inverse{};
  for (int i = 0; i < K; ++i)
    inverse[i][i] = 1;
  for (int column = 0; column < K; ++column) {
    int pivot = column;
    for (int i = column + 1; i < K; ++i)
      if (std::abs(m[i][column]) > std::abs(m[pivot][column])) pivot = i;
    if (!(std::abs(m[pivot][column]) > 1e-14)) return std::nullopt;
    std::swap(m[pivot], m[column]);
    std::swap(inverse[pivot], inverse[column]);
    const double scale = 1 / m[column][column];
    for (int j = 0; j < K; ++j) {
      m[column][j] *= scale;
      inverse[column][j] *= scale;
    }
    for (int i = 0; i < K; ++i) {
      if (i == column) continue;
      const double factor = m[i][column];
      for (int j = 0; j < K; ++j) {
        m[i][j] -= factor * m[column][j];
        inverse[i][j] -= factor * inverse[column][j];
      }
    }
  }
  return inverse;
}

/// Maximises z[K-1] subject to a_i . z <= b_i for i < count, with `row(i)` giving row i. Rows should be
/// scaled so that values of order 1 matter, and the feasible region must lie in |z_k| < `extent`. Returns the
/// optimum, accurate to about 1e-15 of the rows' scale, or nothing when no z is feasible.
template <int K, class Rows>
std::optional<LpVector<K>> maximizeLast(std::size_t count, const Rows& row, double extent) {
  // K artificial rows around the region: their normals are the last axis plus the corners of a simplex in the
  // other K-1 dimensions, so that they add up to K times the objective and the basis of them is dual
  // feasible.
  std::array<LpRow<K>, K> basis;
  for (int j = 0; j < K; ++j) {
    basis[j].a.fill(0);
    if (j < K - 1)
      basis[j].a[j] = 1;
    else
      for (int k = 0; k < K - 1; ++k)
        basis[j].a[k] = -1;
    basis[j].a[K - 1] = 1;
    basis[j].b = 2 * K * extent;
  }
  std::array<std::size_t, K> index;
  index.fill(count);
  const double tolerance = 1e-14 * extent; // well above the rounding of a dot product of rows of order 1
  constexpr std::size_t patience = 200;    // a few dozen steps are the rule
  LpVector<K> z{};
  for (std::size_t step = 0; step < 2 * patience; ++step) {
    std::array<LpVector<K>, K> matrix;
    for (int j = 0; j < K; ++j)
      matrix[j] = basis[j].a;
    const auto inverse = lpInverse<K>(matrix);
    if (!inverse) return std::nullopt;
    for (int i = 0; i < K; ++i) {
      z[i] = 0;
      for (int j = 0; j < K; ++j)
        z[i] += (*inverse)[i][j] * basis[j].b;
    }
    // Most violated row; after long (ties could cycle) the first violated one, Bland's rule.
    const bool bland = step > patience;
    std::size_t entering = count;
    double worst = tolerance;
    LpRow<K> enteringRow{};
    for (std::size_t i = 0; i < count; ++i) {
      const LpRow<K> r = row(i);
      const double violation = lpDot<K>(r.a, z) - r.b;
      if (!(violation > worst)) continue;
      bool inBasis = false; // a row of the basis is violated by rounding alone
      for (int j = 0; j < K; ++j)
        inBasis = inBasis || index[j] == i;
      if (inBasis) continue;
      entering = i;
      enteringRow = r;
      if (bland) break;
      worst = violation;
    }
    if (entering == count) return z;
    int leaving = -1;
    double best = 0, bestWeight = 0;
    for (int j = 0; j < K; ++j) {
      double weight = 0;
      for (int i = 0; i < K; ++i)
        weight += (*inverse)[i][j] * enteringRow.a[i];
      if (!(weight > 1e-12)) continue;
      const double multiplier = std::max(0.0, (*inverse)[K - 1][j]);
      const double ratio = multiplier / weight;
      if (leaving < 0 || ratio < best || (ratio == best && weight > bestWeight)) {
        leaving = j;
        best = ratio;
        bestWeight = weight;
      }
    }
    if (leaving < 0) return std::nullopt;
    basis[leaving] = enteringRow;
    index[leaving] = entering;
  }
  return z;
}

} // namespace chamfer
