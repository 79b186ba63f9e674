#include "server/http/prepared_cache.h"

#include "common/error.h"
#include "tests/http/scene_folder.h"

#include <gtest/gtest.h>
#include <thread>

namespace chamfer::http {
namespace {

const auto kNever = [] { return false; };

class PreparedCacheTest : public testing::Test {
protected:
  PreparedCacheTest() {
    folder_.addCube("cube.obj");
    scene_ = loadScene(folder_.path() / "cube.obj", folder_.path(), "cube");
  }
  static RoundingChoice radius(double value) { return {RoundingMode::Analytic, 0, value}; }

  test::SceneFolder folder_;
  std::shared_ptr<const Scene> scene_;
};

TEST_F(PreparedCacheTest, BuildsOncePerRounding) {
  PreparedCache cache(1u << 30, 1);
  const auto first = cache.get(scene_, {}, kNever);
  EXPECT_EQ(cache.get(scene_, {}, kNever), first);
  EXPECT_NE(cache.get(scene_, radius(0.2), kNever), first);
  EXPECT_EQ(cache.state().builds, 2u);
  EXPECT_EQ(cache.state().hits, 1u);
  EXPECT_EQ(cache.state().entries, 2u);
}

TEST_F(PreparedCacheTest, BuildsOnceHoweverManyAsk) {
  PreparedCache cache(1u << 30, 1);
  {
    std::vector<std::jthread> clients;
    for (int i = 0; i < 8; ++i)
      clients.emplace_back([&] { EXPECT_NE(cache.get(scene_, radius(0.25), kNever), nullptr); });
  }
  EXPECT_EQ(cache.state().builds, 1u);
  EXPECT_EQ(cache.state().hits, 7u);
}

TEST_F(PreparedCacheTest, DropsTheLeastRecentlyUsed) {
  const std::size_t one = memoryBytes(*prepare(scene_, radius(0.1), 1));
  PreparedCache cache(one * 5 / 2, 1);
  cache.get(scene_, radius(0.1), kNever);
  cache.get(scene_, radius(0.2), kNever);
  cache.get(scene_, radius(0.1), kNever); // now 0.2 is the oldest
  cache.get(scene_, radius(0.3), kNever);
  EXPECT_LE(cache.state().bytes, cache.state().limit);
  const std::size_t builds = cache.state().builds;
  cache.get(scene_, radius(0.1), kNever);
  EXPECT_EQ(cache.state().builds, builds);
  cache.get(scene_, radius(0.2), kNever);
  EXPECT_EQ(cache.state().builds, builds + 1);
}

TEST_F(PreparedCacheTest, OneThatIsTooLargeIsStillServed) {
  PreparedCache cache(1, 1);
  EXPECT_NE(cache.get(scene_, {}, kNever), nullptr);
  EXPECT_NE(cache.get(scene_, radius(0.2), kNever), nullptr);
  EXPECT_EQ(cache.state().entries, 1u);
}

TEST_F(PreparedCacheTest, FailureIsNotKept) {
  PreparedCache cache(1u << 30, 1);
  EXPECT_THROW(cache.get(scene_, radius(0.6), kNever), Error); // the inradius is 0.5
  EXPECT_THROW(cache.get(scene_, radius(0.6), kNever), Error);
  EXPECT_EQ(cache.state().builds, 2u);
  EXPECT_EQ(cache.state().entries, 0u);
  EXPECT_NE(cache.get(scene_, radius(0.4), kNever), nullptr);
}

} // namespace
} // namespace chamfer::http
