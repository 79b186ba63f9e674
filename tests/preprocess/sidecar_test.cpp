#include "common/sidecar.h"

#include "common/error.h"
#include "preprocess/preprocess.h"
#include "tests/oracle/convex_families.h"
#include "tests/support/mesh_of.h"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <random>
#include <sys/stat.h>

namespace chamfer {
namespace {

class SidecarTest : public testing::Test {
protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("chamfer-sidecar-" + std::to_string(::getpid()) + "-" +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
    PreprocessOptions options;
    options.radius = parseRadius("1%");
    const oracle::ConvexSolid solids[] = {oracle::cube(), oracle::prism(40, 1), oracle::octahedron()};
    result_ = preprocess(meshOf(solids), options);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  static std::vector<std::byte> bytesOf(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    const std::vector<char> text{std::istreambuf_iterator<char>(in), {}};
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
  }

  std::filesystem::path folder_;
  PreprocessResult result_;
};

ErrorKind refusal(std::span<const std::byte> bytes, const Digest* expected = nullptr) {
  try {
    parseSidecar(bytes, expected);
  } catch (const Error& e) {
    return e.kind();
  }
  return ErrorKind::Internal;
}

TEST_F(SidecarTest, ComesBackAsItWas) {
  const auto path = folder_ / "a.chamfer";
  const std::size_t size = writeSidecar(path, *result_.rounding);
  EXPECT_EQ(size, std::filesystem::file_size(path));
  EXPECT_EQ(size, serializedSize(*result_.rounding));
  const Digest digest = result_.rounding->meshDigest();
  const auto read = readSidecar(path, &digest);
  const RoundingView &a = result_.rounding->view(), &b = read->view();
  EXPECT_EQ(a.solidCount(), b.solidCount());
  EXPECT_TRUE(std::ranges::equal(a.spheres, b.spheres));
  EXPECT_TRUE(std::ranges::equal(a.facetOfTriangle, b.facetOfTriangle));
  EXPECT_EQ(read->options(), result_.rounding->options());
  EXPECT_GT(b.treeNodes.size(), 0u) << "the prism's caps have 40 cylinders each";
}

TEST_F(SidecarTest, TwoRunsWriteTheSameBytesAndLeaveNothingElse) {
  writeSidecar(folder_ / "a.chamfer", *result_.rounding);
  writeSidecar(folder_ / "b.chamfer", *result_.rounding);
  EXPECT_EQ(bytesOf(folder_ / "a.chamfer"), bytesOf(folder_ / "b.chamfer"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 2);
}

TEST_F(SidecarTest, EveryTruncationIsDamage) {
  writeSidecar(folder_ / "a.chamfer", *result_.rounding);
  const auto bytes = bytesOf(folder_ / "a.chamfer");
  for (std::size_t size = 0; size < bytes.size(); size += size < 256 ? 1 : 37)
    EXPECT_EQ(refusal(std::span(bytes).first(size)), ErrorKind::DamagedSidecar) << size;
}

TEST_F(SidecarTest, EveryFlippedBitIsDamage) {
  writeSidecar(folder_ / "a.chamfer", *result_.rounding);
  auto bytes = bytesOf(folder_ / "a.chamfer");
  for (std::size_t i = 0; i < bytes.size(); i += i < 256 ? 1 : 13)
    for (const int bit : {0, 7}) {
      bytes[i] ^= std::byte(1 << bit);
      EXPECT_EQ(refusal(bytes), ErrorKind::DamagedSidecar) << "byte " << i << " bit " << bit;
      bytes[i] ^= std::byte(1 << bit);
    }
}

TEST_F(SidecarTest, AnotherMeshMakesItStale) {
  writeSidecar(folder_ / "a.chamfer", *result_.rounding);
  const Digest other{1, 2};
  EXPECT_EQ(refusal(bytesOf(folder_ / "a.chamfer"), &other), ErrorKind::StaleSidecar);
}

TEST_F(SidecarTest, KeepsTheOptionsThatItWasMadeWith) {
  PreprocessOptions options;
  options.radius = parseRadius("3%");
  options.tolerances = {1e-5, 2e-4, 3e-3};
  options.clamp = 0.7;
  options.onNonConvex = OnNonConvex::Hull;
  const auto made = preprocess(meshOf(oracle::cube()), options);
  writeSidecar(folder_ / "a.chamfer", *made.rounding);
  const RoundingOptions kept = readSidecar(folder_ / "a.chamfer")->options();
  EXPECT_EQ(kept, (RoundingOptions{0.03, true, OnNonConvex::Hull, 1e-5, 2e-4, 3e-3, 0.7}));
  const PreprocessOptions again = optionsOf(kept);
  EXPECT_EQ(recordOf(again), kept);
}

TEST_F(SidecarTest, OptionsOutOfRangeAreDamage) {
  const auto refused = [&](auto&& change) {
    RoundingOptions options = result_.rounding->options();
    change(options);
    const RoundingView& v = result_.rounding->view();
    RoundingArrays a;
    a.solids.assign(v.solids.end() - 1, v.solids.end());
    a.solids[0] = {};
    writeSidecar(folder_ / "a.chamfer", *makeRounding(std::move(a), {}, options));
    return refusal(bytesOf(folder_ / "a.chamfer")) == ErrorKind::DamagedSidecar;
  };
  EXPECT_FALSE(refused([](RoundingOptions&) {}));
  EXPECT_TRUE(refused([](RoundingOptions& o) { o.radius = 0; }));
  EXPECT_TRUE(refused([](RoundingOptions& o) { o.radius = INFINITY; }));
  EXPECT_TRUE(refused([](RoundingOptions& o) { o.weld = -1e-9; }));
  EXPECT_TRUE(refused([](RoundingOptions& o) { o.planarity = NAN; }));
  EXPECT_TRUE(refused([](RoundingOptions& o) { o.convexity = 0.2; }));
  EXPECT_TRUE(refused([](RoundingOptions& o) { o.clamp = 1; }));
  EXPECT_TRUE(refused([](RoundingOptions& o) { o.onNonConvex = OnNonConvex(3); }));
}

TEST_F(SidecarTest, AnOlderLayoutIsNamedWithTheCommandThatMakesItAnew) {
  // Version 1: without the 48 bytes of options, and with its own checksum of the header.
  writeSidecar(folder_ / "cube.obj.chamfer", *result_.rounding);
  auto bytes = bytesOf(folder_ / "cube.obj.chamfer");
  bytes.erase(bytes.begin() + 32, bytes.begin() + 80);
  bytes[8] = std::byte(1);
  const std::uint64_t sum = checksumOf(std::span(bytes).first(160));
  std::memcpy(bytes.data() + 160, &sum, sizeof sum);
  std::ofstream(folder_ / "cube.obj.chamfer", std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
  for (const auto& load : {readSidecar, loadSidecar})
    try {
      load(folder_ / "cube.obj.chamfer", nullptr);
      FAIL() << "accepted";
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::StaleSidecar);
      EXPECT_NE(std::string(e.what()).find("older chamferprep"), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find("chamferprep cube.obj --radius"), std::string::npos) << e.what();
    }
  bytes[40] ^= std::byte(1);
  EXPECT_EQ(refusal(bytes), ErrorKind::DamagedSidecar) << "an older one that is damaged is damaged";
}

TEST_F(SidecarTest, WrongIndicesAreFoundBehindRightChecksums) {
  // Each change keeps the file well formed; only the invariants tell.
  const auto refused = [&](auto&& change) {
    const RoundingView& v = result_.rounding->view();
    RoundingArrays a;
    a.solids.assign(v.solids.begin(), v.solids.end());
    a.facets.assign(v.facets.begin(), v.facets.end());
    a.spheres.assign(v.spheres.begin(), v.spheres.end());
    a.packed.assign(v.packed.begin(), v.packed.end());
    a.wide.assign(v.wide.begin(), v.wide.end());
    a.treeRoots.assign(v.treeRoots.begin(), v.treeRoots.end());
    a.treeNodes.assign(v.treeNodes.begin(), v.treeNodes.end());
    a.facetOfTriangle.assign(v.facetOfTriangle.begin(), v.facetOfTriangle.end());
    change(a);
    const auto path = folder_ / "changed.chamfer";
    writeSidecar(path, *makeRounding(std::move(a), {}, result_.rounding->options()));
    return refusal(bytesOf(path)) == ErrorKind::DamagedSidecar;
  };
  EXPECT_FALSE(refused([](RoundingArrays&) {}));
  EXPECT_TRUE(refused([](RoundingArrays& a) { a.packed[3].twin = 60000; }));
  EXPECT_TRUE(refused([](RoundingArrays& a) { a.packed[3].twin = 3; }));
  EXPECT_TRUE(refused([](RoundingArrays& a) { a.packed[3].sphere = 8; }));
  EXPECT_TRUE(refused([](RoundingArrays& a) { std::swap(a.packed[0].sphere, a.packed[1].sphere); }));
  EXPECT_TRUE(refused([](RoundingArrays& a) { a.packed[0].facet = 1; }));
  EXPECT_TRUE(refused([](RoundingArrays& a) { a.facets[0].first = 4; }));
  EXPECT_TRUE(refused([](RoundingArrays& a) { a.facets[0].solid = 1; }));
  EXPECT_TRUE(refused([](RoundingArrays& a) { a.facets[0].normal.x = 3; }));
  EXPECT_TRUE(refused([](RoundingArrays& a) { a.spheres[0].near.x = NAN; }));
  EXPECT_TRUE(refused([](RoundingArrays& a) { a.solids[0].radius = -1; }));
  EXPECT_TRUE(refused([](RoundingArrays& a) { a.solids[1].firstFacet = 4000; }));
  EXPECT_TRUE(refused([](RoundingArrays& a) { a.solids[0].halfEdgeCount = 22; }));
  EXPECT_TRUE(refused([](RoundingArrays& a) { a.facetOfTriangle[0] = 4000; }));
  EXPECT_TRUE(refused([](RoundingArrays& a) {
    for (TreeNode& node : a.treeNodes)
      if (node.leaf()) node.bits = 3u; // half-edge 0 is of another facet
  }));
  EXPECT_TRUE(refused([](RoundingArrays& a) {
    for (TreeNode& node : a.treeNodes)
      if (node.leaf()) node.bits = 100'000u << 2 | 3u;
  }));
  EXPECT_TRUE(refused([](RoundingArrays& a) { a.treeNodes[0].bits = 0; }));
  EXPECT_TRUE(refused([](RoundingArrays& a) { a.treeRoots.pop_back(); }));
}

TEST_F(SidecarTest, SizeIsWithinBudgetForManyBoxes) {
  std::vector<oracle::ConvexSolid> boxes(500, oracle::cube());
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for (auto& v : boxes[i].vertices)
      v.x() += 2 * double(i);
  PreprocessOptions options;
  options.radius = parseRadius("1%");
  const auto result = preprocess(meshOf(boxes), options);
  EXPECT_LE(double(serializedSize(*result.rounding)) / double(result.report.roundedEdges), 48.0);
}

TEST_F(SidecarTest, SizeIsWithinBudgetForManySides) {
  for (const unsigned sides : {40u, 200u, 400u})
    for (const double radius : {0.01, 0.3}) {
      PreprocessOptions options;
      options.radius.value = radius;
      const auto result = preprocess(meshOf(oracle::prism(sides, 1)), options);
      EXPECT_LE(double(serializedSize(*result.rounding)) / double(result.report.roundedEdges), 48.0) << sides;
    }
}

TEST_F(SidecarTest, AFolderThatCannotBeWrittenIsNamed) {
  try {
    writeSidecar(folder_ / "missing" / "a.chamfer", *result_.rounding);
    FAIL() << "written";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::CannotWrite);
    EXPECT_NE(std::string(e.what()).find((folder_ / "missing" / "a.chamfer").string()), std::string::npos);
  }
}

} // namespace
} // namespace chamfer
