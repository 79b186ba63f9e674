#include "tests/render/image_judge.h"

#include "common/error.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

namespace chamfer::test {
namespace {

constexpr unsigned kBlockSides[] = {1, 8, 1u << 30};

/// Means over blocks of `side` pixels, [rows][columns][3].
struct Blocks {
  unsigned columns = 0, rows = 0;
  std::vector<double> mean;
};

Blocks blocksOf(const Image& image, unsigned side) {
  Blocks b;
  b.columns = (image.width - 1) / side + 1;
  b.rows = (image.height - 1) / side + 1;
  b.mean.assign(std::size_t(b.columns) * b.rows * 3, 0);
  std::vector<unsigned> pixels(std::size_t(b.columns) * b.rows, 0);
  for (unsigned y = 0; y < image.height; ++y)
    for (unsigned x = 0; x < image.width; ++x) {
      const std::size_t block = std::size_t(y / side) * b.columns + x / side;
      ++pixels[block];
      for (std::size_t c = 0; c < 3; ++c)
        b.mean[3 * block + c] += double(image.rgba[4 * (std::size_t(y) * image.width + x) + c]);
    }
  for (std::size_t i = 0; i < b.mean.size(); ++i)
    b.mean[i] /= pixels[i / 3];
  return b;
}

/// Chance that Student's t exceeds |t|, on either side. With t = sqrt(n) tan(a) the density is cos^(n-1) a.
double studentTail(double t, double degrees) {
  const auto area = [&](double from) {
    constexpr int kSteps = 4000;
    const double step = (std::numbers::pi / 2 - from) / kSteps;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i)
      sum += std::pow(std::cos(from + (i + 0.5) * step), degrees - 1);
    return sum * step;
  };
  return area(std::atan(std::abs(t) / std::sqrt(degrees))) / area(0);
}

} // namespace

void ImageSeries::add(const Image& render) {
  if (render.width != width_ || render.height != height_)
    throw Error(ErrorKind::OutOfRange, "a series' renders are of one size");
  for (std::size_t level = 0; level < kLevels; ++level) {
    const Blocks b = blocksOf(render, kBlockSides[level]);
    levelSums_[level].resize(b.mean.size());
    squares_[level].resize(b.mean.size());
    for (std::size_t i = 0; i < b.mean.size(); ++i) {
      levelSums_[level][i] += b.mean[i];
      squares_[level][i] += b.mean[i] * b.mean[i];
    }
  }
  ++count_;
}

Image ImageSeries::mean() const {
  Image image{width_, height_, std::vector<float>(std::size_t(width_) * height_ * 4, 1)};
  for (std::size_t i = 0; i < levelSums_[0].size(); ++i)
    image.rgba[4 * (i / 3) + i % 3] = float(levelSums_[0][i] / count_);
  return image;
}

struct ImageJudge {
  /// Variance of one render's block means. Of few renders a pixel's own is unreliable (none of them may have
  /// met the rare path that another meets): the mean over its neighbourhood counts where it is larger.
  static std::vector<double> variances(const ImageSeries& s, std::size_t level, unsigned columns,
                                       unsigned rows) {
    const double n = s.count_;
    std::vector<double> own(s.squares_[level].size()), all = own;
    for (std::size_t i = 0; i < own.size(); ++i) {
      const double mean = s.levelSums_[level][i] / n;
      // A floor for float32: what never varies may differ in its last places.
      own[i] = std::max((s.squares_[level][i] / n - mean * mean) * n / (n - 1), 1e-10 * mean * mean);
    }
    for (unsigned y = 0; y < rows; ++y)
      for (unsigned x = 0; x < columns; ++x)
        for (std::size_t c = 0; c < 3; ++c) {
          double sum = 0;
          int near = 0;
          for (unsigned v = y == 0 ? 0 : y - 1; v <= std::min(y + 1, rows - 1); ++v)
            for (unsigned u = x == 0 ? 0 : x - 1; u <= std::min(x + 1, columns - 1); ++u, ++near)
              sum += own[3 * (std::size_t(v) * columns + u) + c];
          const std::size_t i = 3 * (std::size_t(y) * columns + x) + c;
          all[i] = std::max(own[i], sum / near);
        }
    return all;
  }

  /// `series`: the renders behind `image`, or null where they are `count` like the reference's.
  static Verdict run(const ImageSeries& reference, const Image& image, const ImageSeries* series,
                     unsigned count) {
    if (std::min(reference.count_, series ? series->count_ : reference.count_) < 8)
      throw Error(ErrorKind::OutOfRange, "a judgement needs series of at least 8 renders");
    if (image.width != reference.width_ || image.height != reference.height_)
      return {false, 0, "another size"};
    for (const float v : image.rgba)
      if (!std::isfinite(v)) return {false, 0, "a value is not finite"};
    Verdict worst{true, 1, "identical"};
    for (std::size_t level = 0; level < ImageSeries::kLevels; ++level) {
      const Blocks blocks = blocksOf(image, kBlockSides[level]);
      const auto variance = variances(reference, level, blocks.columns, blocks.rows);
      const auto others = series ? variances(*series, level, blocks.columns, blocks.rows) : variance;
      double largest = 0;
      std::size_t where = 0;
      for (std::size_t i = 0; i < variance.size(); ++i) {
        const double difference = blocks.mean[i] - reference.levelSums_[level][i] / reference.count_;
        if (difference == 0) continue;
        const double t = std::abs(difference) / std::sqrt(variance[i] / reference.count_ + others[i] / count);
        if (!(t <= largest)) largest = t, where = i; // also where nothing varies: t is infinite
      }
      // All levels are tests of their own: three times as many.
      const double tests = double(variance.size()) * ImageSeries::kLevels;
      const double degrees = (series ? std::min(reference.count_, count) : reference.count_) - 1;
      const double p = -std::expm1(tests * std::log1p(-studentTail(largest, degrees)));
      if (p >= worst.pValue) continue;
      std::ostringstream s;
      s << "level " << level << ", block " << where / 3 % blocks.columns << "," << where / 3 / blocks.columns
        << " channel " << where % 3 << ": " << blocks.mean[where] << " against "
        << reference.levelSums_[level][where] / reference.count_ << ", t = " << largest << ", p = " << p
        << " after Sidak";
      worst = {p >= kImageSignificance, p, s.str()};
    }
    return worst;
  }
};

Verdict judge(const ImageSeries& reference, const Image& image, unsigned count) {
  return ImageJudge::run(reference, image, nullptr, count);
}

Verdict judge(const ImageSeries& reference, const ImageSeries& series) {
  return ImageJudge::run(reference, series.mean(), &series, series.count());
}

} // namespace chamfer::test
