// Whole pictures: every bundled scene against a plain path tracer's, the roundings against each other, and a
// judge that rejects what is wrong.
#include "common/error.h"
#include "tests/render/image_judge.h"
#include "tests/render/plain_path_tracer.h"
#include "tests/render/scene_files_fixture.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>

namespace chamfer {
namespace {

using test::ImageSeries;
using test::judge;
using test::Verdict;

constexpr unsigned kWidth = 36, kHeight = 24, kBounces = 4;
constexpr unsigned kRenders = 24; ///< of a series

std::vector<std::string> bundledScenes() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(CHAMFER_SOURCE_DIR "/data")) {
    const std::string file = entry.path().filename().string(), ending = ".scene.json";
    if (file.ends_with(ending)) names.push_back(file.substr(0, file.size() - ending.size()));
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::shared_ptr<const Scene> bundled(const std::string& name) {
  const std::filesystem::path data = CHAMFER_SOURCE_DIR "/data";
  return loadScene(data / (name + ".scene.json"), data, name);
}

Image render(const PreparedScene& prepared, unsigned samples, unsigned seed) {
  RenderSettings s;
  s.width = kWidth;
  s.height = kHeight;
  s.endSample = samples;
  s.maxBounces = kBounces;
  s.seed = seed;
  return renderTile(prepared, s, {0, 0, kWidth, kHeight}).image;
}

ImageSeries series(const PreparedScene& prepared, unsigned renders, unsigned samples, unsigned firstSeed) {
  ImageSeries all;
  for (unsigned i = 0; i < renders; ++i)
    all.push_back(render(prepared, samples, firstSeed + i));
  return all;
}

class BundledScene : public testing::TestWithParam<std::string> {};

TEST_P(BundledScene, IsWhatAPlainPathTracerSees) {
  const auto prepared = prepare(bundled(GetParam()), {});
  ImageSeries plain;
  for (unsigned seed = 0; seed < kRenders; ++seed)
    plain.push_back(test::renderPlainly(*prepared, kWidth, kHeight, 17, kBounces, seed));
  const Verdict verdict = judge(plain, series(*prepared, kRenders, 17, 100));
  EXPECT_TRUE(verdict.same) << verdict.text;
}

/// With 64 segments, or as many as the limit of triangles allows.
std::shared_ptr<const PreparedScene> explicitly(const std::shared_ptr<const Scene>& scene) {
  try {
    return prepare(scene, {RoundingMode::Mesh, 64, {}});
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::OutOfRange) throw;
    return prepare(scene, {RoundingMode::Mesh, 16, {}});
  }
}

TEST_P(BundledScene, LooksAlikeWithAnExplicitMesh) {
  const auto scene = bundled(GetParam());
  const ImageSeries exact = series(*prepare(scene, {}), kRenders, 16, 0);
  const Verdict mesh = judge(exact, series(*explicitly(scene), kRenders, 16, 1000));
  EXPECT_TRUE(mesh.same) << mesh.text;
  // With the same seeds: paths that meet no edge cancel.
  const Verdict sharp = judge(exact, series(*prepare(scene, {RoundingMode::None, 0, {}}), kRenders, 16, 0));
  EXPECT_FALSE(sharp.same) << "the judge must see that edges are sharp: " << sharp.text;
}

std::string testName(const testing::TestParamInfo<std::string>& parameter) {
  std::string name = parameter.param;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(Data, BundledScene, testing::ValuesIn(bundledScenes()), testName);

TEST(ImageJudge, RejectsWhatIsWrongAndNothingElse) {
  const auto prepared = prepare(bundled("dice"), {});
  const ImageSeries reference = series(*prepared, kRenders, 16, 0);
  const ImageSeries right = series(*prepared, kRenders, 16, 500);
  const auto verdict = [&](auto&& change) {
    ImageSeries wrong = right;
    for (Image& image : wrong)
      change(image);
    return judge(reference, wrong);
  };
  const Verdict same = verdict([](Image&) {});
  EXPECT_TRUE(same.same) << same.text;
  const auto rejected = [&](const char* what, auto&& change) {
    const Verdict v = verdict(change);
    EXPECT_FALSE(v.same) << what << ": " << v.text;
  };
  rejected("2 % brighter", [](Image& i) {
    for (float& v : i.rgba)
      v *= 1.02f;
  });
  rejected("2 % darker", [](Image& i) {
    for (float& v : i.rgba)
      v *= 0.98f;
  });
  rejected("one pixel to the right", [](Image& i) {
    for (unsigned y = 0; y < kHeight; ++y) {
      const auto row = i.rgba.begin() + 4 * y * kWidth;
      std::rotate(row, row + 4 * (kWidth - 1), row + 4 * kWidth);
    }
  });
  rejected("one pixel down",
           [](Image& i) { std::rotate(i.rgba.begin(), i.rgba.end() - 4 * kWidth, i.rgba.end()); });
  rejected("one firefly", [](Image& i) { i.rgba[4 * (kHeight / 2 * kWidth + 5)] += 3; });
  rejected("one black pixel", [](Image& i) { i.rgba[4 * (kHeight / 2 * kWidth + 5) + 1] = 0; });
  rejected("NaN", [](Image& i) { i.rgba[4 * 77] = NAN; });
  rejected("infinite", [](Image& i) { i.rgba[4 * 77 + 2] = INFINITY; });
  rejected("another size", [](Image& i) {
    i = Image{kWidth - 1, kHeight, std::vector<float>(4 * (kWidth - 1) * kHeight)};
  });
}

TEST(Rounding, ChangesOnlyPixelsWhosePathsCanMeetIt) {
  // Above the flat top of a lone convex solid nothing is but the sky: there the sharp and the rounded solid
  // send the same paths.
  const test::TemporaryFolder folder;
  const auto scene = test::loadText(folder, R"({"meshes":[{"name":"cube","file":"cube.obj","radius":0.1}],
    "materials":[{"name":"m","base_color":0.6,"roughness":0.3}],"instances":[{"mesh":"cube","material":"m"}],
    "lights":[{"type":"sky"},{"type":"directional","direction":[1,1,-2],"irradiance":2,"angular_diameter_degrees":2}],
    "camera":{"eye":[0.8,-2.5,2],"target":[0,0,0],"vfov_degrees":28}})");
  const auto exact = prepare(scene, {}), sharp = prepare(scene, {RoundingMode::None, 0, {}});
  RenderSettings s;
  s.width = kWidth;
  s.height = kHeight;
  s.endSample = 16;
  const auto image = [&](const PreparedScene& prepared, Aov aov) {
    s.aov = aov;
    return renderTile(prepared, s, {0, 0, kWidth, kHeight}).image.rgba;
  };
  const auto a = image(*exact, Aov::Beauty), b = image(*sharp, Aov::Beauty);
  const auto feature = image(*exact, Aov::Feature);
  int flat = 0, rounded = 0, background = 0, changed = 0;
  for (std::size_t i = 0; i < a.size(); i += 4) {
    const bool empty = feature[i + 3] == 0, full = feature[i + 3] == 1;
    const bool onFlats =
        full && std::abs(feature[i] - 0.25f) < 1e-6f && std::abs(feature[i + 2] - 0.25f) < 1e-6f;
    const float difference = std::abs(a[i + 1] - b[i + 1]);
    if (empty && difference == 0) ++background;
    if (onFlats) {
      ++flat;
      EXPECT_LE(difference, 1e-5f * b[i + 1]) << "pixel " << i / 4 % kWidth << "," << i / 4 / kWidth;
    } else if (!empty) {
      ++rounded;
      changed += difference > 1e-3f * b[i + 1];
    }
  }
  EXPECT_GT(flat, 50);
  EXPECT_GT(background, 100);
  EXPECT_GT(rounded, 50);
  EXPECT_GT(changed, rounded * 9 / 10);
}

} // namespace
} // namespace chamfer
