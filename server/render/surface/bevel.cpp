#include "server/render/surface/bevel.h"

#include "server/render/path/warp.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace chamfer {
namespace {

/// Surfaces that one probe may meet; Cycles keeps four. Of more, those found first stand for all.
constexpr std::size_t kMostHits = 16;

Vector3 triangleNormal(const TriangleMesh& mesh, std::uint32_t triangle) {
  const auto& t = mesh.triangles[triangle];
  const Point3& a = mesh.positions[t[0]];
  return cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a);
}

/// Unit and outward; zero for a triangle without area.
Vector3 outwardNormal(const BevelMesh& bevel, std::uint32_t triangle) {
  const std::uint32_t facet = bevel.rounding.facetOfTriangle[triangle];
  if (facet != kNone) return Vector3(bevel.rounding.facets[facet].normal);
  const Vector3 n = triangleNormal(bevel.mesh, triangle);
  return lengthSquared(n) > 0 ? normalize(n) : Vector3();
}

/// The axes of the three disks; the first is the one along which this probe runs.
struct ProbeFrame {
  std::array<Vector3, 3> axes;
  std::array<double, 3> chance; ///< of being the first
};

/// `u` picks the axis and is stretched to [0, 1) again.
ProbeFrame pickAxis(const Vector3& normal, double& u) {
  const Frame f{Vector3f(normal)};
  const Vector3 x(f.x), y(f.y);
  if (u < 0.5) {
    u *= 2;
    return {{normal, x, y}, {0.5, 0.25, 0.25}};
  }
  if (u < 0.75) {
    u = (u - 0.5) * 4;
    return {{x, y, normal}, {0.25, 0.25, 0.5}};
  }
  u = (u - 0.75) * 4;
  return {{y, normal, x}, {0.25, 0.5, 0.25}};
}

} // namespace

double bevelFalloff(double radius, double r) {
  if (!(r < radius)) return 0;
  const double left = (radius - r) / radius;
  return 10 * left * left * left / (std::numbers::pi * radius * radius);
}

double sampleBevelDistance(double radius, double u) {
  // The share within x = r / R is 10 x^2 - 20 x^3 + 15 x^4 - 4 x^5; Newton's steps from sqrt(u / 10), where
  // it is below u, kept within the bracket.
  double low = 0, high = 1, x = std::min(std::sqrt(u / 10), 0.5);
  for (int step = 0; step < 12; ++step) {
    const double share = x * x * (10 + x * (-20 + x * (15 - 4 * x))), left = 1 - x;
    (share < u ? low : high) = x;
    const double next = x - (share - u) / (20 * x * left * left * left);
    const double bounded = next > low && next < high ? next : (low + high) / 2;
    if (std::abs(bounded - x) < 1e-7) break;
    x = bounded;
  }
  return x * radius;
}

Vector3 bevelNormal(const BevelMesh& bevel, std::uint32_t triangle, const Point3& p, const Vector3& normal,
                    unsigned probes, const Sampler& sampler, std::uint32_t firstPair) {
  const std::uint32_t facet = bevel.rounding.facetOfTriangle[triangle];
  if (facet == kNone) return normal;
  const double radius = bevel.rounding.solids[bevel.rounding.facets[facet].solid].radius;
  Vector3 sum;
  for (unsigned i = 0; i < probes; ++i) {
    const Float2 u = sampler.pair(firstPair + i);
    double turn = double(u.x);
    const ProbeFrame frame = pickAxis(normal, turn);
    const double angle = 2 * std::numbers::pi * turn, r = sampleBevelDistance(radius, double(u.y));
    const double half = std::sqrt(std::max(0.0, radius * radius - r * r));
    const Vector3 aside = frame.axes[1] * (r * std::cos(angle)) + frame.axes[2] * (r * std::sin(angle));
    const Ray probe{p + aside + frame.axes[0] * half, -frame.axes[0]};
    std::array<MeshHit, kMostHits> hits;
    const std::size_t met = allHits(bevel.traced, probe, 2 * half, hits), kept = std::min(met, kMostHits);
    for (std::size_t h = 0; h < kept; ++h) {
      const Vector3 n = outwardNormal(bevel, hits[h].triangle);
      double squares = 0, first = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double density = frame.chance[axis] * std::abs(dot(frame.axes[axis], n));
        squares += density * density;
        if (axis == 0) first = density;
      }
      if (!(first > 0)) continue;
      const double distance = length(probe.at(hits[h].t) - p);
      sum += n * (first / squares * bevelFalloff(radius, distance) / bevelFalloff(radius, r) * double(met) /
                  double(kept));
    }
  }
  const double size = length(sum);
  if (!(size > 0)) return normal;
  sum = sum / size;
  return dot(outwardNormal(bevel, triangle), normal) < 0 ? -sum : sum; // a mesh wound inside out
}

} // namespace chamfer
