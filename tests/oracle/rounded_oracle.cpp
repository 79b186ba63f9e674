#include "tests/oracle/rounded_oracle.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace chamfer::oracle {
namespace {

constexpr Real kInfinity = std::numeric_limits<Real>::infinity();

std::vector<Plane> eroded(std::vector<Plane> planes, Real radius) {
  for (Plane& plane : planes)
    plane.offset -= radius;
  return planes;
}

Real angleBetween(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

} // namespace

const char* featureWord(Feature feature) {
  return feature == Feature::Flat ? "flat" : feature == Feature::Cylinder ? "cylinder" : "sphere";
}

Inball inball(const ConvexSolid& solid) { return largestBall(solid.planes(solid.centroid()), Vec3::Zero()); }

void RoundedOracle::Balls::add(const Vec3& centre, Real ball) {
  x.push_back(double(centre.x()));
  y.push_back(double(centre.y()));
  z.push_back(double(centre.z()));
  radius.push_back(double(ball));
}

RoundedOracle::RoundedOracle(const ConvexSolid& solid, double radius)
    : radius_(radius), diagonal_(solid.diagonal()), centre_(solid.centroid()), planes_(solid.planes(centre_)),
      core_(intersectHalfSpaces(eroded(planes_, radius_), diagonal_, 1e-14L)),
      edgesAtVertex_(core_.vertices.size()), shortestAtVertex_(core_.vertices.size(), kInfinity) {
  for (const PolytopeEdge& edge : core_.edges) {
    const Vec3 a = core_.vertices[edge.a], b = core_.vertices[edge.b];
    const Vec3 axis = (b - a).normalized();
    segments_.push_back({a, axis, (b - a).norm(), edge.left, edge.right});
    edgesAtVertex_[edge.a].push_back(axis);
    edgesAtVertex_[edge.b].push_back(-axis);
    for (const std::uint32_t v : {edge.a, edge.b})
      shortestAtVertex_[v] = std::min(shortestAtVertex_[v], (b - a).norm());
    capsules_.add((a + b) / 2, (b - a).norm() / 2 + radius_);
  }
  for (const Vec3& v : core_.vertices) {
    balls_.add(v, radius_);
    bound_ = std::max(bound_, v.norm() + radius_);
  }
}

bool RoundedOracle::insideFace(std::uint32_t face, const Vec3& point) const {
  // By the planes, not by the loop: the directions of a loop's shortest edges are mostly rounding noise.
  if (core_.faces[face].empty()) return false;
  for (std::uint32_t other = 0; other < planes_.size(); ++other)
    if (other != face && planes_[other].normal.dot(point) > planes_[other].offset - radius_) return false;
  return true;
}

bool RoundedOracle::insideSolid(const Vec3& point) const {
  const Vec3 local = point - centre_.cast<Real>();
  return std::all_of(planes_.begin(), planes_.end(),
                     [&](const Plane& p) { return p.normal.dot(local) <= p.offset; });
}

Real RoundedOracle::seamOfFace(std::uint32_t face, const Vec3& foot) const {
  const auto& loop = core_.faces[face];
  Real nearestSeam = kInfinity;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3 a = core_.vertices[loop[i]], ab = core_.vertices[loop[(i + 1) % loop.size()]] - a;
    const Real s = std::clamp<Real>((foot - a).dot(ab) / ab.squaredNorm(), 0, 1);
    nearestSeam = std::min(nearestSeam, (foot - a - s * ab).norm());
  }
  return nearestSeam;
}

Real RoundedOracle::seamOfVertex(std::uint32_t vertex, const Vec3& normal) const {
  Real angle = std::numbers::pi_v<Real>;
  for (const Vec3& edge : edgesAtVertex_[vertex])
    angle = std::min(angle, std::asin(std::clamp<Real>(-edge.dot(normal), 0, 1)));
  return angle * radius_;
}

Nearest RoundedOracle::nearest(const Vec3& point) const {
  const Vec3 x = point - centre_.cast<Real>();
  // E's faces: the nearest point is inside a face only if that face's plane is the one that the point is
  // farthest outside of, because every half-space holds E.
  Real highest = -kInfinity;
  for (const Plane& plane : planes_)
    highest = std::max(highest, plane.normal.dot(x) - plane.offset + radius_);
  for (std::uint32_t f = 0; f < planes_.size(); ++f) {
    const Real height = planes_[f].normal.dot(x) - planes_[f].offset + radius_;
    if (height < highest - diagonal_ * 1e-17L) continue;
    const Vec3 foot = x - height * planes_[f].normal;
    if (highest <= 0 || insideFace(f, foot))
      return {height, planes_[f].normal, Feature::Flat, seamOfFace(f, foot), 1};
  }
  Real best = kInfinity, at = 0;
  std::size_t edge = 0;
  for (std::size_t e = 0; e < segments_.size(); ++e) {
    const Segment& segment = segments_[e];
    const Real s = std::clamp<Real>((x - segment.a).dot(segment.axis), 0, segment.length);
    const Real squared = (x - segment.a - s * segment.axis).squaredNorm();
    if (squared < best) {
      best = squared;
      at = s;
      edge = e;
    }
  }
  const Segment& segment = segments_[edge];
  const Real distance = std::sqrt(best);
  const Vec3 normal = (x - segment.a - at * segment.axis) / distance;
  if (at > 0 && at < segment.length) {
    const Real turn = std::min(angleBetween(normal, planes_[segment.left].normal),
                               angleBetween(normal, planes_[segment.right].normal));
    return {distance, normal, Feature::Cylinder, std::min({at, segment.length - at, turn * radius_}),
            seamMotion(segment.length)};
  }
  const std::uint32_t vertex = at > 0 ? core_.edges[edge].b : core_.edges[edge].a;
  return {distance, normal, Feature::Sphere, seamOfVertex(vertex, normal),
          seamMotion(shortestAtVertex_[vertex])};
}

Real RoundedOracle::flatMargin(std::uint32_t facet, const Vec3& point) const {
  if (core_.faces[facet].empty()) return -kInfinity;
  const Plane& plane = planes_[facet];
  const Vec3 x = point - centre_.cast<Real>();
  const Vec3 foot = x - (plane.normal.dot(x) - plane.offset + radius_) * plane.normal;
  const Real border = seamOfFace(facet, foot);
  return insideFace(facet, foot) ? border : -border;
}

Measures RoundedOracle::coreMeasures() const {
  if (!core_.closed)
    throw std::runtime_error("oracle: the core's surface is not closed, so it has no measures");
  Measures m{0, 0, 0};
  std::vector<Vec3> loop;
  for (std::size_t f = 0; f < planes_.size(); ++f) {
    loop.clear();
    for (const std::uint32_t v : core_.faces[f])
      loop.push_back(core_.vertices[v]);
    if (loop.empty()) continue;
    const Real area = loopNormal(loop).dot(planes_[f].normal);
    m.area += area;
    m.volume += area * (planes_[f].offset - radius_) / 3;
  }
  for (const Segment& s : segments_)
    m.meanCurvature += s.length * angleBetween(planes_[s.left].normal, planes_[s.right].normal) / 2;
  return m;
}

Real RoundedOracle::volume() const {
  const Measures m = coreMeasures();
  const Real r = radius_;
  return m.volume + m.area * r + m.meanCurvature * r * r + std::numbers::pi_v<Real> * 4 / 3 * r * r * r;
}

Real RoundedOracle::area() const {
  const Measures m = coreMeasures();
  const Real r = radius_;
  return m.area + 2 * m.meanCurvature * r + std::numbers::pi_v<Real> * 4 * r * r;
}

} // namespace chamfer::oracle
