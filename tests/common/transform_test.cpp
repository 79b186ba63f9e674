#include "common/transform.h"

#include "common/error.h"

#include <gtest/gtest.h>
#include <limits>

namespace chamfer {
namespace {

template <class T>
void expectNear(const T& a, const T& b, double tolerance = 1e-12) {
  for (const auto& [x, y] : {std::pair{a.x, b.x}, {a.y, b.y}, {a.z, b.z}})
    EXPECT_NEAR(x, y, tolerance);
}

/// Every kind of affine map: moved, turned, mirrored, stretched.
Transform mixed() {
  return Transform::translate({3, -4, 5}) * Transform::rotate({1, 2, 3}, 40) * Transform::scale({-2, 0.5, 7});
}

TEST(Transform, PointsMoveVectorsDoNot) {
  const Transform t = Transform::translate({1, 2, 3});
  EXPECT_EQ(t(Point3(1, 1, 1)), Point3(2, 3, 4));
  EXPECT_EQ(t(Vector3(1, 1, 1)), Vector3(1, 1, 1));
  EXPECT_EQ(t(Normal3(0, 0, 1)), Normal3(0, 0, 1));
  const Ray ray = t(Ray{{0, 0, 0}, {0, 0, 2}});
  EXPECT_EQ(ray.origin, Point3(1, 2, 3));
  EXPECT_EQ(ray.direction, Vector3(0, 0, 2));
}

TEST(Transform, RotatesRightHanded) {
  expectNear(Transform::rotate({0, 0, 5}, 90)(Vector3(1, 0, 0)), Vector3(0, 1, 0));
  expectNear(Transform::rotate({1, 1, 1}, 120)(Vector3(1, 0, 0)), Vector3(0, 1, 0));
  EXPECT_NEAR(Transform::rotate({1, 2, 3}, 77).determinant(), 1, 1e-12);
}

TEST(Transform, ProductAppliesTheRightOneFirst) {
  const Transform move = Transform::translate({1, 0, 0}), grow = Transform::scale({2, 2, 2});
  EXPECT_EQ((move * grow)(Point3(1, 0, 0)), Point3(3, 0, 0));
  EXPECT_EQ((grow * move)(Point3(1, 0, 0)), Point3(4, 0, 0));
}

TEST(Transform, InverseUndoes) {
  const Transform t = mixed(), back = t.inverse();
  const Point3 p(0.3, -7, 2);
  expectNear(back(t(p)), p);
  expectNear(t(back(p)), p);
  expectNear(back(t(Vector3(p))), Vector3(p));
  expectNear(back(t(Normal3(1, 2, 3))), Normal3(1, 2, 3));
  EXPECT_NEAR(back.determinant() * t.determinant(), 1, 1e-12);
  EXPECT_TRUE(Transform().isIdentity());
  EXPECT_FALSE(t.isIdentity());
}

TEST(Transform, NormalsStayPerpendicularAndOutward) {
  const Transform t = mixed();
  ASSERT_LT(t.determinant(), 0) << "mirrors";
  // A facet of the octahedron |x|+|y|+|z| = 1, whose outward side is the side away from the centre.
  const Normal3 n(1, 1, 1);
  const Normal3 m = t(n);
  EXPECT_NEAR(dot(m, t(Vector3(1, -1, 0))), 0, 1e-12);
  EXPECT_NEAR(dot(m, t(Vector3(0, 1, -1))), 0, 1e-12);
  EXPECT_GT(dot(m, t(Point3(1, 0, 0)) - t(Point3(0, 0, 0))), 0);
}

TEST(Transform, RefusesWhatHasNoInverse) {
  using Rows = std::array<std::array<double, 4>, 3>;
  const auto refused = [](const Rows& rows) {
    try {
      Transform t(rows);
    } catch (const Error& e) {
      return e.kind() == ErrorKind::OutOfRange;
    }
    return false;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = INFINITY;
  EXPECT_TRUE(refused({{{1, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 1, 0}}}));
  EXPECT_TRUE(refused({{{1, 2, 3, 0}, {2, 4, 6, 0}, {0, 0, 1, 0}}}));
  EXPECT_TRUE(refused({{{1, 0, 0, nan}, {0, 1, 0, 0}, {0, 0, 1, 0}}}));
  EXPECT_TRUE(refused({{{1, 0, 0, 0}, {0, inf, 0, 0}, {0, 0, 1, 0}}}));
  EXPECT_THROW(Transform::scale({1, 0, 1}), Error);
  EXPECT_THROW(Transform::rotate({0, 0, 0}, 30), Error);
}

TEST(Transform, TakesAnyUnitOfLength) {
  for (const double size : {1e-30, 1e-9, 1e9, 1e30}) {
    const Transform t = Transform::scale({size, size, -size});
    const Point3 back = t.inverse()(t(Point3(1, 2, 3)));
    expectNear(back, Point3(1, 2, 3));
  }
}

} // namespace
} // namespace chamfer
