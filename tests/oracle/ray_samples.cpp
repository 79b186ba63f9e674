#include "tests/oracle/ray_samples.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdlib>

namespace chamfer::oracle {

using Eigen::Vector3d;

const char* rayKindWord(RayKind kind) {
  switch (kind) {
  case RayKind::Distant:
    return "distant";
  case RayKind::Far10:
    return "far-10";
  case RayKind::Far100:
    return "far-100";
  case RayKind::Edge:
    return "edge";
  case RayKind::GrazingEdge:
    return "grazing-edge";
  case RayKind::Corner:
    return "corner";
  case RayKind::Tangent:
    return "tangent";
  case RayKind::Inside:
    return "inside";
  case RayKind::Sliver:
    return "sliver";
  case RayKind::AxisParallel:
    return "axis-parallel";
  case RayKind::AlongEdge:
    return "along-edge";
  case RayKind::Seam:
    return "seam";
  }
  return "unknown";
}

std::size_t rayBudget(std::size_t base) {
  const char* text = std::getenv("CHAMFER_RAYS");
  const double factor = text ? std::strtod(text, nullptr) : 1;
  return std::max<std::size_t>(1, std::size_t(double(base) * (factor > 0 ? factor : 1)));
}

RaySampler::RaySampler(const ConvexSolid& solid, const RoundedOracle& oracle, std::uint64_t seed)
    : solid_(solid), oracle_(oracle), random_(seed), diagonal_(oracle.diagonal()), radius_(oracle.radius()),
      facetsAtVertex_(oracle.core().vertices.size()), lower_(solid.vertices.front()), upper_(lower_) {
  for (std::uint32_t f = 0; f < oracle.core().faces.size(); ++f) {
    for (const std::uint32_t v : oracle.core().faces[f])
      facetsAtVertex_[v].push_back(f);
    if (!oracle.core().faces[f].empty()) flats_.push_back(f);
  }
  for (const Vector3d& v : solid.vertices) {
    lower_ = lower_.cwiseMin(v);
    upper_ = upper_.cwiseMax(v);
  }
}

Vector3d RaySampler::world(const Vec3& local) const {
  return (local + oracle_.centre().cast<Real>()).cast<double>();
}

Vector3d RaySampler::inHemisphere(const Vector3d& normal) {
  const Vector3d d = random_.direction();
  return d.dot(normal) < 0 ? Vector3d(-d) : d;
}

Vector3d RaySampler::onFacet(std::uint32_t facet) {
  const auto& loop = solid_.faces[facet];
  const std::size_t k = 1 + random_.below(loop.size() - 2); // a triangle of the fan
  double a = random_.uniform(), b = random_.uniform();
  if (a + b > 1) a = 1 - a, b = 1 - b;
  const Vector3d &p = solid_.vertices[loop[0]], &q = solid_.vertices[loop[k]],
                 &s = solid_.vertices[loop[k + 1]];
  return p + a * (q - p) + b * (s - p);
}

SurfacePoint RaySampler::onFlat() {
  const std::uint32_t f = flats_[random_.below(flats_.size())];
  const auto& loop = oracle_.core().faces[f];
  Vec3 sum = Vec3::Zero();
  Real total = 0;
  for (const std::uint32_t v : loop) {
    const Real weight = random_.uniform(1e-9, 1);
    sum += weight * oracle_.core().vertices[v];
    total += weight;
  }
  const Vec3 normal = oracle_.planes()[f].normal;
  return {world(sum / total + Real(radius_) * normal), normal.cast<double>()};
}

SurfacePoint RaySampler::onEdgeOfCore(bool atBorder) {
  const Polytope& core = oracle_.core();
  const PolytopeEdge& edge = core.edges[random_.below(core.edges.size())];
  // 0 and 1 are the two facets' normals, and the edge's two ends.
  double turn = random_.uniform(), share = random_.uniform();
  if (atBorder) {
    const std::size_t side = random_.below(4);
    (side < 2 ? turn : share) = double(side % 2);
  }
  const Vec3 &m = oracle_.planes()[edge.left].normal, &n = oracle_.planes()[edge.right].normal;
  const Real angle = std::atan2(m.cross(n).norm(), m.dot(n));
  const Vec3 normal = (std::sin((1 - turn) * angle) * m + std::sin(turn * angle) * n).normalized();
  const Vec3 axis = core.vertices[edge.a] + Real(share) * (core.vertices[edge.b] - core.vertices[edge.a]);
  return {world(axis + Real(radius_) * normal), normal.cast<double>()};
}

SurfacePoint RaySampler::onCylinder() { return onEdgeOfCore(false); }
SurfacePoint RaySampler::onSeam() { return onEdgeOfCore(true); }

SurfacePoint RaySampler::onSphere() {
  const std::size_t v = random_.below(facetsAtVertex_.size());
  Vec3 normal = Vec3::Zero();
  for (const std::uint32_t f : facetsAtVertex_[v])
    normal += Real(random_.uniform(1e-6, 1)) * oracle_.planes()[f].normal;
  normal.normalize();
  return {world(oracle_.core().vertices[v] + Real(radius_) * normal), normal.cast<double>()};
}

SurfacePoint RaySampler::onSurface() {
  const double pick = random_.uniform();
  return pick < 0.2 ? onFlat() : pick < 0.6 ? onCylinder() : onSphere();
}

Vector3d RaySampler::onEdgeOfSolid(Vector3d& along) {
  const auto& loop = solid_.faces[random_.below(solid_.faces.size())];
  const std::size_t i = random_.below(loop.size());
  const Vector3d a = solid_.vertices[loop[i]], b = solid_.vertices[loop[(i + 1) % loop.size()]];
  along = (b - a).normalized();
  return a + random_.uniform() * (b - a);
}

Ray RaySampler::towards(const Vector3d& target, const Vector3d& from, double distance) {
  const double speed = random_.uniform() < 0.5 ? 1 : random_.logUniform(0.1, 10);
  const Vector3d origin = target + from * distance;
  return {origin, (target - origin).normalized() * speed};
}

Ray RaySampler::grid() {
  Vector3d origin;
  for (int i = 0; i < 3; ++i)
    origin[i] = lower_[i] + (upper_[i] - lower_[i]) * (double(random_.below(17)) - 4) / 8;
  Vector3d direction = Vector3d::Unit(Eigen::Index(random_.below(3)));
  const double pick = random_.uniform();
  if (pick < 0.25)
    onEdgeOfSolid(direction);
  else if (pick < 0.5)
    direction = oracle_.planes()[random_.below(solid_.faces.size())].normal.cast<double>();
  if (random_.uniform() < 0.5) direction = -direction;
  return {origin, direction};
}

Ray RaySampler::alongEdge() {
  Vector3d along;
  const Vector3d p = onEdgeOfSolid(along);
  const Nearest near = oracle_.nearest(p.cast<Real>());
  const double depth = random_.uniform(-0.2, 1.1) * double(near.distance - Real(radius_));
  const double start = random_.uniform() < 0.5 ? 0 : 2 * diagonal_;
  if (random_.uniform() < 0.5) along = -along;
  return {p - near.normal.cast<double>() * depth - along * start, along};
}

Ray RaySampler::sample(RayKind kind) {
  Vector3d along;
  switch (kind) {
  case RayKind::Distant: {
    const Vector3d target = oracle_.centre() + random_.direction() * (random_.uniform(0, 0.6) * diagonal_);
    return towards(target, random_.direction(), random_.uniform(1, 4) * diagonal_);
  }
  case RayKind::Far10:
  case RayKind::Far100: {
    const SurfacePoint p = onSurface();
    return towards(p.position, inHemisphere(p.normal), (kind == RayKind::Far10 ? 10 : 100) * diagonal_);
  }
  case RayKind::Edge: {
    const Vector3d p = onEdgeOfSolid(along);
    const Vector3d target = p + random_.direction() * (radius_ * random_.logUniform(1e-4, 2));
    return towards(target, inHemisphere(p - oracle_.centre()), random_.uniform(1, 3) * diagonal_);
  }
  case RayKind::GrazingEdge: {
    const Vector3d p = onEdgeOfSolid(along);
    const Vector3d outward = oracle_.nearest(p.cast<Real>()).normal.cast<double>();
    const Vector3d tangent = outward.cross(random_.direction()).normalized();
    const Vector3d from = (tangent + outward * random_.logUniform(1e-6, 0.3)).normalized();
    return towards(p + random_.direction() * (radius_ * random_.logUniform(1e-4, 2)), from,
                   random_.uniform(1, 3) * diagonal_);
  }
  case RayKind::Corner: {
    const Vector3d p = solid_.vertices[random_.below(solid_.vertices.size())];
    const Vector3d target = p + random_.direction() * (radius_ * random_.logUniform(1e-4, 3));
    return towards(target, inHemisphere(p - oracle_.centre()), random_.uniform(1, 3) * diagonal_);
  }
  case RayKind::Tangent: {
    const SurfacePoint p = onSurface();
    const double height = random_.logUniform(1e-7, 1e-2) * (random_.uniform() < 0.5 ? diagonal_ : -diagonal_);
    const Vector3d tangent = p.normal.cross(random_.direction()).normalized();
    return towards(p.position + p.normal * height, tangent, random_.uniform(1, 3) * diagonal_);
  }
  case RayKind::Inside: {
    Vector3d sum = Vector3d::Zero();
    double total = 0;
    for (const Vector3d& v : solid_.vertices) {
      const double weight = std::pow(random_.uniform(), 4);
      sum += weight * (v - oracle_.centre());
      total += weight;
    }
    return {oracle_.centre() + sum / total, random_.direction() * random_.logUniform(0.1, 10)};
  }
  case RayKind::Sliver: {
    const bool corner = random_.uniform() < 0.3;
    const Vector3d p = corner ? solid_.vertices[random_.below(solid_.vertices.size())] : onEdgeOfSolid(along);
    const Nearest near = oracle_.nearest(p.cast<Real>());
    const double depth = random_.uniform() * double(near.distance - Real(radius_));
    return {p - near.normal.cast<double>() * depth, random_.direction()};
  }
  case RayKind::AxisParallel:
    return grid();
  case RayKind::AlongEdge:
    return alongEdge();
  case RayKind::Seam: {
    const SurfacePoint p = onSeam();
    return towards(p.position, inHemisphere(p.normal), random_.uniform(1, 3) * diagonal_);
  }
  }
  return {};
}

std::vector<Ray> RaySampler::sample(RayKind kind, std::size_t count) {
  std::vector<Ray> rays(count);
  for (Ray& ray : rays)
    ray = sample(kind);
  return rays;
}

std::vector<Ray> RaySampler::mixed(std::size_t count) {
  std::vector<Ray> rays(count);
  for (std::size_t i = 0; i < count; ++i)
    rays[i] = sample(kRayKinds[i % kRayKinds.size()]);
  return rays;
}

} // namespace chamfer::oracle
