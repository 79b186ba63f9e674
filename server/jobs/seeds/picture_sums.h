// Means of seeds, and how exact they are.
#pragma once

#include "server/jobs/image/picture.h"

#include <vector>

namespace chamfer {

class PictureSums {
public:
  void add(const Picture& seed);
  unsigned count() const { return count_; }
  /// With the variance of the mean where there are two seeds or more. At least one was added.
  Picture mean() const;

private:
  unsigned count_ = 0;
  Picture first_; ///< sums are about it: what is squared is small
  std::vector<double> sums_, squares_;
};

} // namespace chamfer
