#include "server/http/catalogue/prepared_cache.h"

#include "common/error.h"
#include "preprocess/rounding/explicit_mesh.h"
#include "server/http/routes/problem.h"
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

TEST_F(PreparedCacheTest, WhatIsInUseStaysAndCounts) {
  const std::size_t one = memoryBytes(*prepare(scene_, radius(0.1), 1));
  PreparedCache cache(one * 5 / 2, 1);
  const auto used = cache.get(scene_, radius(0.1), kNever);
  for (int i = 2; i < 6; ++i)
    cache.get(scene_, radius(0.05 * i + 0.05), kNever);
  EXPECT_LE(cache.state().bytes, cache.state().limit);
  EXPECT_EQ(cache.state().entries, 2u);
  const std::size_t builds = cache.state().builds;
  EXPECT_EQ(cache.get(scene_, radius(0.1), kNever), used);
  EXPECT_EQ(cache.state().builds, builds) << "dropping it would have freed nothing";
}

TEST_F(PreparedCacheTest, ExplicitMeshTakesNoMoreThanIsForetold) {
  folder_.write("row.obj", test::rowObj(8));
  folder_.round("row.obj", 0.1);
  const auto row = loadScene(folder_.path() / "row.obj", folder_.path(), "row");
  for (const unsigned segments : {1u, 16u, 48u}) {
    std::uint64_t foretold = 0;
    const MeshBudget budget{UINT64_MAX, [&](std::uint64_t bytes) { foretold = bytes; }};
    const auto fine = prepare(row, {RoundingMode::Mesh, segments, {}}, 1, kNever, budget);
    const auto sharp = prepare(row, {RoundingMode::None, 0, {}}, 1);
    // Beside what the scene takes without it; the hierarchy of few triangles has a share of its own.
    const double taken = double(memoryBytes(*fine)) - double(memoryBytes(*sharp));
    EXPECT_LE(taken, double(foretold) + 20'000) << segments;
    EXPECT_GE(taken, 0.5 * double(foretold)) << segments;
  }
}

TEST_F(PreparedCacheTest, ExplicitMeshBeyondTheBoundNamesTheLargestThatFits) {
  constexpr std::size_t kLimit = 8u << 20;
  PreparedCache cache(kLimit, 1);
  double most = 0;
  try {
    cache.get(scene_, {RoundingMode::Mesh, 256, {}}, kNever);
    ADD_FAILURE() << "built";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::OutOfRange);
    for (const auto& [key, value] : error.details())
      if (key == "largest_segments") most = value;
    EXPECT_NE(std::string(error.what()).find("use mesh:" + std::to_string(int(most))), std::string::npos);
  }
  ASSERT_GT(most, 10);
  EXPECT_EQ(cache.state().entries, 0u);
  EXPECT_EQ(cache.state().bytes, 0u);
  EXPECT_NE(cache.get(scene_, {RoundingMode::Mesh, unsigned(most), {}}, kNever), nullptr);
  EXPECT_GT(cache.state().bytes, kLimit / 2) << "the mesh and its hierarchy count";
  EXPECT_LE(cache.state().bytes, kLimit);
  EXPECT_THROW(cache.get(scene_, {RoundingMode::Mesh, unsigned(most) + 1, {}}, kNever), Error);
}

TEST_F(PreparedCacheTest, ExplicitMeshesInUseLeaveNoRoomForMore) {
  PreparedCache cache(8u << 20, 1);
  const RoundingChoice first{RoundingMode::Mesh, 64, {}}, second{RoundingMode::Mesh, 70, {}};
  auto used = cache.get(scene_, first, kNever);
  try {
    cache.get(scene_, second, kNever);
    ADD_FAILURE() << "built";
  } catch (const ProblemError& error) {
    EXPECT_EQ(error.problem().status, 503);
    EXPECT_GT(error.problem().retryAfterSeconds, 0);
  }
  EXPECT_EQ(cache.state().entries, 1u);
  EXPECT_LE(cache.state().bytes, cache.state().limit);
  used.reset();
  EXPECT_NE(cache.get(scene_, second, kNever), nullptr) << "the first is let go";
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
  PreparedCache cache(std::size_t{4} << 30, 1);
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
