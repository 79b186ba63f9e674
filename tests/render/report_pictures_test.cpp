// Pictures of scenes after public bug reports of other tools: units, places on the map and mirrors change
// nothing that is seen. The files lie beside the project.
#include "preprocess/preprocess.h"
#include "tests/render/image_judge.h"
#include "tests/render/scene_files_fixture.h"

#include <cmath>
#include <gtest/gtest.h>

namespace chamfer {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

constexpr unsigned kWidth = 64, kHeight = 48;
const RoundingChoice kModes[] = {{RoundingMode::Analytic, 0, {}},
                                 {RoundingMode::None, 0, {}},
                                 {RoundingMode::Mesh, 4, {}},
                                 {RoundingMode::Bevel, 4, {}}};
const char* const kModeWords[] = {"analytic", "none", "mesh:4", "bevel:4"};

fs::path reports(const char* name) {
  const fs::path folder = fs::path(CHAMFER_SOURCE_DIR) / "../shared/data/reports" / name;
  return fs::exists(folder) ? folder : fs::path();
}

Image render(const PreparedScene& prepared, Aov aov, unsigned samples, unsigned seed) {
  RenderSettings s;
  s.width = kWidth;
  s.height = kHeight;
  s.endSample = samples;
  s.maxBounces = 4;
  s.seed = seed;
  s.aov = aov;
  return renderTile(prepared, s, {0, 0, kWidth, kHeight}).image;
}

/// Of `renders` renders with seeds from `firstSeed` on.
test::ImageSeries series(const PreparedScene& prepared, unsigned renders, unsigned firstSeed) {
  test::ImageSeries all;
  for (unsigned i = 0; i < renders; ++i)
    all.push_back(render(prepared, Aov::Beauty, 8, firstSeed + i));
  return all;
}

/// Share of the pixels with another value.
double differing(const Image& a, const Image& b, float tolerance) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < std::size_t(kWidth) * kHeight; ++i) {
    bool same = true;
    for (std::size_t k = 0; k < 3; ++k)
      same &= std::abs(a.rgba[4 * i + k] - b.rgba[4 * i + k]) <= tolerance;
    count += !same;
  }
  return double(count) / (kWidth * kHeight);
}

TEST(ReportPictures, AreTheSameInAnyUnitAndFarFromTheOrigin) {
  const fs::path folder = reports("far-and-scaled");
  if (folder.empty()) GTEST_SKIP() << "no folder of reports beside the sources";
  struct Case {
    const char* file;
    double radius; // 8 mm on bricks of 240 mm
  };
  const TemporaryFolder copy;
  const auto loaded = [&](const Case& c) {
    const fs::path mesh = copy.path() / c.file;
    fs::copy_file(folder / c.file, mesh);
    PreprocessOptions options;
    options.radius.value = c.radius;
    fs::path sidecar = mesh;
    sidecar += ".chamfer";
    writeSidecar(sidecar, *preprocess(readMesh(mesh), options).rounding);
    return loadScene(mesh, copy.path(), mesh.stem().string());
  };
  const auto local = loaded({"bricks-local.obj", 0.008});
  for (const Case& c :
       {Case{"bricks-mm.obj", 8}, Case{"bricks-um.obj", 8e-9}, Case{"bricks-utm.obj", 0.008}}) {
    const auto other = loaded(c);
    EXPECT_TRUE(other->warnings.empty()) << c.file << ": " << other->warnings.front();
    for (std::size_t m = 0; m < std::size(kModes); ++m) {
      SCOPED_TRACE(c.file + std::string(", ") + kModeWords[m]);
      const auto first = prepare(local, kModes[m]), second = prepare(other, kModes[m]);
      // What a pixel's first sample sees: rays that pass an edge within rounding may pass it elsewhere.
      for (const Aov aov : {Aov::Feature, Aov::Normal, Aov::Albedo})
        EXPECT_LE(differing(render(*first, aov, 1, 1), render(*second, aov, 1, 1), 2e-3f), 0.002) << int(aov);
      const test::Verdict verdict = test::judge(series(*first, 16, 0), series(*second, 16, 100));
      EXPECT_TRUE(verdict.same) << verdict.text;
    }
  }
  // The test sees a radius of another length.
  fs::remove(copy.path() / "bricks-mm.obj");
  const auto wider = prepare(loaded({"bricks-mm.obj", 12}), {});
  EXPECT_GT(
      differing(render(*prepare(local, {}), Aov::Feature, 1, 1), render(*wider, Aov::Feature, 1, 1), 2e-3f),
      0.005);
}

TEST(ReportPictures, AMirroredLampShinesLikeOneThatIsNot) {
  const fs::path folder = reports("mirrored-lamp");
  if (folder.empty()) GTEST_SKIP() << "no folder of reports beside the sources";
  const auto plain = loadScene(folder / "plain.scene.json", folder, "plain");
  const auto mirrored = loadScene(folder / "mirrored.scene.json", folder, "mirrored");
  for (std::size_t m = 0; m < std::size(kModes); ++m) {
    SCOPED_TRACE(kModeWords[m]);
    const auto first = prepare(plain, kModes[m]), second = prepare(mirrored, kModes[m]);
    for (const Aov aov : {Aov::Feature, Aov::Normal})
      EXPECT_LE(differing(render(*first, aov, 1, 1), render(*second, aov, 1, 1), 2e-3f), 0.01) << int(aov);
    const test::Verdict verdict = test::judge(series(*first, 16, 0), series(*second, 16, 100));
    EXPECT_TRUE(verdict.same) << verdict.text;
    double light = 0;
    for (const float v : render(*second, Aov::Beauty, 8, 1).rgba)
      light += double(v);
    EXPECT_GT(light / (4 * kWidth * kHeight), 0.3) << "nothing is lit";
  }
}

} // namespace
} // namespace chamfer
