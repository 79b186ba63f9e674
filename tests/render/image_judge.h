// Is a noisy image the same as a reference but for noise? Student's t-tests of pixels, of blocks of pixels
// and of the whole image against the reference's own variance, with Sidak's correction for their number, as
// in Mitsuba 3's test_renders.py; pixels find what is local, blocks and the whole find what is small.
#pragma once

#include "server/render/path/render.h"

#include <array>
#include <string>
#include <vector>

namespace chamfer::test {

/// Independent renders of one image (other seeds, each unbiased), and how much they differ.
class ImageSeries {
public:
  ImageSeries(unsigned width, unsigned height) : width_(width), height_(height) {}
  /// Of the series' size. Throws Error(OutOfRange) for another.
  void add(const Image& render);
  unsigned count() const { return count_; }
  /// Mean of the renders; alpha 1.
  Image mean() const;

private:
  friend struct ImageJudge;
  static constexpr std::size_t kLevels = 3; ///< pixels, blocks of 8 x 8, the whole
  unsigned width_, height_, count_ = 0;
  std::array<std::vector<double>, kLevels> levelSums_; ///< by level, [rows][columns][3] of blocks
  std::array<std::vector<double>, kLevels> squares_;   ///< of the means of blocks
};

struct Verdict {
  bool same = false;
  double pValue = 0; ///< chance of a misfit this bad, somewhere, if the images are the same
  std::string text;  ///< the worst place and its figures
};

/// Judges an image that is the mean of `count` renders like those of the reference. The reference must have
/// at least 8. Values that are not finite, and other sizes, are never the same.
Verdict judge(const ImageSeries& reference, const Image& image, unsigned count);
/// Judges one series against another (Welch): each has its own variance, so that a rare bright path that only
/// one of them has met counts as the noise that it is. Both must have at least 8 renders.
Verdict judge(const ImageSeries& reference, const ImageSeries& series);

/// Verdicts below this are a failure.
inline constexpr double kImageSignificance = 0.01;

} // namespace chamfer::test
