// The real meshes beside the project through the whole of preprocessing: what is refused, why, and how deep
// below its hull, against the index that was computed independently.
#include "common/error.h"
#include "preprocess/preprocess.h"
#include "tests/oracle/exact_hull.h"

#include <algorithm>
#include <fstream>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <optional>

namespace chamfer {
namespace {

using testing::AnyOf;

const std::filesystem::path kData = CHAMFER_SOURCE_DIR "/../shared/data";

struct Entry {
  std::string file, note;
  std::vector<double> nonconvexity; ///< of each solid
  double deepest() const { return *std::max_element(nonconvexity.begin(), nonconvexity.end()); }
};

/// What came of a file: a result, or the error that refused it.
struct Outcome {
  std::optional<PreprocessResult> result;
  std::optional<Error> error;
  double detail(const std::string& key) const {
    for (const auto& [k, value] : error->details())
      if (k == key) return value;
    ADD_FAILURE() << "no " << key << " in: " << error->what();
    return 0;
  }
};

/// Whatever is not an Error of ours goes on to the test and fails it.
Outcome outcomeOf(const std::string& file, OnNonConvex onNonConvex = OnNonConvex::Error) {
  PreprocessOptions options;
  options.radius = parseRadius("0.02%");
  options.onNonConvex = onNonConvex;
  try {
    return {preprocess(readMesh(kData / file), options), {}};
  } catch (const Error& e) {
    return {{}, e};
  }
}

/// Depth of a point below a component's convex hull, in diagonals, by the oracle's hull.
class HullDepth {
public:
  explicit HullDepth(const Component& component) : diagonal_(component.bounds.diagonal()) {
    std::vector<Eigen::Vector3d> points;
    for (const Point3& p : component.positions)
      points.emplace_back(p.x, p.y, p.z);
    origin_ = points.front();
    planes_ = oracle::exactHull("component", points, 0).planes(origin_);
  }
  double operator()(const Point3& p) const {
    const Eigen::Vector3d q = Eigen::Vector3d(p.x, p.y, p.z) - origin_;
    double depth = INFINITY;
    for (const oracle::Plane& plane : planes_)
      depth = std::min(depth, double(plane.offset) - plane.normal.cast<double>().dot(q));
    return depth / diagonal_;
  }

private:
  double diagonal_;
  Eigen::Vector3d origin_;
  std::vector<oracle::Plane> planes_;
};

/// Greatest depth over a grid of each triangle, corners and edges included.
double deepestSample(const Component& component, const HullDepth& depthOf) {
  constexpr int kParts = 6;
  double deepest = 0;
  for (const auto& t : component.triangles) {
    const Point3 a = component.positions[t[0]];
    const Vector3 b = component.positions[t[1]] - a, c = component.positions[t[2]] - a;
    for (int i = 0; i <= kParts; ++i)
      for (int k = 0; i + k <= kParts; ++k)
        deepest = std::max(deepest, depthOf(a + b * (double(i) / kParts) + c * (double(k) / kParts)));
  }
  return deepest;
}

bool takesWarpedPolygons(const std::string& file) {
  const auto warnings = readMesh(kData / file).warnings;
  return std::any_of(warnings.begin(), warnings.end(),
                     [](const std::string& w) { return w.find("is warped: ") != std::string::npos; });
}

class RefusalOfRealMeshes : public testing::Test {
protected:
  void SetUp() override {
    std::ifstream index(kData / "index.json");
    if (!index) GTEST_SKIP() << "the real meshes are not beside the project";
    for (const auto& item : nlohmann::json::parse(index)) {
      Entry entry{item.at("file"), item.at("note"), {}};
      for (const auto& solid : item.at("solids"))
        entry.nonconvexity.push_back(solid.at("nonconvexity"));
      folders_[entry.file.substr(0, entry.file.find('/'))].push_back(std::move(entry));
    }
  }
  std::map<std::string, std::vector<Entry>> folders_;
};

TEST_F(RefusalOfRealMeshes, NearConvexOnesAboveTheToleranceWithTheirDepth) {
  const double tolerance = InputTolerances{}.convexity;
  std::size_t refused = 0;
  for (const Entry& entry : folders_["near"]) {
    SCOPED_TRACE(entry.file);
    const Outcome outcome = outcomeOf(entry.file);
    if (takesWarpedPolygons(entry.file)) {
      // The index took polygons as fans. Of two files with warped ones the convex triangulation is within the
      // tolerance, by the oracle's hull.
      EXPECT_THAT(entry.file, AnyOf("near/dex-urdf-meshes-collision-f41.obj",
                                    "near/pybullet-object-models-YcbTennisBall-collision_vhacd.obj"));
      ASSERT_FALSE(outcome.error) << outcome.error->what();
      EXPECT_EQ(outcome.result->report.hulledComponents, 0u);
      for (const Component& component : splitComponents(readMesh(kData / entry.file), {}).list) {
        EXPECT_LE(deepestSample(component, HullDepth(component)), tolerance);
      }
      continue;
    }
    ASSERT_EQ(outcome.error.has_value(), entry.deepest() > tolerance)
        << (outcome.error ? outcome.error->what() : "was rounded") << "; depth " << entry.deepest();
    // The index looked at vertices and some places of the surface: the deepest place lies as deep or deeper.
    if (!outcome.error) {
      EXPECT_GE(outcome.result->report.nonConvexity, 0.999 * entry.deepest());
      EXPECT_LE(outcome.result->report.nonConvexity, tolerance);
      continue;
    }
    ++refused;
    EXPECT_EQ(outcome.error->kind(), ErrorKind::NotConvexSolid);
    const double measure = outcome.detail("measure");
    EXPECT_GT(measure, tolerance);
    const auto number = std::size_t(outcome.detail("component"));
    ASSERT_LE(number, entry.nonconvexity.size());
    EXPECT_GE(measure, 0.999 * entry.nonconvexity[number - 1]);
    const Component component = splitComponents(readMesh(kData / entry.file), {}).list[number - 1];
    const HullDepth depthOf(component);
    EXPECT_NEAR(depthOf({outcome.detail("x"), outcome.detail("y"), outcome.detail("z")}), measure, 1e-6);
    EXPECT_LE(deepestSample(component, depthOf), measure + 1e-6);
  }
  EXPECT_GT(refused, 30u);
}

TEST_F(RefusalOfRealMeshes, ButTheirHullsAreRoundedOnRequest) {
  EXPECT_EQ(folders_["near"].size(), 47u);
  for (const Entry& entry : folders_["near"]) {
    SCOPED_TRACE(entry.file);
    const Outcome outcome = outcomeOf(entry.file, OnNonConvex::Hull);
    ASSERT_TRUE(outcome.result) << outcome.error->what();
    EXPECT_EQ(outcome.result->report.solids, entry.nonconvexity.size());
    EXPECT_EQ(outcome.result->report.hulledComponents > 0,
              entry.deepest() > InputTolerances{}.convexity && !takesWarpedPolygons(entry.file));
    EXPECT_NO_THROW(validate(outcome.result->rounding->view()));
  }
}

TEST_F(RefusalOfRealMeshes, EveryBrokenOneWithTheFaultsName) {
  EXPECT_EQ(folders_["refused"].size(), 60u);
  for (const Entry& entry : folders_["refused"]) {
    SCOPED_TRACE(entry.file + ": " + entry.note);
    const Outcome outcome = outcomeOf(entry.file);
    ASSERT_TRUE(outcome.error) << "was rounded";
    const std::string message = outcome.error->what();
    if (outcome.error->kind() == ErrorKind::Malformed) {
      EXPECT_THAT(message, testing::HasSubstr(std::filesystem::path(entry.file).filename().string()));
      continue;
    }
    EXPECT_EQ(outcome.error->kind(), ErrorKind::NotConvexSolid) << message;
    std::vector<std::string> words;
    for (const FaultKind kind :
         {FaultKind::Open, FaultKind::NonManifold, FaultKind::Misoriented, FaultKind::InsideOut,
          FaultKind::Flat, FaultKind::NotFinite, FaultKind::Concave, FaultKind::SelfIntersecting,
          FaultKind::TooFew, FaultKind::Genus})
      words.push_back(std::string("(") + faultWord(kind) + "): ");
    EXPECT_TRUE(std::any_of(words.begin(), words.end(), [&](const auto& word) {
      return message.find(word) != std::string::npos;
    })) << message;
  }
}

TEST_F(RefusalOfRealMeshes, DoubtfulOnesAreRoundedSoundlyOrRefused) {
  std::size_t rounded = 0;
  for (const Entry& entry : folders_["either"]) {
    SCOPED_TRACE(entry.file + ": " + entry.note);
    const Outcome outcome = outcomeOf(entry.file);
    if (outcome.error) {
      EXPECT_THAT(outcome.error->kind(),
                  AnyOf(ErrorKind::Malformed, ErrorKind::NotConvexSolid, ErrorKind::RadiusTooLarge));
      EXPECT_GT(std::string(outcome.error->what()).size(), 40u);
      continue;
    }
    ++rounded;
    EXPECT_NO_THROW(validate(outcome.result->rounding->view()));
    const PreprocessReport& report = outcome.result->report;
    EXPECT_GT(report.solids, 0u);
    if (entry.note.find("inside out") != std::string::npos ||
        entry.note.find("oriented") != std::string::npos) {
      EXPECT_GT(report.counts.turned + report.counts.turnedTriangles, 0u) << "turned, but not said";
    }
  }
  EXPECT_GT(rounded, 10u);
}

TEST_F(RefusalOfRealMeshes, TwoOfTheCatalogueAreTurned) {
  EXPECT_EQ(folders_["catalogue"].size(), 133u);
  std::size_t turned = 0;
  for (const Entry& entry : folders_["catalogue"]) {
    const Outcome outcome = outcomeOf(entry.file);
    ASSERT_TRUE(outcome.result) << entry.file << ": " << outcome.error->what();
    turned += outcome.result->report.counts.turned;
  }
  EXPECT_EQ(turned, 2u);
}

} // namespace
} // namespace chamfer
