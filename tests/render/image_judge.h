// Are noisy images the same but for noise? As the library of comparisons judges it: sign flips of the
// differences between independent renders, at the scales of pixels, blocks and the whole.
#pragma once

#include "server/render/path/render.h"

#include <string>
#include <vector>

namespace chamfer::test {

/// Independent renders of one image: other seeds, each unbiased.
using ImageSeries = std::vector<Image>;

struct Verdict {
  bool same = false;
  std::string text; ///< what decided
};

/// Both of as many renders, at least 16; of other seeds, or each of `b` of the same seed as that of `a`.
/// Values that are not finite, and other sizes, are never the same.
Verdict judge(const ImageSeries& a, const ImageSeries& b);

/// The chance of calling what is the same different.
inline constexpr double kImageSignificance = 0.01;

} // namespace chamfer::test
