#include "server/render/scene/stretch.h"

#include "common/error.h"
#include "common/text.h"

#include <algorithm>
#include <cmath>

namespace chamfer {
namespace {

std::string shown(double v) { return numberText(v, 6); }

using Matrix = std::array<std::array<double, 3>, 3>;

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix m{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      m[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
  return m;
}

Matrix transposed(const Matrix& a) {
  Matrix m{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      m[i][j] = a[j][i];
  return m;
}

Vector3 row(const Matrix& a, std::size_t i) { return {a[i][0], a[i][1], a[i][2]}; }

/// Inverse transpose: the cofactors over the determinant.
Matrix inverseTransposed(const Matrix& a) {
  const Vector3 x = row(a, 0), y = row(a, 1), z = row(a, 2);
  const Vector3 rows[3] = {cross(y, z), cross(z, x), cross(x, y)};
  const double det = dot(x, rows[0]);
  Matrix m{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      m[i][j] = rows[i][j] / det;
  return m;
}

/// The part of `a` that turns, by Newton's iteration (Higham, "Computing the Polar Decomposition", 1986).
Matrix rotationOf(Matrix a) {
  constexpr int kMostSteps = 60; // halves what is off until it is near, then squares it
  for (int step = 0; step < kMostSteps; ++step) {
    const Matrix b = inverseTransposed(a);
    double change = 0;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        const double next = (a[i][j] + b[i][j]) / 2;
        change = std::max(change, std::abs(next - a[i][j]));
        a[i][j] = next;
      }
    if (change < 1e-15) break;
  }
  return a;
}

} // namespace

Stretch stretchOf(const Transform& transform) {
  Matrix linear{};
  double largest = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      largest = std::max(largest, std::abs(linear[i][j] = transform.rows()[i][j]));
  for (auto& r : linear)
    for (double& v : r)
      v /= largest;
  const Vector3 columns[3] = {row(transposed(linear), 0), row(transposed(linear), 1),
                              row(transposed(linear), 2)};
  double longest = 0, volume = std::abs(dot(columns[0], cross(columns[1], columns[2])));
  for (const Vector3& c : columns)
    longest = std::max(longest, length(c));
  if (!(volume > 1e-9 * longest * longest * longest))
    throw Error(
        ErrorKind::OutOfRange,
        "a radius in world units needs a transform that squeezes no direction flat: this one leaves " +
            shown(volume / (longest * longest * longest)) + " of the volume, less than 1e-9");
  const Matrix s = product(transposed(rotationOf(linear)), linear);
  Stretch stretch;
  stretch.entries = {
      s[0][0], s[1][1], s[2][2], (s[1][2] + s[2][1]) / 2, (s[0][2] + s[2][0]) / 2, (s[0][1] + s[1][0]) / 2};
  for (double& v : stretch.entries)
    v *= largest;
  const auto& e = stretch.entries;
  const double unit = std::exp2(double(std::ilogb(std::max({e[0], e[1], e[2]})) - 30));
  for (double& v : stretch.entries)
    v = std::nearbyint(v / unit) * unit + 0.0; // no minus zero
  return stretch;
}

bool Stretch::isUniform() const {
  return entries[0] == entries[1] && entries[1] == entries[2] && entries[3] == 0 && entries[4] == 0 &&
         entries[5] == 0;
}

Transform Stretch::transform() const {
  const auto& e = entries;
  return Transform(std::array<std::array<double, 4>, 3>{
      {{e[0], e[5], e[4], 0}, {e[5], e[1], e[3], 0}, {e[4], e[3], e[2], 0}}});
}

std::string Stretch::text() const {
  if (isUniform()) return shown(entries[0]);
  if (entries[3] != 0 || entries[4] != 0 || entries[5] != 0) return "sheared";
  return shown(entries[0]) + " x " + shown(entries[1]) + " x " + shown(entries[2]);
}

} // namespace chamfer
