// Cases carried out, on made-up renders whose truth is known.
#include "server/jobs/compare/compare_suite.h"

#include "tests/jobs/fake_host.h"
#include "tests/jobs/picture_of.h"
#include "tests/support/temporary_folder.h"

#include <cmath>
#include <gmock/gmock.h>
#include <limits>

namespace chamfer {
namespace {

using test::pictureOf;
using test::thrownBy;
using testing::HasSubstr;

class CompareCase : public testing::Test {
protected:
  CompareCase() {
    host.add("grey.obj", [](unsigned, unsigned) { return 1.f; });
    host.add("grey", [](unsigned, unsigned) { return 1.f; });
    host.add("bright.obj", [](unsigned, unsigned) { return 1.005f; });
    host.add("spot.obj", [](unsigned x, unsigned y) { return x == 5 && y == 3 ? 1.2f : 1.f; });
    control.version = "1.2.3";
    control.threads = 1;
  }

  CaseChoice caseOf(const std::string& a, const std::string& b) const {
    CaseChoice c;
    c.name = "case";
    c.a = parseSide(a);
    c.b = parseSide(b);
    c.width = 32;
    c.height = 24;
    c.statistics.resolution = {3, 1, 0.05};
    return c;
  }
  CaseResult run(const CaseChoice& c) { return compareCase(c, host, control); }
  CaseResult run(const std::string& a, const std::string& b) { return run(caseOf(a, b)); }
  void image(const std::string& name, const Picture& picture) const {
    writePicture(folder.path() / name, picture);
  }
  static Picture flat(unsigned width, unsigned height, unsigned channels, float value) {
    return pictureOf(width, height, channels,
                     std::vector<float>(std::size_t(width) * height * channels, value));
  }

