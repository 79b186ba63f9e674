// The oracle's lines: the smallest and the largest t over everything that R is made of.
#include "tests/oracle/rounded_oracle.h"

#include <algorithm>
#include <limits>

namespace chamfer::oracle {
namespace {

constexpr Real kInfinity = std::numeric_limits<Real>::infinity();

/// Squared distance of ball centres from the line, in double, against their squared radius with a margin
/// above double's rounding noise.
template <class Visit>
void visitNearLine(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& z,
                   const std::vector<double>& radius, const Line& line, double size, const Visit& visit) {
  const Eigen::Vector3d o = line.origin.cast<double>(), u = line.direction.cast<double>();
  const double noise = 1e-13 * size * size;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double dx = x[i] - o.x(), dy = y[i] - o.y(), dz = z[i] - o.z();
    const double along = dx * u.x() + dy * u.y() + dz * u.z();
    if (dx * dx + dy * dy + dz * dz - along * along <= radius[i] * radius[i] * (1 + 1e-12) + noise) visit(i);
  }
}

} // namespace

struct RoundedOracle::Best {
  End in{kInfinity, Vec3::Zero(), Feature::Flat};
  End out{-kInfinity, Vec3::Zero(), Feature::Flat};
  /// `normalAt` gives the outward normal where the line is at t.
  template <class NormalAt>
  void take(Real t, Feature feature, const NormalAt& normalAt) {
    if (t < in.t) in = {t, normalAt(), feature};
    if (t > out.t) out = {t, normalAt(), feature};
  }
};

RoundedOracle::Placed RoundedOracle::place(const Ray& ray) const {
  const Vec3 direction = ray.direction.cast<Real>();
  const Real speed = direction.norm();
  const Vec3 unit = direction / speed;
  const Vec3 from = ray.origin.cast<Real>() - centre_.cast<Real>();
  const Real shift = -from.dot(unit);
  return {{from + shift * unit, unit}, shift, speed};
}

void RoundedOracle::testFlats(const Line& line, Best& best) const {
  // A flat lies on P's surface, which a line crosses only where it enters its last and leaves its first
  // half-space.
  Real enter = -kInfinity, leave = kInfinity;
  for (const Plane& plane : planes_) {
    const Real rate = plane.normal.dot(line.direction);
    const Real t = (plane.offset - plane.normal.dot(line.origin)) / rate;
    if (rate < 0) enter = std::max(enter, t);
    if (rate > 0) leave = std::min(leave, t);
  }
  const Real noise = diagonal_ * 1e-15L;
  if (enter > leave + noise) return;
  for (std::uint32_t f = 0; f < planes_.size(); ++f) {
    const Plane& plane = planes_[f];
    const Real rate = plane.normal.dot(line.direction);
    if (rate == 0) continue;
    const Real t = (plane.offset - plane.normal.dot(line.origin)) / rate;
    if (rate < 0 ? t < enter - noise : t > leave + noise) continue;
    if (insideFace(f, line.at(t) - radius_ * plane.normal))
      best.take(t, Feature::Flat, [&] { return plane.normal; });
  }
}

void RoundedOracle::testSpheres(const Line& line, Best& best) const {
  visitNearLine(balls_.x, balls_.y, balls_.z, balls_.radius, line, double(bound_), [&](std::size_t v) {
    const Vec3& centre = core_.vertices[v];
    if (const auto chord = chordOfBall(line, centre, radius_))
      for (const Real t : {chord->in, chord->out})
        best.take(t, Feature::Sphere, [&]() -> Vec3 { return (line.at(t) - centre).normalized(); });
  });
}

void RoundedOracle::testCylinders(const Line& line, Best& best) const {
  const Balls& c = capsules_;
  visitNearLine(c.x, c.y, c.z, c.radius, line, double(bound_), [&](std::size_t e) {
    const Segment& segment = segments_[e];
    const auto chord = chordOfCylinder(line, segment.a, segment.axis, radius_);
    if (!chord) return;
    for (const Real t : {chord->in, chord->out}) {
      const Vec3 from = line.at(t) - segment.a;
      const Real s = from.dot(segment.axis);
      if (s < 0 || s > segment.length) continue;
      best.take(t, Feature::Cylinder, [&]() -> Vec3 { return (from - s * segment.axis).normalized(); });
    }
  });
}

std::optional<Interval> RoundedOracle::interval(const Ray& ray) const {
  const Placed placed = place(ray);
  if (placed.line.origin.norm() > bound_ * (1 + 1e-12L)) return {};
  Best best;
  testFlats(placed.line, best);
  testSpheres(placed.line, best);
  testCylinders(placed.line, best);
  if (!(best.in.t <= best.out.t)) return {};
  for (End* end : {&best.in, &best.out})
    end->t = (end->t + placed.shift) / placed.speed;
  return Interval{best.in, best.out};
}

std::optional<End> RoundedOracle::firstEndBeyond(const Ray& ray) const {
  const auto inside = interval(ray);
  if (!inside) return {};
  if (inside->in.t > ray.tnear) return inside->in;
  if (inside->out.t > ray.tnear) return inside->out;
  return {};
}

Real RoundedOracle::silhouetteMargin(const Ray& ray) const {
  const Line line = place(ray).line;
  const Real outside = line.origin.norm() - bound_;
  if (outside > bound_ / 10) return outside;
  Real enter = -kInfinity, leave = kInfinity;
  for (const Plane& plane : planes_) {
    const Real rate = plane.normal.dot(line.direction);
    const Real height = plane.normal.dot(line.origin) - plane.offset + radius_;
    if (rate < 0)
      enter = std::max(enter, -height / rate);
    else if (rate > 0)
      leave = std::min(leave, -height / rate);
    else if (height > 0)
      leave = -kInfinity;
  }
  if (enter <= leave) return -radius_;
  // A line and a convex polyhedron that do not meet are nearest at an edge (or at its ends).
  Real distance = kInfinity;
  for (const Segment& segment : segments_)
    distance = std::min(distance, distanceToSegment(line, segment.a, segment.axis, segment.length));
  return distance - radius_;
}

} // namespace chamfer::oracle
