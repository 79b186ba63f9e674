#include "server/jobs/seeds/picture_sums.h"

#include "common/error.h"

#include <algorithm>

namespace chamfer {

void PictureSums::add(const Picture& seed) {
  if (count_++ == 0) {
    first_ = seed;
    sums_.assign(seed.values.size(), 0);
    squares_.assign(seed.values.size(), 0);
    return;
  }
  if (seed.values.size() != sums_.size()) throw Error(ErrorKind::Internal, "seeds of different sizes");
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    const double d = double(seed.values[i]) - double(first_.values[i]);
    sums_[i] += d;
    squares_[i] += d * d;
  }
}

Picture PictureSums::mean() const {
  Picture mean = first_;
  const double n = count_;
  for (std::size_t i = 0; i < sums_.size(); ++i)
    mean.values[i] = float(double(first_.values[i]) + sums_[i] / n);
  if (count_ < 2) return mean;
  mean.variance.resize(sums_.size());
  for (std::size_t i = 0; i < sums_.size(); ++i)
    mean.variance[i] = float(std::max(0.0, squares_[i] - sums_[i] * sums_[i] / n) / (n * (n - 1)));
  return mean;
}

} // namespace chamfer