  test::TemporaryFolder folder;
  test::FakeHost host{folder.path()};
  CompareControl control;
};

TEST_F(CompareCase, FindsSmallDifferencesOfPairedSeeds) {
  for (const char* other : {"bright.obj", "spot.obj"}) {
    const CaseResult r = run(other, "grey.obj");
    EXPECT_EQ(r.outcome, Outcome::Differs) << other << ": " << r.reason;
    EXPECT_EQ(r.a.seeds, 16u) << "the first look is enough";
    ASSERT_TRUE(r.statistics);
    EXPECT_THAT(r.statistics->method, HasSubstr("same seeds"));
  }
}

TEST_F(CompareCase, SaysSameOfOtherSeedsOfOneScene) {
  const CaseResult r = run("grey.obj", "grey.obj?seed=1000");
  EXPECT_EQ(r.outcome, Outcome::Same) << r.reason;
  EXPECT_EQ(r.a.mean.channels, 3u) << "the alpha of beauty says nothing";
  EXPECT_EQ(r.metrics.size(), metricRows().size());
  EXPECT_TRUE(r.largest);
}

TEST_F(CompareCase, CannotTellWhereTheBudgetEnds) {
  CaseChoice c = caseOf("grey.obj", "grey.obj?seed=1000");
  c.statistics.resolution = {1e-3, 1e-3, 1e-3};
  c.seeds = 40;
  const CaseResult r = run(c);
  EXPECT_EQ(r.outcome, Outcome::CannotTell);
  EXPECT_EQ(r.a.seeds, 32u) << "the last look within it";
  EXPECT_THAT(r.reason, HasSubstr("budget"));
  c.seconds = 1e-9;
  const CaseResult early = run(c);
  EXPECT_EQ(early.outcome, Outcome::CannotTell);
  EXPECT_EQ(early.a.seeds, 1u);
  EXPECT_THAT(early.reason, HasSubstr("seconds"));
  c.limits = {{Metric::Rmse, 0.5}};
  c.wantsStatistics = false;
  EXPECT_EQ(run(c).outcome, Outcome::CannotTell) << "limits are not judged before the first look";
}

TEST_F(CompareCase, RendersEqualSettingsOnce) {
  const CaseResult r = run("grey.obj?seed=0", "grey.obj?rounding=analytic");
  EXPECT_EQ(r.outcome, Outcome::Same);
  EXPECT_EQ(host.renders, 2u) << "one of either side: the same bits, or it would be told";
  EXPECT_THAT(r.warnings, testing::ElementsAre(HasSubstr("same render")));

  host.renders = 0;
  const SeedStore store(folder.path() / "seeds");
  control.store = &store;
  run("grey.obj", "bright.obj");
  EXPECT_EQ(host.renders, 32u);
  run("grey.obj", "spot.obj");
  EXPECT_EQ(host.renders, 48u) << "the grey seeds are there";
}

TEST_F(CompareCase, GoesOnWhereItWasStopped) {
  const CaseChoice c = caseOf("spot.obj", "grey.obj");
  const CaseResult whole = run(c);
  const SeedStore store(folder.path() / "seeds");
  control.store = &store;
  host.interrupt = [&] {
    if (host.renders == 32 + 9) throw Error(ErrorKind::Cancelled, "stopped");
  };
  EXPECT_THAT(thrownBy([&] { run(c); }), HasSubstr("cancelled"));
  host.renders = 0;
  const CaseResult resumed = run(c);
  EXPECT_EQ(host.renders, 32u - 8u);
  EXPECT_EQ(resumed.reason, whole.reason);
  EXPECT_EQ(resumed.statistics->levels[0].pValue, whole.statistics->levels[0].pValue);
}

TEST_F(CompareCase, RendersADamagedSeedAgain) {
  const SeedStore store(folder.path() / "seeds");
  control.store = &store;
  const CaseResult first = run("spot.obj", "grey.obj");
  host.renders = 0;
  for (const auto& entry : std::filesystem::directory_iterator(store.folder()))
    std::filesystem::resize_file(entry.path(), 100);
  EXPECT_EQ(run("spot.obj", "grey.obj").reason, first.reason);
  EXPECT_EQ(host.renders, 32u);
}

TEST_F(CompareCase, JudgesLimitsInsteadOfStatistics) {
  CaseChoice c = caseOf("bright.obj", "grey.obj");
  c.limits = {{Metric::BiasPercent, 1}, {Metric::Rmse, 0.1}};
  const CaseResult same = run(c);
  EXPECT_EQ(same.outcome, Outcome::Same) << same.reason;
  EXPECT_FALSE(same.statistics);
  c.limits = {{Metric::BiasPercent, 0.1}};
  const CaseResult differs = run(c);
  EXPECT_EQ(differs.outcome, Outcome::Differs);
  EXPECT_THAT(differs.reason, HasSubstr("bias_percent is 0.5"));
  EXPECT_THAT(differs.reason, HasSubstr("at most 0.1 %"));
}

TEST_F(CompareCase, ComparesSinglePicturesExactly) {
  CaseChoice c = caseOf("grey.obj", "grey.obj?seed=1");
  c.seeds = 1;
  EXPECT_EQ(run(c).outcome, Outcome::Differs);
  c = caseOf("/v1/scenes/grey/tiles/32x24/4,2,8,16/0-4.exr", "/v1/scenes/grey/frames/32x24/0-4.exr");
  c.seeds = 1;
  const CaseResult tile = run(c);
  EXPECT_EQ(tile.outcome, Outcome::Same) << tile.reason;
  EXPECT_EQ(tile.region.crop, (TileRect{4, 2, 8, 16}));
}

TEST_F(CompareCase, KeepsAndJudgesReferences) {
  CaseChoice c = caseOf("grey.obj", "reference.exr");
  acceptCase(c, host, control);
  const Picture reference = readPicture(folder.path() / "reference.exr");
  EXPECT_EQ(reference.variance.size(), reference.values.size());
  EXPECT_EQ(reference.about.at("chamfer:version"), "1.2.3");
  EXPECT_EQ(reference.about.at("chamfer:samples"), "512");
  EXPECT_EQ(reference.about.at("chamfer:seeds"), "0-128");

  c.a = parseSide("grey.obj?seed=5000");
  const CaseResult same = run(c);
  EXPECT_EQ(same.outcome, Outcome::Same) << same.reason;
  EXPECT_TRUE(same.b.stale.empty()) << same.b.stale;
  c.a = parseSide("bright.obj?seed=5000");
  c.seeds = 512;
  c.statistics.resolution.image = 0.004;
  const CaseResult differs = run(c);
  EXPECT_EQ(differs.outcome, Outcome::Differs) << differs.reason;
  EXPECT_THAT(differs.b.stale, HasSubstr("another scene"));
  std::swap(c.a, c.b);
  const CaseResult turned = run(c);
  EXPECT_EQ(turned.outcome, Outcome::Differs) << "the reference may be either side";
  ASSERT_TRUE(turned.statistics);
  EXPECT_LT(turned.statistics->levels.back().a, turned.statistics->levels.back().b)
      << "b is the brighter one";

  control.version = "1.2.4";
  c = caseOf("grey.obj?bounces=3", "reference.exr");
  EXPECT_THAT(run(c).b.stale, testing::AllOf(HasSubstr("version 1.2.3"), HasSubstr("other settings")));
}

TEST_F(CompareCase, JudgesTheBitsOfADigest) {
  CaseChoice c = caseOf("grey.obj", "digest:00000000000000000000000000000000");
  const CaseResult before = run(c);
  EXPECT_EQ(before.outcome, Outcome::Differs);
  const std::string accepted = acceptCase(c, host, control);
  EXPECT_THAT(before.reason, HasSubstr(accepted.substr(7)));
  c.b = parseSide(accepted);
  EXPECT_EQ(run(c).outcome, Outcome::Same);
  c.a = parseSide("spot.obj");
  EXPECT_EQ(run(c).outcome, Outcome::Differs) << "one pixel";
}

TEST_F(CompareCase, LooksAtItsRegionOnly) {
  CaseChoice c = caseOf("spot.obj", "grey.obj");
  c.region.except = {{5, 3, 1, 1}};
  EXPECT_EQ(run(c).outcome, Outcome::Same);
  c.region.except.clear();
  c.region.crop = TileRect{6, 0, 20, 20};
  EXPECT_EQ(run(c).outcome, Outcome::Same);
  c.region.crop = TileRect{0, 0, 6, 4};
  EXPECT_EQ(run(c).outcome, Outcome::Differs);
  Picture mask = flat(32, 24, 1, 1);
  mask.values[3 * 32 + 5] = 0;
  image("mask.exr", mask);
  c.region.crop.reset();
  c.region.mask = "mask.exr";
  EXPECT_EQ(run(c).outcome, Outcome::Same);
}

TEST_F(CompareCase, ComparesImages) {
  image("a.exr", flat(8, 8, 3, 0.5f));
  image("b.exr", flat(8, 8, 3, 0.5f));
  image("c.exr", flat(8, 8, 3, 0.51f));
  EXPECT_EQ(run("a.exr", "b.exr").outcome, Outcome::Same);
  EXPECT_EQ(run("a.exr", "c.exr").outcome, Outcome::Differs) << "equality is asked";
  CaseChoice c = caseOf("a.exr", "c.exr");
  c.limits = {{Metric::MaxError, 0.02}};
  EXPECT_EQ(run(c).outcome, Outcome::Same);
  c.limits.clear();
  c.wantsStatistics = true;
  EXPECT_THAT(run(c).reason, HasSubstr("need the variance"));
}

TEST_F(CompareCase, IsAnErrorNeverAPass) {
  const auto reasonOf = [&](const CaseChoice& c) {
    const CaseResult r = run(c);
    EXPECT_EQ(r.outcome, Outcome::Error) << r.reason;
    return r.reason;
  };
  const auto reason = [&](const std::string& a, const std::string& b) { return reasonOf(caseOf(a, b)); };
  image("small.exr", flat(8, 8, 3, 1));
  image("wide.exr", flat(9, 8, 3, 1));
  image("grey.exr", flat(32, 24, 1, 1));
  image("alpha.exr", flat(8, 8, 4, 1));
  Picture broken = flat(8, 8, 3, 1);
  broken.values[7] = std::numeric_limits<float>::quiet_NaN();
  image("nan.exr", broken);
  broken.values[7] = std::numeric_limits<float>::infinity();
  image("inf.exr", broken);
  folder.write("text.png", "no image");

  EXPECT_THAT(reason("grey.obj", "missing.exr"),
              testing::AllOf(HasSubstr("side b"), HasSubstr("missing.exr")));
  EXPECT_THAT(reason("grey.obj", "text.png"), HasSubstr("text.png"));
  EXPECT_THAT(reason("nothing.obj", "grey.obj"), HasSubstr("no such scene"));
  EXPECT_THAT(reason("small.exr", "wide.exr"), HasSubstr("8x8"));
  EXPECT_THAT(reason("grey.obj", "small.exr"), HasSubstr("other sizes"));
  EXPECT_THAT(reason("small.exr", "alpha.exr"), HasSubstr("channels"));
  EXPECT_THAT(reason("grey.obj", "grey.exr"), HasSubstr("channel"));
  EXPECT_THAT(reason("small.exr", "nan.exr"), HasSubstr("no finite number"));
  EXPECT_THAT(reason("nan.exr", "nan.exr"), HasSubstr("no finite number"));
  EXPECT_THAT(reason("inf.exr", "small.exr"), HasSubstr("no finite number"));
  EXPECT_THAT(reason("grey.obj?seed=0", "grey.obj?seed=100"), HasSubstr("overlap"));
  EXPECT_THAT(reason("grey.obj?seed=4294967290", "bright.obj?seed=4294967290"), HasSubstr("4294967295"));
  EXPECT_THAT(
      reason("/v1/scenes/grey/tiles/32x24/0,0,8,8/0-1.exr", "/v1/scenes/grey/tiles/32x24/8,8,8,8/0-1.exr"),
      HasSubstr("in common"));

  CaseChoice c = caseOf("grey.obj", "bright.obj");
  c.region.mask = "small.exr";
  EXPECT_THAT(reasonOf(c), HasSubstr("mask"));
  image("black.exr", flat(32, 24, 1, 0));
  c.region.mask = "black.exr";
  EXPECT_THAT(reasonOf(c), HasSubstr("empty"));
  c.region.mask.clear();
  c.region.crop = TileRect{30, 0, 8, 8};
  EXPECT_THAT(reasonOf(c), HasSubstr("beyond"));
  host.nonFinite = 3;
  EXPECT_THAT(reason("grey.obj", "bright.obj"), HasSubstr("3 samples that are no finite numbers"));
}

TEST_F(CompareCase, TakesAnImageOfATilesSizeForThatTile) {
  host.add("half", [](unsigned x, unsigned) { return x < 16 ? 1.f : 0.f; });
  image("tile.exr", flat(8, 8, 3, 0));
  CaseChoice c = caseOf("/v1/scenes/half/tiles/32x24/16,8,8,8/0-4.exr", "tile.exr");
  c.seeds = 1;
  const CaseResult r = run(c);
  EXPECT_EQ(r.outcome, Outcome::Same) << r.reason;
  EXPECT_EQ(r.region.crop, (TileRect{16, 8, 8, 8}));
}

TEST_F(CompareCase, TakesTheFrameOfItsImage) {
  image("big.exr", flat(48, 20, 3, 1));
  CaseChoice c = caseOf("grey.obj", "big.exr");
  c.width = c.height = 0;
  c.limits = {{Metric::BiasPercent, 50}};
  const CaseResult r = run(c);
  EXPECT_EQ(r.outcome, Outcome::Same) << r.reason;
  EXPECT_EQ(r.a.mean.width, 48u);
}

TEST_F(CompareCase, OfASuiteTellsAllAndTheWorst) {
  std::vector<CaseChoice> cases = {caseOf("grey.obj", "grey.obj"), caseOf("spot.obj", "grey.obj"),
                                   caseOf("grey.obj", "missing.exr")};
  SuiteControl suite;
  suite.each = control;
  suite.commandOf = [](const CaseChoice& c) { return "again " + c.name; };
  std::vector<std::size_t> finished;
  suite.finished = [&](std::size_t i, const CaseResult&) { finished.push_back(i); };
  const SuiteResult result = compareSuite(cases, host, suite);
  ASSERT_EQ(result.cases.size(), 3u);
  EXPECT_EQ(result.outcome(), Outcome::Error);
  EXPECT_EQ(result.cases[1].outcome, Outcome::Differs);
  EXPECT_EQ(result.cases[0].command, "again case");
  EXPECT_THAT(finished, testing::ElementsAre(0u, 1u, 2u));
  EXPECT_EQ(result.program, "chamferd 1.2.3");
  cases.pop_back();
  EXPECT_EQ(compareSuite(cases, host, suite).outcome(), Outcome::Differs);
}

} // namespace
} // namespace chamfer
