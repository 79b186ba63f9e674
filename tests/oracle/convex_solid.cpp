#include "tests/oracle/convex_solid.h"

#include "tests/oracle/random.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cstdio>
#include <stdexcept>

namespace chamfer::oracle {
namespace {

// Solids are made to be plain: corners that differ by rounding noise only are one corner.
constexpr Real kWeld = 1e-13L;
// About how large the dual of a hull is in rounded coordinates.
constexpr Real kReach = 10;

/// The points moved and sheared to mean zero and covariance one.
std::vector<Vec3> whitened(std::span<const Eigen::Vector3d> points) {
  std::vector<Vec3> result;
  Vec3 mean = Vec3::Zero();
  for (const auto& p : points)
    mean += p.cast<Real>() / Real(points.size());
  Eigen::Matrix<Real, 3, 3> covariance = Eigen::Matrix<Real, 3, 3>::Zero();
  for (const auto& p : points) {
    result.push_back(p.cast<Real>() - mean);
    covariance += result.back() * result.back().transpose() / Real(points.size());
  }
  const Eigen::LLT<Eigen::Matrix<Real, 3, 3>> root(covariance);
  for (Vec3& p : result)
    p = root.matrixL().solve(p);
  return result;
}

/// Orders a convex face's vertices counter-clockwise seen from where `normal` points to.
void sortAround(std::vector<std::uint32_t>& face, const std::vector<Vec3>& corners, const Vec3& normal) {
  Vec3 mean = Vec3::Zero();
  for (const std::uint32_t v : face)
    mean += corners[v] / Real(face.size());
  const Vec3 x = (corners[face.front()] - mean).normalized();
  const Vec3 y = normal.cross(x);
  const auto angle = [&](std::uint32_t v) {
    return std::atan2(y.dot(corners[v] - mean), x.dot(corners[v] - mean));
  };
  std::sort(face.begin(), face.end(), [&](auto a, auto b) { return angle(a) < angle(b); });
}

} // namespace

Eigen::Vector3d ConvexSolid::centroid() const {
  Vec3 sum = Vec3::Zero();
  for (const auto& v : vertices)
    sum += v.cast<Real>();
  return (sum / Real(vertices.size())).cast<double>();
}

double ConvexSolid::diagonal() const {
  Eigen::Vector3d low = vertices.front(), high = vertices.front();
  for (const auto& v : vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  return (high - low).norm();
}

std::vector<Plane> ConvexSolid::planes(const Eigen::Vector3d& origin) const {
  std::vector<Plane> result;
  std::vector<Vec3> loop;
  for (const auto& face : faces) {
    loop.clear();
    Vec3 mean = Vec3::Zero();
    for (const std::uint32_t v : face) {
      loop.push_back(vertices[v].cast<Real>() - origin.cast<Real>());
      mean += loop.back();
    }
    mean /= Real(face.size());
    const Vec3 normal = loopNormal(loop).normalized();
    result.push_back({normal, normal.dot(mean)});
  }
  return result;
}

ConvexSolid solidFromPlanes(std::string name, std::span<const Plane> planes, Real reach) {
  const Polytope polytope = intersectHalfSpaces(planes, reach, kWeld);
  ConvexSolid solid{std::move(name), {}, {}};
  for (const Vec3& v : polytope.vertices)
    solid.vertices.push_back(v.cast<double>());
  for (const auto& face : polytope.faces)
    if (!face.empty()) solid.faces.push_back(face);
  return solid;
}

ConvexSolid solidFromPoints(std::string name, std::span<const Eigen::Vector3d> points) {
  // Duality: with the origin inside, the hull's facets are the vertices of {x : p.x <= 1 for every point p}.
  // It is well conditioned for points that are round about the origin, and hulls go with affine maps.
  const std::vector<Vec3> round = whitened(points);
  std::vector<Plane> planes;
  for (const Vec3& p : round) {
    const Real length = p.norm();
    // A point at the origin itself bounds nothing: its plane is moved out of reach.
    planes.push_back(length > 0 ? Plane{p / length, 1 / length} : Plane{Vec3::UnitX(), kReach * 1e9L});
  }
  const Polytope dual = intersectHalfSpaces(planes, kReach, kWeld / kReach);

  ConvexSolid solid{std::move(name), {}, std::vector<std::vector<std::uint32_t>>(dual.vertices.size())};
  std::vector<Vec3> corners;
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (dual.faces[p].empty()) continue;
    for (const std::uint32_t facet : dual.faces[p])
      solid.faces[facet].push_back(std::uint32_t(corners.size()));
    solid.vertices.push_back(points[p]);
    corners.push_back(round[p]);
  }
  for (std::size_t f = 0; f < solid.faces.size(); ++f)
    sortAround(solid.faces[f], corners, dual.vertices[f].normalized());
  return solid;
}

Affine randomRotation(std::uint64_t seed) {
  Random random(seed);
  Eigen::Vector4d q;
  for (double& x : q)
    x = random.normal();
  q.normalize();
  return {Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix(), Eigen::Vector3d::Zero()};
}

Affine scaling(double x, double y, double z) {
  return {Eigen::Vector3d(x, y, z).asDiagonal(), Eigen::Vector3d::Zero()};
}

ConvexSolid transformed(const ConvexSolid& solid, const Affine& map) {
  ConvexSolid result = solid;
  for (auto& v : result.vertices)
    v = (map.linear.cast<Real>() * v.cast<Real>() + map.offset.cast<Real>()).cast<double>();
  if (map.linear.determinant() < 0)
    for (auto& face : result.faces)
      std::reverse(face.begin(), face.end());
  return result;
}

ConvexSolid placed(const ConvexSolid& solid, double scale, double offsetDiagonals, std::uint64_t seed) {
  Affine map = randomRotation(seed);
  map.linear *= scale;
  map.offset = Random(seed + 1).direction() * (offsetDiagonals * scale * solid.diagonal());
  return transformed(solid, map);
}

std::string toObj(std::span<const ConvexSolid> solids, ObjFaces faces) {
  std::string text;
  char line[160];
  std::size_t first = 1;
  for (const ConvexSolid& solid : solids) {
    text += "o " + solid.name + "\n";
    for (const auto& v : solid.vertices) {
      std::snprintf(line, sizeof line, "v %.17g %.17g %.17g\n", v.x(), v.y(), v.z());
      text += line;
    }
    const auto write = [&](const std::vector<std::uint32_t>& corners) {
      text += "f";
      for (const std::uint32_t v : corners)
        text += " " + std::to_string(first + v);
      text += "\n";
    };
    for (const auto& face : solid.faces) {
      if (faces == ObjFaces::Polygons)
        write(face);
      else
        for (std::size_t k = 1; k + 1 < face.size(); ++k)
          write({face[0], face[k], face[k + 1]});
    }
    first += solid.vertices.size();
  }
  return text;
}

} // namespace chamfer::oracle
