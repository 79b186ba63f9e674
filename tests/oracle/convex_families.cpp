#include "tests/oracle/convex_families.h"

#include "tests/oracle/random.h"

#include <cstdio>
#include <numbers>

namespace chamfer::oracle {
namespace {

using Points = std::vector<Eigen::Vector3d>;
const double kGolden = std::numbers::phi;

/// Appends the regular polygon of circumradius `radius` at height `z`, turned by `turn` of a side.
void addRing(Points& points, unsigned sides, double radius, double z, double turn = 0) {
  for (unsigned i = 0; i < sides; ++i) {
    const double angle = 2 * std::numbers::pi * (i + turn) / sides;
    points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
}

std::string named(const std::string& family, double value) {
  char text[32];
  std::snprintf(text, sizeof text, "-%g", value);
  return family + text;
}

ConvexSolid renamed(ConvexSolid solid, std::string name) {
  solid.name = std::move(name);
  return solid;
}

} // namespace

ConvexSolid box(double x, double y, double z) {
  Points points;
  for (int corner = 0; corner < 8; ++corner)
    points.emplace_back(corner & 1 ? x / 2 : -x / 2, corner & 2 ? y / 2 : -y / 2,
                        corner & 4 ? z / 2 : -z / 2);
  return solidFromPoints("box", points);
}

ConvexSolid cube() { return renamed(box(1, 1, 1), "cube"); }

ConvexSolid tetrahedron() {
  return solidFromPoints("tetrahedron", Points{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}});
}

ConvexSolid octahedron() {
  return solidFromPoints("octahedron",
                         Points{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}});
}

ConvexSolid dodecahedron() {
  Points points;
  for (const double a : {-1.0, 1.0})
    for (const double b : {-1.0, 1.0}) {
      for (const double c : {-1.0, 1.0})
        points.emplace_back(a, b, c);
      points.emplace_back(0, a / kGolden, b * kGolden);
      points.emplace_back(a / kGolden, b * kGolden, 0);
      points.emplace_back(b * kGolden, 0, a / kGolden);
    }
  return solidFromPoints("dodecahedron", points);
}

ConvexSolid icosahedron() {
  Points points;
  for (const double a : {-1.0, 1.0})
    for (const double b : {-kGolden, kGolden}) {
      points.emplace_back(0, a, b);
      points.emplace_back(a, b, 0);
      points.emplace_back(b, 0, a);
    }
  return solidFromPoints("icosahedron", points);
}

ConvexSolid prism(unsigned sides, double height) {
  Points points;
  addRing(points, sides, 1, -height / 2);
  addRing(points, sides, 1, height / 2);
  return solidFromPoints(named("prism", sides), points);
}

ConvexSolid antiprism(unsigned sides, double height) {
  Points points;
  addRing(points, sides, 1, -height / 2);
  addRing(points, sides, 1, height / 2, 0.5);
  return solidFromPoints(named("antiprism", sides), points);
}

ConvexSolid pyramid(unsigned sides, double height) {
  Points points{{0, 0, height * 0.75}};
  addRing(points, sides, 1, -height * 0.25);
  return solidFromPoints(named("pyramid", sides), points);
}

ConvexSolid bipyramid(unsigned sides, double height) {
  Points points{{0, 0, height}, {0, 0, -height}};
  addRing(points, sides, 1, 0);
  return solidFromPoints(named("bipyramid", sides), points);
}

ConvexSolid frustum(unsigned sides, double top, double height) {
  Points points;
  addRing(points, sides, 1, -height / 2);
  addRing(points, sides, top, height / 2);
  return solidFromPoints(named("frustum", sides), points);
}

ConvexSolid wedge(double angleDegrees) {
  const double half = angleDegrees / 2 * std::numbers::pi / 180;
  // The cross-section's centroid is two thirds of the way from the edge to the middle of the opposite side.
  const double depth = std::cos(half), width = std::sin(half);
  Points points;
  for (const double z : {-0.5, 0.5}) {
    points.emplace_back(-depth * 2 / 3, 0, z);
    points.emplace_back(depth / 3, width, z);
    points.emplace_back(depth / 3, -width, z);
  }
  return solidFromPoints(named("wedge", angleDegrees), points);
}

ConvexSolid hullOnSphere(unsigned points, std::uint64_t seed) {
  Random random(seed);
  Points list;
  for (unsigned i = 0; i < points; ++i)
    list.push_back(random.direction());
  return solidFromPoints(named("hull-on-sphere", points), list);
}

ConvexSolid hullInBall(unsigned points, std::uint64_t seed) {
  Random random(seed);
  Points list;
  for (unsigned i = 0; i < points; ++i) {
    const Eigen::Vector3d direction = random.direction();
    list.push_back(direction * std::cbrt(random.uniform(1e-6, 1)));
  }
  return solidFromPoints(named("hull-in-ball", points), list);
}

