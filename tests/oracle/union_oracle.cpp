#include "tests/oracle/union_oracle.h"

#include <Eigen/LU>
#include <algorithm>
#include <limits>

namespace chamfer::oracle {

void UnionOracle::add(std::shared_ptr<const RoundedOracle> solid, const Affine& worldFromObject) {
  const Eigen::Matrix<Real, 3, 3> inverse = worldFromObject.linear.cast<Real>().inverse();
  parts_.push_back({std::move(solid), inverse, -(inverse * worldFromObject.offset.cast<Real>())});
}

Ray UnionOracle::toObject(const Part& part, const Ray& ray) const {
  return {(part.objectFromWorld * ray.origin.cast<Real>() + part.offset).cast<double>(),
          (part.objectFromWorld * ray.direction.cast<Real>()).cast<double>(), ray.tnear};
}

Hit UnionOracle::placed(std::size_t part, const End& end) const {
  return {end.t, (parts_[part].objectFromWorld.transpose() * end.normal).normalized(), end.feature, part};
}

/// Where a ray from within leaves the body; nothing where it does not begin within.
std::optional<Hit> UnionOracle::lastExit(const Ray& ray) const {
  std::optional<Hit> exit;
  Real reached = ray.tnear;
  for (bool further = true; further;) {
    further = false;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const Ray local = toObject(parts_[i], ray);
      const auto inside = parts_[i].solid->interval(local);
      const Real touch =
          exit ? touch_ * parts_[i].solid->diagonal() / local.direction.cast<Real>().norm() : 0;
      if (!inside || inside->in.t > reached + touch || inside->out.t <= reached) continue;
      reached = inside->out.t;
      exit = placed(i, inside->out);
      further = true;
    }
  }
  return exit;
}

std::optional<Hit> UnionOracle::firstHit(const Ray& ray) const {
  if (touch_ >= 0)
    if (const auto exit = lastExit(ray)) return exit;
  std::optional<Hit> best;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const auto end = parts_[i].solid->firstEndBeyond(toObject(parts_[i], ray));
    if (!end || (best && best->t <= end->t)) continue;
    best = placed(i, *end);
  }
  return best;
}

NearestShare UnionOracle::nearest(std::size_t part, const Vec3& worldPoint) const {
  const Part& p = parts_[part];
  const Nearest n = p.solid->nearest(p.objectFromWorld * worldPoint + p.offset);
  const Real diagonal = p.solid->diagonal();
  return {(n.distance - p.solid->radius()) / diagonal, n.seamDistance / diagonal, n.seamMotion,
          (p.objectFromWorld.transpose() * n.normal).normalized(), n.feature};
}

Real UnionOracle::ambiguity(const Ray& ray) const {
  Real least = std::numeric_limits<Real>::infinity();
  std::vector<std::pair<Real, Real>> ends; // t and how much of its diagonal a unit of t is
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Part& part = parts_[i];
    const Ray local = toObject(part, ray);
    least = std::min(least, std::abs(part.solid->silhouetteMargin(local)) / part.solid->diagonal());
    const auto inside = part.solid->interval(local);
    if (!inside) continue;
    const Real share = local.direction.cast<Real>().norm() / part.solid->diagonal();
    const std::size_t others = ends.size();
    // Across the surface: along a ray that grazes, the end next to its beginning may be far away.
    least = std::min(least, std::abs(nearest(i, ray.at(ray.tnear)).offSurface));
    for (const Real t : {inside->in.t, inside->out.t}) {
      for (std::size_t k = 0; k < others; ++k) {
        const Real apart = std::abs(t - ends[k].first) * std::min(share, ends[k].second);
        if (apart > touch_) least = std::min(least, apart); // what coincides in one body leaves no doubt
      }
      ends.emplace_back(t, share);
    }
  }
  return least;
}

} // namespace chamfer::oracle
