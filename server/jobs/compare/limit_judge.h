// Is a metric of two noisy means beyond its limit? Three answers. Noise makes pictures differ more than their
// true means do, so that the measured value alone says little.
//
// Seeds are gathered in eight groups. The delete-group jackknife gives the value's standard error; means
// whose groups' differences are added with balanced signs hold the noise of the measured means and no true
// difference: their metric is what noise alone would give. Metrics that are norms of the difference keep the
// triangle inequality: the true value is at least the measured one less that of the noise. Of failing_share
// pixels are taken for surely failing, and for surely not, only where their own noise leaves no doubt.
#pragma once

#include "server/jobs/compare/result.h"
#include "server/jobs/image/region.h"

#include <utility>
#include <vector>

namespace chamfer {

class LimitJudge {
public:
  using Limits = std::vector<std::pair<Metric, double>>;
  /// `significance`: of all limits and looks together.
  LimitJudge(const Region& region, const PixelTolerance& tolerance, Limits limits, double significance);

  /// One seed of both sides (an image: the same again), of the region's crop.
  void add(const Picture& a, const Picture& b);
  /// In the order of the limits. After one seed values are exact: they are the pictures' own. An image's own
  /// variance, where it has one, counts as noise.
  std::vector<MetricResult> judge() const;

private:
  struct Group {
    Picture a, b; ///< sums
    unsigned seeds = 0;
  };
  struct Bounds {
    double low, high;
  };
  std::pair<Picture, Picture> meansWithout(std::size_t group) const;
  Picture noisy(const Picture& b, std::size_t pattern) const;
  Bounds boundsOf(Metric metric, double value, double standardError, const Picture& a,
                  const Picture& b) const;
  Bounds failingBounds(const Picture& a, const Picture& b) const;
  double critical() const;
  std::size_t groups() const;

  const Region& region_;
  PixelTolerance tolerance_;
  Limits limits_;
  double significance_;
  std::vector<Group> groups_;
  std::vector<float> variance_; ///< of an image's values: of a's and b's together
  unsigned seeds_ = 0;
};

} // namespace chamfer
