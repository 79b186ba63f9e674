#include "server/jobs/compare/compare_case.h"

#include "common/error.h"
#include "common/text.h"
#include "server/jobs/compare/limit_judge.h"
#include "server/jobs/compare/reference.h"
#include "server/jobs/compare/side_source.h"
#include "server/jobs/compare/words.h"
#include "server/jobs/seeds/picture_sums.h"

#include <algorithm>
#include <chrono>

namespace chamfer {
namespace {

using Clock = std::chrono::steady_clock;

std::string sizeText(unsigned width, unsigned height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

/// What both parts have; width 0: nothing.
TileRect intersection(const TileRect& a, const TileRect& b) {
  const unsigned x0 = std::max(a.x, b.x), y0 = std::max(a.y, b.y);
  const unsigned x1 = std::min(a.x + a.width, b.x + b.width), y1 = std::min(a.y + a.height, b.y + b.height);
  return x1 > x0 && y1 > y0 ? TileRect{x0, y0, x1 - x0, y1 - y0} : TileRect{};
}

bool isWithin(const TileRect& inner, const TileRect& outer) { return intersection(inner, outer) == inner; }

/// Gives both sides one frame.
void settleFrames(SideSource& a, SideSource& b) {
  for (const auto& [side, other] : {std::pair{&a, &b}, std::pair{&b, &a}})
    if (side->width() == 0) {
      if (other->width() != 0)
        side->takeFrame(other->width(), other->height());
      else
        side->takeFrame(kUsualWidth, kUsualHeight);
    }
  const auto sameFrame = [&] { return a.width() == b.width() && a.height() == b.height(); };
  for (const auto& [image, tile] : {std::pair{&a, &b}, std::pair{&b, &a}})
    if (!sameFrame() && image->couldBe(tile->part()))
      image->beTile(tile->width(), tile->height(), tile->part());
  if (!sameFrame())
    throw Error(ErrorKind::OutOfRange, a.name() + " is " + sizeText(a.width(), a.height()) + " pixels, " +
                                           b.name() + " " + sizeText(b.width(), b.height()) +
                                           "; pictures of other sizes cannot be compared");
}

Region settleRegion(const CaseChoice& choice, CompareHost& host, const SideSource& a, const SideSource& b) {
  const TileRect common = intersection(a.part(), b.part());
  if (common.width == 0)
    throw Error(ErrorKind::OutOfRange, "the sides' tiles have no pixel of the frame in common");
  RegionChoice region = choice.region;
  if (!region.crop) region.crop = common;
  if (!region.mask.empty()) region.mask = host.file(region.mask.string());
  Region result = regionOf(region, a.width(), a.height());
  if (!isWithin(result.crop, common))
    throw Error(ErrorKind::OutOfRange, "the crop goes beyond what both sides have of the frame");
  return result;
}

void settleChannels(SideSource& a, SideSource& b) {
  const auto takeFrom = [](SideSource& render, const SideSource& other) {
    if (render.isRender() && other.channels() >= 3) render.takeChannels(other.channels());
  };
  if (a.isRender() && b.isRender()) {
    const unsigned channels = std::max(a.channels(), b.channels());
    a.takeChannels(channels);
    b.takeChannels(channels);
  } else {
    takeFrom(a, b);
    takeFrom(b, a);
  }
}

/// Seeds of two renders are the same, one by one, or none of them is.
bool arePaired(const SideSource& a, const SideSource& b, unsigned seeds) {
  const std::uint64_t x = a.request().settings.seed, y = b.request().settings.seed;
  if (x == y) return true;
  if (std::max(x, y) - std::min(x, y) >= seeds) return false;
  throw Error(ErrorKind::Usage, "the sides' seeds begin at " + std::to_string(x) + " and " +
                                    std::to_string(y) + " and overlap: give both the same seed, so that " +
                                    "paths are compared one by one, or seeds that are " +
                                    std::to_string(seeds) + " apart or more");
}

void requireSeeds(const SideSource& side, unsigned seeds) {
  if (side.isRender() && std::uint64_t{side.request().settings.seed} + seeds > std::uint64_t{1} << 32)
    throw Error(ErrorKind::OutOfRange, side.name() + ": its seed and " + std::to_string(seeds) +
                                           " seeds from it go beyond 4294967295; begin with a smaller one");
}

/// One case on its way.
class Run {
public:
  Run(const CaseChoice& choice, CompareHost& host, const CompareControl& control, CaseResult& result)
      : choice_(choice), control_(control), result_(result),
        a_("a", choice.a, choice, host, control.store, control.version),
        b_("b", choice.b, choice, host, control.store, control.version) {
    result.a = a_.describe();
    result.b = b_.describe();
    settleFrames(a_, b_);
    settleChannels(a_, b_);
    result.region = settleRegion(choice, host, a_, b_);
    noteStaleness();
  }

  void compare() {
    if (!choice_.renders()) return compareImageFiles();
    if (choice_.b.kind == SideKind::Digest) return compareDigest();
    if (a_.isRender() && b_.isRender() && a_.key(crop()) == b_.key(crop())) {
      result_.warnings.push_back("both sides ask for the same render: it was made once, and is compared "
                                 "with itself");
      return compareOnce();
    }
    if (choice_.budget() < 2) return compareOnce();
    compareSeeds();
  }

private:
  const TileRect& crop() const { return result_.region.crop; }

  void noteStaleness() {
    for (const auto& [image, render] : {std::pair{&a_, &b_}, std::pair{&b_, &a_}}) {
      if (image->isRender() || !render->isRender() || image->image().values.empty()) continue;
      SideResult& side = image == &a_ ? result_.a : result_.b;
      side.stale = staleness(image->image(), *render, control_.version);
      if (!side.stale.empty())
        result_.warnings.push_back("the reference is stale: it was " + side.stale +
                                   "; --update accepts a new one");
    }
  }

  void requireSame(const Picture& a, const Picture& b) const {
    requireComparable(a, b, a_.name(), b_.name());
  }

  /// Pictures as they are, noise and all.
  void compareExactly(Picture a, Picture b) {
    requireSame(a, b);
    // An image's variance says how exact it is; asked for here is the picture itself.
    LimitJudge judge(result_.region, choice_.tolerance, exactLimits(), choice_.statistics.significance);
    Picture x = a, y = b;
    x.variance.clear();
    y.variance.clear();
    judge.add(x, y);
    finish(std::move(a), std::move(b), judge.judge(), 1);
  }

  /// Without limits equality is asked.
  LimitJudge::Limits exactLimits() const {
    return choice_.limits.empty() ? LimitJudge::Limits{{Metric::MaxError, 0}} : choice_.limits;
  }

  void compareOnce() {
    step(0, 1);
    Picture a = a_.seed(0, crop()), b = b_.seed(0, crop());
    step(1, 1);
    compareExactly(std::move(a), std::move(b));
  }

  void compareImageFiles() {
    Picture a = a_.seed(0, crop()), b = b_.seed(0, crop());
    if (!choice_.judgesStatistics()) return compareExactly(std::move(a), std::move(b));
    requireSame(a, b);
    if (a.variance.empty() || b.variance.empty())
      throw Error(ErrorKind::Usage, "statistics of two images need the variance of both, in channels "
                                    "variance.R and so on; give limits instead");
    result_.statistics = compareImages(result_.region, a, b, choice_.statistics);
    LimitJudge judge(result_.region, choice_.tolerance, choice_.limits, choice_.statistics.significance);
    judge.add(a, b);
    finish(std::move(a), std::move(b), judge.judge(), 0);
  }

  void compareDigest() {
    step(0, 1);
    const Picture a = a_.seed(0, crop());
    step(1, 1);
    const Digest digest = pictureDigest(a);
    result_.a.seeds = 1;
    result_.a.mean = a;
    const bool same = digest == choice_.b.digest;
    result_.outcome = same ? Outcome::Same : Outcome::Differs;
    result_.reason = same ? "the render has the reference's bits"
                          : "the render's bits have the digest " + digest.hex() + ", not the reference's";
  }

  void compareSeeds() {
    const unsigned budget = choice_.budget();
    const bool both = a_.isRender() && b_.isRender();
    requireSeeds(a_, budget);
    requireSeeds(b_, budget);
    const bool paired = both && arePaired(a_, b_, budget);
    StatisticsChoice statistics = choice_.statistics;
    statistics.mostSeeds = budget;
    const auto begin = Clock::now();
    const unsigned last = lastLook(budget);

    std::unique_ptr<SeedTest> test;
    LimitJudge judge(result_.region, choice_.tolerance, choice_.limits,
                     statistics.significance / looksOf(budget));
    PictureSums sumA, sumB;
    std::vector<MetricResult> limits;
    for (unsigned k = 0; k < last; ++k) {
      step(k, last);
      const Picture a = a_.seed(k, crop()), b = b_.seed(k, crop());
      if (k == 0) {
        requireSame(a, b);
        if (choice_.judgesStatistics()) test = testOf(a, b, statistics, paired);
      }
      // The noise of an image is its own: it does not fall with the seeds of the other side.
      judge.add(a, b);
      sumA.add(a);
      sumB.add(b);
      if (test) a_.isRender() ? test->add(a, b) : test->add(b, a);
      const unsigned seeds = k + 1;
      const bool outOfTime = choice_.seconds > 0 && seeds < last &&
                             std::chrono::duration<double>(Clock::now() - begin).count() > choice_.seconds;
      if (!isLook(seeds, budget) && !outOfTime) continue;
      if (isLook(seeds, budget)) {
        step(seeds, last);
        if (test) result_.statistics = statisticsOf(*test);
        if (test && !both && equalsImage((a_.isRender() ? sumA : sumB).mean())) acceptAsIdentical();
        limits = judge.judge();
        if (decided(limits)) break;
      }
      if (outOfTime) {
        endEarly(limits, numberText(choice_.seconds) + " seconds were over after " + std::to_string(seeds) +
                             " seeds");
        break;
      }
    }
    const auto meanOf = [](const SideSource& side, const PictureSums& sum, const TileRect& crop) {
      return side.isRender() ? sum.mean() : side.seed(0, crop);
    };
    finish(meanOf(a_, sumA, crop()), meanOf(b_, sumB, crop()), std::move(limits), sumA.count());
  }

  std::unique_ptr<SeedTest> testOf(const Picture& a, const Picture& b, const StatisticsChoice& statistics,
                                   bool paired) const {
    if (a_.isRender() && b_.isRender()) return signFlipTest(result_.region, a.channels, statistics, paired);
    const SideSource& render = a_.isRender() ? a_ : b_;
    const Picture& image = a_.isRender() ? b : a;
    return referenceTest(result_.region, image, statistics, render.request().samples(), samplesOf(image));
  }

  StatisticsResult statisticsOf(const SeedTest& test) const {
    StatisticsResult result = test.judge(control_.threads, control_.cancelled);
    if (!a_.isRender()) // the test's first side is the render
      for (LevelResult& level : result.levels)
        std::swap(level.a, level.b);
    return result;
  }

  /// The seeds that made the reference give it again, bit by bit, where nothing has changed.
  bool equalsImage(const Picture& mean) const {
    return mean.values == (a_.isRender() ? b_ : a_).seed(0, crop()).values;
  }
  void acceptAsIdentical() {
    result_.statistics->identical = true;
    for (LevelResult& level : result_.statistics->levels)
      level.outcome = Outcome::Same;
  }

  Outcome verdict(const std::vector<MetricResult>& limits) const {
    Outcome all = Outcome::Same;
    if (result_.statistics) all = worse(all, result_.statistics->outcome());
    for (const MetricResult& limit : limits)
      all = worse(all, limit.outcome);
    return all;
  }

  bool decided(const std::vector<MetricResult>& limits) const {
    return verdict(limits) != Outcome::CannotTell;
  }

  /// The time was over between looks: what was not decided stays so.
  void endEarly(std::vector<MetricResult>& limits, const std::string& why) {
    ended_ = why;
    if (limits.empty())
      for (const auto& [metric, limit] : choice_.limits) {
        MetricResult open;
        open.metric = metric;
        open.limit = limit;
        open.outcome = Outcome::CannotTell;
        limits.push_back(open);
      }
  }

  void finish(Picture a, Picture b, std::vector<MetricResult> limits, unsigned seeds) {
    const Region& region = result_.region;
    for (const MetricRow& row : metricRows()) {
      const auto judged = std::find_if(limits.begin(), limits.end(),
                                       [&](const MetricResult& m) { return m.metric == row.metric; });
      MetricResult one;
      if (judged != limits.end()) one = *judged;
      one.metric = row.metric;
      one.value = metricOf(row.metric, a, b, region, choice_.tolerance);
      result_.metrics.push_back(one);
    }
    result_.largest = largestError(a, b, region);
    result_.a.seeds = a_.isRender() ? seeds : 0;
    result_.b.seeds = b_.isRender() ? seeds : 0;
    result_.a.mean = std::move(a);
    result_.b.mean = std::move(b);
    result_.outcome = verdict(limits);
    if (!result_.statistics && limits.empty())
      result_.outcome = Outcome::CannotTell; // the time was over before the first look
    result_.reason = reasonText(result_, ended_);
  }

  void step(unsigned done, unsigned most) const {
    if (control_.cancelled && control_.cancelled())
      throw Error(ErrorKind::Cancelled, "the comparison was cancelled");
    if (control_.progress) control_.progress(done, most);
  }

  const CaseChoice& choice_;
  const CompareControl& control_;
  CaseResult& result_;
  SideSource a_, b_;
  std::string ended_; ///< why before the budget of seeds; empty: it did not
};

} // namespace

CaseResult compareCase(const CaseChoice& choice, CompareHost& host, const CompareControl& control) {
  const auto begin = Clock::now();
  CaseResult result;
  result.name = choice.name;
  result.tolerance = choice.tolerance;
  result.a.label = choice.a.text;
  result.b.label = choice.b.text;
  result.a.isRender = choice.a.isRender();
  result.b.isRender = choice.b.isRender();
  try {
    checkCase(choice);
    Run(choice, host, control, result).compare();
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::Cancelled || error.kind() == ErrorKind::Internal) throw;
    result.outcome = Outcome::Error;
    result.reason = error.what();
    result.metrics.clear();
    result.statistics.reset();
  }
  result.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  return result;
}

std::string acceptCase(const CaseChoice& choice, CompareHost& host, const CompareControl& control) {
  checkCase(choice);
  if (!choice.a.isRender() || choice.b.isRender())
    throw Error(ErrorKind::Usage, "a new reference is a render: side a must be one, and side b the "
                                  "reference's file or digest");
  SideSource a("a", choice.a, choice, host, control.store, control.version);
  if (a.width() == 0) a.takeFrame(kUsualWidth, kUsualHeight);
  const bool digest = choice.b.kind == SideKind::Digest;
  // The whole of what side a has: the crop is the comparison's.
  const TileRect part = digest && choice.region.crop ? *choice.region.crop : a.part();
  const unsigned seeds = digest ? 1 : std::max(1u, choice.budget());
  requireSeeds(a, seeds);
  PictureSums sum;
  for (unsigned k = 0; k < seeds; ++k) {
    if (control.cancelled && control.cancelled())
      throw Error(ErrorKind::Cancelled, "the comparison was cancelled");
    if (control.progress) control.progress(k, seeds);
    sum.add(a.seed(k, part));
  }
  if (digest) return "digest:" + pictureDigest(sum.mean()).hex();
  writePicture(host.file(choice.b.source), referenceOf(sum.mean(), a, seeds, control.version));
  return choice.b.text;
}

} // namespace chamfer
