#include "server/http/catalogue/prepared_cache.h"

#include "common/error.h"
#include "preprocess/rounding/explicit_mesh.h"
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

TEST_F(PreparedCacheTest, BuildEndsSoonAfterItsClientHasGone) {
  folder_.write("row.obj", test::rowObj(24)); // 12.6 million triangles: many seconds
  folder_.round("row.obj", 0.1);
  const auto row = loadScene(folder_.path() / "row.obj", folder_.path(), "row");
  PreparedCache cache(1u << 30, 1);
  const auto begin = std::chrono::steady_clock::now();
  const auto leaves = [&] {
    return std::chrono::steady_clock::now() - begin > std::chrono::milliseconds(200);
  };
  try {
    cache.get(row, {RoundingMode::Mesh, 256, {}}, leaves);
    ADD_FAILURE() << "built, too quick for this test";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::Cancelled);
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(1200));
  EXPECT_EQ(cache.state().entries, 0u);
}

TEST_F(PreparedCacheTest, HierarchyEndsSoonAfterItsClientHasGone) {
  const ExplicitMesh fine = explicitMesh(scene_->meshes[0].rounding->view(), *scene_->meshes[0].mesh, 256);
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->positions = fine.positions;
  mesh->triangles = fine.triangles;
  std::atomic<int> asked = 0;
  try {
    makeTracedMesh(mesh, [&] { return ++asked > 3; });
    ADD_FAILURE() << "built although it was cancelled";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::Cancelled);
  }
  EXPECT_NE(makeTracedMesh(mesh), nullptr) << "the next is built as ever";
}

TEST_F(PreparedCacheTest, WhoWaitsIsServedWhenTheBuilderHasGone) {
  PreparedCache cache(1u << 30, 1);
  const RoundingChoice fine{RoundingMode::Mesh, 128, {}};
  std::atomic<bool> gone = false;
  std::jthread builder([&] { EXPECT_THROW(cache.get(scene_, fine, [&] { return gone.load(); }), Error); });
  while (cache.state().builds == 0)
    std::this_thread::yield();
  std::jthread waiter([&] { EXPECT_NE(cache.get(scene_, fine, kNever), nullptr); });
  while (cache.state().hits == 0)
    std::this_thread::yield();
  gone = true;
  builder.join();
  waiter.join();
  EXPECT_EQ(cache.state().builds, 2u);
  EXPECT_EQ(cache.state().entries, 1u);
}

} // namespace
} // namespace chamfer::http
