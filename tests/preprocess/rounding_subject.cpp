#include "tests/preprocess/rounding_subject.h"

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
    : solids_(solids.begin(), solids.end()) {
  PreprocessOptions options;
  options.radius.value = radius;
  options.threads = 1;
  const TriangleMesh mesh = meshOf(solids);
  result_ = preprocess(mesh, options);
  std::size_t triangle = 0;
  for (const oracle::ConvexSolid& solid : solids) {
    facetOfFace_.emplace_back();
    centres_.push_back(solid.centroid());
    planes_.push_back(solid.planes(centres_.back()));
    for (const auto& face : solid.faces) {
      // A fan's thinnest triangles may lie in a neighbour's facet as well; the largest speaks for the face.
      double largest = -1;
      std::uint32_t facet = kNone;
      for (std::size_t k = 1; k + 1 < face.size(); ++k, ++triangle) {
        const Point3& a = mesh.positions[mesh.triangles[triangle][0]];
        const double area = lengthSquared(cross(mesh.positions[mesh.triangles[triangle][1]] - a,
                                                mesh.positions[mesh.triangles[triangle][2]] - a));
        if (area > largest) {
          largest = area;
          facet = view().facetOfTriangle[triangle];
        }
      }
      facetOfFace_.back().push_back(facet);
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
      // Either triangle must give the same answer, but a far ray's is asked of the front one.
      std::size_t side = t[0] > ray.tnear ? 0 : 1;
      const double bound = view().solids[s].boundRadius;
      if (side == 0 && lengthSquared(inFrame(s, ray).origin - Point3()) < bound * bound)
        side = hashOf(ray) & 1;
      const Candidate candidate{facetOfFace_[s][face[side]], double(float(t[side]))};
      const auto end =
          firstEndBeyond(view(), candidate, {point(ray.origin), vector(ray.direction)}, ray.tnear);
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