ConvexSolid voronoiCell(unsigned sites, std::uint64_t seed) {
  Random random(seed);
  std::vector<Plane> planes;
  // A box of far sites closes the cell; the near ones are random.
  for (int axis = 0; axis < 3; ++axis)
    for (const Real side : {-1, 1})
      planes.push_back({Vec3::Unit(axis) * side, 1});
  for (unsigned i = 0; i < sites; ++i) {
    const Eigen::Vector3d direction = random.direction();
    planes.push_back({direction.cast<Real>().normalized(), Real(random.uniform(0.35, 1.2))});
  }
  return solidFromPlanes(named("voronoi", sites), planes, 2);
}

ConvexSolid cutCorners(const ConvexSolid& solid, double depth) {
  std::vector<Plane> planes = solid.planes(Eigen::Vector3d::Zero());
  std::vector<Vec3> outward(solid.vertices.size(), Vec3::Zero());
  for (std::size_t f = 0; f < solid.faces.size(); ++f)
    for (const std::uint32_t v : solid.faces[f])
      outward[v] += planes[f].normal;
  const double diagonal = solid.diagonal();
  for (std::size_t v = 0; v < outward.size(); ++v) {
    const Vec3 normal = outward[v].normalized();
    planes.push_back({normal, normal.dot(solid.vertices[v].cast<Real>()) - Real(depth * diagonal)});
  }
  return solidFromPlanes(named(solid.name + "-cut", depth), planes, Real(diagonal));
}

ConvexSolid jitteredFacets(const ConvexSolid& solid, double amount, std::uint64_t seed) {
  Random random(seed);
  std::vector<Plane> planes = solid.planes(Eigen::Vector3d::Zero());
  const double diagonal = solid.diagonal();
  for (Plane& plane : planes)
    plane.offset += Real(amount * diagonal * random.uniform(-1, 1));
  return solidFromPlanes(named(solid.name + "-jittered", amount), planes, Real(2 * diagonal));
}

std::vector<ConvexSolid> familyCatalogue() {
  std::vector<ConvexSolid> list{cube(),       box(1, 2, 3),   tetrahedron(),
                                octahedron(), dodecahedron(), icosahedron()};
  for (const unsigned n : {3u, 5u, 12u, 40u})
    list.push_back(prism(n, 1));
  for (const unsigned n : {3u, 5u, 16u})
    list.push_back(antiprism(n, 1));
  for (const unsigned n : {4u, 5u, 24u})
    list.push_back(pyramid(n, 1.5));
  for (const unsigned n : {3u, 5u, 30u})
    list.push_back(bipyramid(n, 0.7));
  list.push_back(renamed(pyramid(100, 2), "cone-100"));
  list.push_back(frustum(4, 0.5, 1));
  list.push_back(frustum(7, 0.02, 1));
  for (const double depth : {0.1, 0.01, 1e-4})
    list.push_back(cutCorners(cube(), depth));
  list.push_back(cutCorners(icosahedron(), 0.02));
  list.push_back(cutCorners(octahedron(), 1e-3));
  for (const double angle : {5.0, 30.0, 150.0, 175.0})
    list.push_back(wedge(angle));
  const auto stretched = [&](const ConvexSolid& solid, double x, double y, double z) {
    list.push_back(transformed(solid, scaling(x, y, z)));
    list.back().name = named(named(named(solid.name + "-stretched", x), y), z);
  };
  stretched(cube(), 1, 1, 1e-3);
  stretched(cube(), 1, 1e-3, 1e-3);
  stretched(dodecahedron(), 1, 1, 0.01);
  stretched(icosahedron(), 1, 0.03, 0.3);
  stretched(octahedron(), 20, 1, 1);
  for (const double amount : {1e-2, 1e-4, 1e-6}) {
    list.push_back(jitteredFacets(octahedron(), amount, 11));
    list.push_back(jitteredFacets(icosahedron(), amount, 12));
    list.push_back(jitteredFacets(pyramid(12, 1.5), amount, 13));
  }
  for (const unsigned n : {8u, 20u, 60u})
    list.push_back(hullOnSphere(n, 100 + n));
  for (const unsigned n : {30u, 200u})
    list.push_back(hullInBall(n, 200 + n));
  stretched(hullInBall(100, 7), 1, 0.05, 0.4);
  for (const unsigned n : {10u, 40u})
    list.push_back(voronoiCell(n, 300 + n));
  return list;
}

std::vector<ConvexSolid> largeFamilies() {
  return {prism(200, 1), antiprism(200, 0.3), bipyramid(200, 1), hullOnSphere(1000, 5), voronoiCell(400, 6)};
}

} // namespace chamfer::oracle
