// What renderTile() promises: purity, tiles, sample ranges, light in closed form.
#include "server/render/path/aov.h"
#include "server/render/path/prepared_scene.h"
#include "tests/render/scene_files_fixture.h"

#include <gmock/gmock.h>

namespace chamfer {
namespace {

using test::loadText;
using test::TemporaryFolder;
using test::thrownBy;

RenderSettings settings(unsigned width, unsigned height, unsigned samples) {
  RenderSettings s;
  s.width = width;
  s.height = height;
  s.endSample = samples;
  return s;
}

/// A scene with everything in it: rounded and sharp solids, glass, metal, area light, point light, sun, sky,
/// lens.
std::shared_ptr<const Scene> everything(const TemporaryFolder& folder) {
  return loadText(
      folder,
      R"({"meshes":[{"name":"cube","file":"cube.obj","radius":0.1},{"name":"floor","file":"floor.obj"}],
    "materials":[{"name":"glass","transmission":1,"roughness":0.1,"absorption":[0.5,0.1,0]},
      {"name":"metal","metallic":1,"roughness":0.2,"base_color":[0.9,0.6,0.3]},{"name":"plain","base_color":0.5}],
    "instances":[{"mesh":"floor","material":"plain"},{"mesh":"cube","material":"glass","translate":[-0.7,0,0]},
      {"mesh":"cube","material":"metal","rotate":{"axis":[1,2,3],"degrees":40},"scale":[1,-1,0.5],"translate":[0.8,0,0.2]}],
    "lights":[{"type":"area","center":[0,-1,4],"u":[1,0,0],"v":[0,1,0],"emission":10},
      {"type":"point","position":[2,-2,2],"intensity":2},
      {"type":"directional","direction":[1,1,-2],"irradiance":1,"angular_diameter_degrees":1}],
    "camera":{"eye":[0,-4,2],"target":[0,0,0],"vfov_degrees":40,"aperture_diameter":0.05}})");
}

TEST(RenderTile, IsPure) {
  const TemporaryFolder folder;
  const auto prepared = prepare(everything(folder), {});
  const RenderSettings s = settings(53, 37, 5);
  RenderControl one, two, three;
  one.threads = 1;
  two.threads = 2;
  three.threads = 3;
  const RenderResult first = renderTile(*prepared, s, {0, 0, 53, 37}, one);
  EXPECT_EQ(first.statistics.nonFiniteSamples, 0u);
  for (const RenderControl& control : {one, two, three}) {
    const RenderResult again = renderTile(*prepare(everything(folder), {}), s, {0, 0, 53, 37}, control);
    EXPECT_EQ(again.image.rgba, first.image.rgba);
    EXPECT_EQ(again.statistics, first.statistics);
  }
  RenderSettings other = s;
  other.seed = 1;
  EXPECT_NE(renderTile(*prepared, other, {0, 0, 53, 37}).image.rgba, first.image.rgba);
}

TEST(RenderTile, EqualsTheCropOfTheFrame) {
  const TemporaryFolder folder;
  const auto prepared = prepare(everything(folder), {});
  const RenderSettings s = settings(53, 37, 3);
  const Image frame = renderTile(*prepared, s, {0, 0, 53, 37}).image;
  for (const TileRect& t : {TileRect{0, 0, 20, 20}, {17, 5, 33, 31}, {52, 36, 1, 1}, {3, 0, 1, 37}}) {
    const Image tile = renderTile(*prepared, s, t).image;
    ASSERT_EQ(tile.width, t.width);
    ASSERT_EQ(tile.height, t.height);
    for (unsigned y = 0; y < t.height; ++y)
      for (unsigned i = 0; i < 4 * t.width; ++i)
        ASSERT_EQ(tile.rgba[y * t.width * 4 + i], frame.rgba[((t.y + y) * 53 + t.x) * 4 + i]);
  }
}

TEST(RenderTile, SampleRangesCombine) {
  const TemporaryFolder folder;
  const auto prepared = prepare(everything(folder), {});
  RenderSettings s = settings(24, 24, 12);
  const auto render = [&](unsigned first, unsigned end) {
    s.firstSample = first;
    s.endSample = end;
    return renderTile(*prepared, s, {0, 0, 24, 24}).image.rgba;
  };
  const auto whole = render(0, 12), a = render(0, 5), b = render(5, 12);
  for (std::size_t i = 0; i < whole.size(); ++i)
    ASSERT_NEAR(whole[i], (5 * a[i] + 7 * b[i]) / 12, 1e-5f * std::max(1.f, whole[i]));
}

TEST(RenderTile, RefusesWhatIsOutsideItsLimits) {
  const TemporaryFolder folder;
  const auto prepared = prepare(everything(folder), {});
  const auto thrown = [&](RenderSettings s, TileRect t) {
    return thrownBy([&] { renderTile(*prepared, s, t); });
  };
  EXPECT_THAT(thrown(settings(0, 4, 1), {0, 0, 1, 1}), testing::StartsWith("out-of-range: the frame"));
  EXPECT_THAT(thrown(settings(4, 4, 0), {0, 0, 1, 1}), testing::StartsWith("out-of-range: the sample range"));
  EXPECT_THAT(thrown(settings(4, 4, 1), {2, 0, 3, 1}), testing::HasSubstr("not within the frame of 4x4"));
  EXPECT_THAT(thrown(settings(4, 4, 1), {0, 4294967295u, 1, 2}), testing::HasSubstr("not within"));
  EXPECT_THAT(thrown(settings(4, 4, 1), {0, 0, 0, 1}), testing::StartsWith("out-of-range: the tile"));
  RenderSettings s = settings(4, 4, 1);
  s.camera = Camera{};
  s.camera->vfovDegrees = -3;
  EXPECT_THAT(thrown(s, {0, 0, 1, 1}), testing::StartsWith("out-of-range: camera"));
}

TEST(RenderTile, StopsWhenAskedTo) {
  const TemporaryFolder folder;
  const auto prepared = prepare(everything(folder), {});
  std::atomic<int> asked{0};
  RenderControl control;
  control.threads = 2;
  control.cancelled = [&] { return ++asked > 10; };
  const auto thrown = thrownBy([&] {
    renderTile(*prepared, settings(4000, 4000, 4000), {0, 0, 4000, 4000}, control);
  });
  EXPECT_THAT(thrown, testing::StartsWith("cancelled: "));
  EXPECT_LT(asked, 100);
  std::atomic<double> last{0};
  RenderControl watched;
  watched.progress = [&](double share) {
    if (share > last) last = share;
  };
  renderTile(*prepared, settings(64, 64, 1), {0, 0, 64, 64}, watched);
  EXPECT_EQ(last, 1);
}

TEST(RenderTile, AsksWhetherToStopAsOftenAsItSays) {
  const TemporaryFolder folder;
  const auto prepared = prepare(everything(folder), {});
  for (const auto& [tile, samples] :
       {std::pair(TileRect{0, 0, 40, 33}, 5u), {{3, 2, 1, 1}, 1200u}, {{0, 0, 16, 16}, 1u}}) {
    std::atomic<std::uint64_t> asked{0};
    RenderControl control;
    control.threads = 2;
    control.cancelled = [&] { return ++asked, false; };
    renderTile(*prepared, settings(64, 64, samples), tile, control);
    EXPECT_EQ(asked, looksOfRender(settings(64, 64, samples), tile));
  }
}

TEST(Aovs, TellWhatTheFirstHitIs) {
  const TemporaryFolder folder;
  const auto scene = loadText(folder, R"({"meshes":[{"name":"cube","file":"cube.obj","radius":0.2}],
    "materials":[{"name":"red","base_color":[0.5,0.1,0.2]}],"instances":[{"mesh":"cube","material":"red"}]})");
  const auto prepared = prepare(scene, {});
  RayStatistics statistics;
  const auto at = [&](Aov aov, double x, double y) {
    return aovSample(prepared->surfaces(), ownTracer(*prepared), aov, {{x, y, 3}, {0, 0, -1}}, {},
                     Sampler(0, 0, 0, 0), statistics);
  };
  EXPECT_EQ(at(Aov::Albedo, 0, 0).value, (Color{0.5f, 0.1f, 0.2f}));
  EXPECT_EQ(at(Aov::Normal, 0, 0).value, (Color{0, 0, 1}));
  EXPECT_FLOAT_EQ(at(Aov::Depth, 0.1, 0).value.r, 2.5f);
  EXPECT_EQ(at(Aov::Feature, 0, 0).value, grey(0.25f));
  EXPECT_EQ(at(Aov::Feature, 0.4, 0).value, (Color{1, 0.5f, 0}));
  EXPECT_EQ(at(Aov::Feature, 0.4, 0.4).value, (Color{0, 0.5f, 1}));
  EXPECT_NEAR(at(Aov::Normal, 0.4, 0).value.r, 0.5, 1e-5) << "0.1 of 0.2 beside the cylinder's axis";
  EXPECT_EQ(at(Aov::Albedo, 0.49, 0.49).coverage, 0) << "beside the rounded corner";
  EXPECT_EQ(at(Aov::Albedo, 0.4, 0.4).coverage, 1);
  EXPECT_EQ(statistics.camera, (RayCount{9, 8, 4}));
  EXPECT_EQ(statistics.rays(), 9u);
}

} // namespace
} // namespace chamfer
