#include "tests/oracle/inradius.h"

#include <Eigen/LU>
#include <array>
#include <limits>
#include <optional>
#include <stdexcept>

namespace chamfer::oracle {
namespace {

using Vec4 = Eigen::Matrix<Real, 4, 1>;
using Mat4 = Eigen::Matrix<Real, 4, 4>;

Vec4 row(const Plane& plane) { return {plane.normal.x(), plane.normal.y(), plane.normal.z(), 1}; }

struct Block {
  std::size_t plane;
  Real step;
};

/// How far x can move along `direction` before a plane stops it. Ties go to the lowest index (Bland's rule).
std::optional<Block> firstBlock(std::span<const Plane> planes, const Vec4& x, const Vec4& direction) {
  std::optional<Block> best;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const Real rate = row(planes[i]).dot(direction);
    if (rate <= 1e-14L * direction.norm()) continue;
    const Real step = std::max<Real>(0, (planes[i].offset - row(planes[i]).dot(x)) / rate);
    if (!best || step < best->step) best = Block{i, step};
  }
  return best;
}

/// Four independent tight planes at a point with r no smaller than at the start.
std::array<std::size_t, 4> firstBasis(std::span<const Plane> planes, Vec4 x) {
  std::array<std::size_t, 4> basis{};
  Mat4 tight = Mat4::Zero();
  for (int have = 0; have < 4; ++have) {
    // The direction of greatest growth of r, and when there is none any other, that keeps the tight planes
    // tight.
    Mat4 keep = Mat4::Identity();
    for (int i = 0; i < have; ++i) { // Gram-Schmidt, twice over for accuracy
      Vec4 q = tight.row(i).transpose();
      for (int pass = 0; pass < 2; ++pass)
        q = keep * q;
      q.normalize();
      keep -= q * q.transpose();
    }
    Vec4 direction = keep.col(3);
    if (direction.norm() < 1e-9L) {
      Eigen::Index column = 0;
      keep.colwise().norm().maxCoeff(&column);
      direction = keep.col(column);
    }
    auto block = firstBlock(planes, x, direction);
    if (!block) block = firstBlock(planes, x, direction = -direction);
    if (!block) throw std::runtime_error("inradius: the planes do not bound a solid");
    x += direction * block->step;
    basis[std::size_t(have)] = block->plane;
    tight.row(have) = row(planes[block->plane]).transpose();
  }
  return basis;
}

} // namespace

Inball largestBall(std::span<const Plane> planes, const Vec3& inside) {
  Real slack = std::numeric_limits<Real>::infinity();
  for (const Plane& plane : planes)
    slack = std::min(slack, plane.offset - plane.normal.dot(inside));
  if (!(slack > 0)) throw std::runtime_error("inradius: the start point is not inside");
  std::array<std::size_t, 4> basis = firstBasis(planes, {inside.x(), inside.y(), inside.z(), slack});

  for (std::size_t pivot = 0; pivot < 50 * planes.size() + 1000; ++pivot) {
    Mat4 a;
    Vec4 d;
    for (int i = 0; i < 4; ++i) {
      a.row(i) = row(planes[basis[std::size_t(i)]]).transpose();
      d[i] = planes[basis[std::size_t(i)]].offset;
    }
    const Eigen::FullPivLU<Mat4> lu(a);
    const Vec4 x = lu.solve(d);
    const Vec4 multipliers = lu.inverse().row(3).transpose(); // of r = sum(multiplier * offset)
    int leaving = -1;
    for (int i = 0; i < 4; ++i)
      if (multipliers[i] < -1e-15L && (leaving < 0 || basis[std::size_t(i)] < basis[std::size_t(leaving)]))
        leaving = i;
    if (leaving < 0) {
      Real violation = 0;
      for (const Plane& plane : planes)
        violation = std::max(violation, row(plane).dot(x) - plane.offset);
      Real negative = 0;
      for (int i = 0; i < 4; ++i)
        negative += std::max<Real>(0, -multipliers[i]) * std::abs(d[i]);
      return {x.head<3>(), x[3], violation + negative};
    }
    const Vec4 direction = -lu.inverse().col(leaving);
    const auto block = firstBlock(planes, x, direction);
    if (!block) break;
    basis[std::size_t(leaving)] = block->plane;
  }
  throw std::runtime_error("inradius: the simplex method did not end");
}

} // namespace chamfer::oracle
