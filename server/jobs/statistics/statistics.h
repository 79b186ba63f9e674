// Are two noisy pictures means of the same thing? Three answers: same, differs, cannot tell yet.
//
// Pictures are rendered seed by seed. At looks planned beforehand (after 16, 32, 64 ... seeds) the
// differences are tested at three scales (pixels, blocks of 8 x 8, the whole); the chance of a false alarm,
// "differs" of pictures that are the same, is at most the stated significance over all looks, scales and
// places together: it is divided evenly among the looks, and at each look one half goes to the pixels and a
// quarter to each other scale.
//
//  - Two renders: sign flips. If the sides are the same, each seed's difference is as likely as its negative,
//  so
//    that the largest studentized difference among all places is compared with what it would be under random
//    signs (Westfall and Young 1993). This asks for nothing of the noise: not that it is normal, nor that
//    places are independent. Where both sides use the same seeds (common random numbers), what does not
//    differ cancels path by path, and small differences stand out from little noise.
//  - A render against an image: z-tests with the noise of both, Student's quantiles and Sidak's correction
//  for the number of
//    places, as in Mitsuba 3's test_renders.py.
//
// "Same" is not the absence of an alarm: simultaneous confidence bounds must show that every true difference
// is below the resolution. All sizes of differences are relative to the brightness of their place: the mean
// magnitude of both sides over the block and its channels, or a tenth of that of the whole picture where that
// is more.
#pragma once

#include "server/jobs/compare/result.h"
#include "server/jobs/image/picture.h"
#include "server/jobs/image/region.h"

#include <functional>
#include <memory>

namespace chamfer {

/// One number for each scale, relative to the brightness of the place.
struct PerLevel {
  double pixel = 0, block = 0, image = 0;
  bool operator==(const PerLevel&) const = default;
};

struct StatisticsChoice {
  double significance = 0.01;
  unsigned mostSeeds = 128; ///< the budget: looks are at kFirstLook times powers of two up to it
  PerLevel tolerance;       ///< true differences up to this are none
  /// "Same" means: every true difference is below this. Infinity: not asked for.
  PerLevel resolution{1.0, 0.1, 0.005};
  bool operator==(const StatisticsChoice&) const = default;
};

inline constexpr unsigned kFirstLook = 16;
/// How many looks a budget allows; at least 1: a smaller budget has a single look at its end.
unsigned looksOf(unsigned mostSeeds);
/// Is there a look after so many seeds?
bool isLook(unsigned seeds, unsigned mostSeeds);
/// The last look of a budget: seeds beyond it are never rendered.
unsigned lastLook(unsigned mostSeeds);

/// Gathers seeds and judges at looks.
class SeedTest {
public:
  virtual ~SeedTest() = default;
  /// The seed's pictures, of the region's crop; `b` is ignored where it is an image.
  virtual void add(const Picture& a, const Picture& b) = 0;
  /// At a look. `threads`: 0: all cores. `cancelled`: asked often, from any thread; true: Error(Cancelled).
  virtual StatisticsResult judge(unsigned threads, const std::function<bool()>& cancelled = {}) const = 0;
};

/// Two renders. `paired`: of the same seeds.
std::unique_ptr<SeedTest> signFlipTest(const Region& region, unsigned channels,
                                       const StatisticsChoice& choice, bool paired);
/// A render of `samplesPerSeed` against an image of the region's crop. Its variance may be unknown: then it
/// is taken as exact. `imageSamples`: of each of its pixels, 0: not known; where it is known, the noise that
/// one side has seen counts for the other, too, which may have missed the rare paths that make it.
std::unique_ptr<SeedTest> referenceTest(const Region& region, const Picture& image,
                                        const StatisticsChoice& choice, unsigned samplesPerSeed,
                                        unsigned imageSamples);

/// Of two images that both know their variance: a single look.
StatisticsResult compareImages(const Region& region, const Picture& a, const Picture& b,
                               const StatisticsChoice& choice);

} // namespace chamfer
