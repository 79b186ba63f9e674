#include "tests/preprocess/rounding_subject.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <limits>

namespace chamfer {
namespace {

Point3 point(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Vector3 vector(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

std::optional<oracle::Answer> answerOf(const std::optional<RoundedEnd>& end) {
  if (!end) return {};
  return oracle::Answer{end->t, {end->normal.x, end->normal.y, end->normal.z}, oracle::Feature(end->feature)};
}

std::uint64_t hashOf(const oracle::Ray& ray) {
  std::uint64_t hash = 0x9e3779b97f4a7c15u;
  for (int i = 0; i < 6; ++i) {
    std::uint64_t bits;
    std::memcpy(&bits, i < 3 ? &ray.origin[i] : &ray.direction[i - 3], sizeof bits);
    hash = (hash ^ bits) * 0xff51afd7ed558ccdu;
    hash ^= hash >> 33;
  }
  return hash;
}

PreprocessOptions absolute(double radius) {
  PreprocessOptions options;
  options.radius.value = radius;
  options.threads = 1;
  return options;
}

/// The triangle that tells best which facet a plane of the hull became: large, and turned and placed as the
/// plane is.
std::uint32_t triangleIn(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles,
                         const oracle::Plane& plane, const Eigen::Vector3d& origin, double diagonal) {
  const Eigen::Vector3d normal = plane.normal.cast<double>();
  double best = 0;
  std::uint32_t found = kNone;
  for (const std::uint32_t t : triangles) {
    Eigen::Vector3d corner[3];
    double away = 0;
    for (int k = 0; k < 3; ++k) {
      const Point3& p = mesh.positions[mesh.triangles[t][std::size_t(k)]];
      corner[k] = Eigen::Vector3d(p.x, p.y, p.z) - origin;
      away = std::max(away, std::abs(normal.dot(corner[k]) - double(plane.offset)));
    }
    const double area = std::abs((corner[1] - corner[0]).cross(corner[2] - corner[0]).dot(normal));
    const double score = area / (1 + std::pow(away / (1e-6 * diagonal), 2));
    if (score > best) {
      best = score;
      found = t;
    }
  }
  return found;
}

} // namespace

static_assert(int(Feature::Flat) == int(oracle::Feature::Flat) &&
              int(Feature::Cylinder) == int(oracle::Feature::Cylinder) &&
              int(Feature::Sphere) == int(oracle::Feature::Sphere));

TriangleMesh meshOf(std::span<const oracle::ConvexSolid> solids) {
  TriangleMesh mesh;
  for (const oracle::ConvexSolid& solid : solids) {
    const auto first = std::uint32_t(mesh.positions.size());
    for (const auto& v : solid.vertices)
      mesh.positions.push_back(point(v));
    for (const auto& face : solid.faces)
      for (std::size_t k = 1; k + 1 < face.size(); ++k) {
        mesh.faceOfTriangle.push_back(std::uint32_t(mesh.triangles.size()));
        mesh.triangles.push_back({first + face[0], first + face[k], first + face[k + 1]});
      }
  }
  return mesh;
}

RoundedSubject::RoundedSubject(std::span<const oracle::ConvexSolid> solids, double radius)
    : RoundedSubject(meshOf(solids), absolute(radius), {solids.begin(), solids.end()}) {}

RoundedSubject::RoundedSubject(const TriangleMesh& mesh, const PreprocessOptions& options,
                               std::vector<oracle::ConvexSolid> hulls)
    : result_(preprocess(mesh, options)), solids_(std::move(hulls)) {
  std::vector<std::vector<std::uint32_t>> trianglesOfSolid(solids_.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::uint32_t facet = view().facetOfTriangle[t];
    if (facet != kNone) trianglesOfSolid.at(view().facets[facet].solid).push_back(t);
  }
  for (std::size_t s = 0; s < solids_.size(); ++s) {
    centres_.push_back(solids_[s].centroid());
    planes_.push_back(solids_[s].planes(centres_.back()));
    facetOfFace_.emplace_back();
    for (const oracle::Plane& plane : planes_.back()) {
      const std::uint32_t t =
          triangleIn(mesh, trianglesOfSolid[s], plane, centres_.back(), solids_[s].diagonal());
      facetOfFace_.back().push_back(t == kNone ? kNone : view().facetOfTriangle[t]);
    }
  }
}

Ray RoundedSubject::inFrame(std::size_t solid, const oracle::Ray& ray) const {
  const double* origin = view().solids[solid].origin;
  return {point(ray.origin - Eigen::Vector3d(origin[0], origin[1], origin[2])), vector(ray.direction)};
}

std::uint32_t RoundedSubject::anyHalfEdge(std::size_t solid, const oracle::Ray& ray) const {
  return std::uint32_t(hashOf(ray) % view().solids[solid].halfEdgeCount);
}

oracle::Subject RoundedSubject::entryOfLine() const {
  return [this](const oracle::Ray& ray) {
    return answerOf(entry(view(), 0, inFrame(0, ray), anyHalfEdge(0, ray)));
  };
}

oracle::Subject RoundedSubject::exitOfReversedLine() const {
  return [this](const oracle::Ray& ray) {
    Ray reversed = inFrame(0, ray);
    reversed.direction = -reversed.direction;
    auto answer = answerOf(exit(view(), 0, reversed, anyHalfEdge(0, ray)));
    if (answer) answer->t = -answer->t;
    return answer;
  };
}

oracle::Subject RoundedSubject::firstEnd() const {
  return [this](const oracle::Ray& ray) {
    std::optional<RoundedEnd> best;
    for (std::size_t s = 0; s < solids_.size(); ++s) {
      // The two triangles that the line crosses the solid's surface by.
      const Eigen::Vector3d from = ray.origin - centres_[s];
      double t[2] = {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
      std::size_t face[2] = {0, 0};
      for (std::size_t f = 0; f < planes_[s].size(); ++f) {
        const Eigen::Vector3d normal = planes_[s][f].normal.cast<double>();
        const double rate = normal.dot(ray.direction);
        if (rate == 0) continue;
        const double at = (double(planes_[s][f].offset) - normal.dot(from)) / rate;
        if (rate < 0 ? at > t[0] : at < t[1]) {
          t[rate > 0] = at;
          face[rate > 0] = f;
        }
      }
      if (t[0] > t[1] || t[1] <= ray.tnear) continue;
      const auto asked = [&](std::size_t side) {
        const Candidate candidate{facetOfFace_[s][face[side]], double(float(t[side]))};
        return firstEndBeyond(view(), candidate, {point(ray.origin), vector(ray.direction)}, ray.tnear);
      };
      // From outside the front triangle speaks. What the back one says there, if anything, must be as true.
      const auto back = asked(1);
      const bool outside = t[0] > ray.tnear;
      const auto end = outside && !(back && (hashOf(ray) & 1)) ? asked(0) : back;
      if (end && (!best || end->t < best->t)) best = end;
    }
    return answerOf(best);
  };
}

Detection RoundedSubject::detectAt(std::size_t solid, std::size_t face, const Eigen::Vector3d& p) const {
  const Ray local = inFrame(solid, {p, Eigen::Vector3d::Zero()});
  return detect(view(), std::uint32_t(solid), facetOfFace_[solid][face], local.origin);
}

} // namespace chamfer
