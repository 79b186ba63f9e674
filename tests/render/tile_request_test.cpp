#include "server/render/request/tile_request.h"

#include "server/render/request/parameters.h"
#include "server/render/request/query.h"
#include "tests/render/expect_refusal.h"

#include <nlohmann/json.hpp>

namespace chamfer {
namespace {

using test::refusalOf;

constexpr const char* kCamera = "camera=1,2,3,0,0,0,0,0,1,40";

TileRequest tile(const std::string& path, const std::string& query = "") {
  const auto segments = splitPath(path);
  return parseTile(segments, query);
}
TileRequest frame(const std::string& path, const std::string& query = "") {
  const auto segments = splitPath(path);
  return parseFrame(segments, query);
}

TEST(TileRequest, ReadsEveryPart) {
  const TileRequest request = tile("/640x480/32,16,64,48/4-12.exr",
                                   "camera=1,2,3,4,5,6,0,0,1,35.5,0.01,7&rounding=mesh:3&radius=2.5e-2&seed=7"
                                   "&radius_clamp=0.9"
                                   "&bounces=0&clamp=2.5&aov=normal");
  EXPECT_EQ(request.settings.width, 640u);
  EXPECT_EQ(request.settings.height, 480u);
  EXPECT_EQ(request.tile.x, 32u);
  EXPECT_EQ(request.tile.y, 16u);
  EXPECT_EQ(request.tile.width, 64u);
  EXPECT_EQ(request.tile.height, 48u);
  EXPECT_EQ(request.settings.firstSample, 4u);
  EXPECT_EQ(request.settings.endSample, 12u);
  EXPECT_EQ(request.samples(), 8u);
  EXPECT_EQ(request.format, ImageFormat::Exr);
  EXPECT_EQ(request.rounding.mode, RoundingMode::Mesh);
  EXPECT_EQ(request.rounding.count, 3u);
  EXPECT_EQ(request.rounding.radius, 0.025);
  EXPECT_EQ(request.rounding.radiusClamp, 0.9);
  EXPECT_EQ(request.settings.seed, 7u);
  EXPECT_EQ(request.settings.maxBounces, 0u);
  EXPECT_EQ(request.settings.indirectClamp, 2.5f);
  EXPECT_EQ(request.settings.aov, Aov::Normal);
  ASSERT_TRUE(request.settings.camera);
  EXPECT_EQ(request.settings.camera->eye, Point3(1, 2, 3));
  EXPECT_EQ(request.settings.camera->target, Point3(4, 5, 6));
  EXPECT_EQ(request.settings.camera->up, Vector3(0, 0, 1));
  EXPECT_EQ(request.settings.camera->vfovDegrees, 35.5);
  EXPECT_EQ(request.settings.camera->apertureDiameter, 0.01);
  EXPECT_EQ(request.settings.camera->focusDistance, 7);
}

TEST(TileRequest, DefaultsAreTheTables) {
  const TileRequest request = tile("/64x64/0,0,64,64/0-1.f16");
  EXPECT_FALSE(request.settings.camera);
  EXPECT_EQ(request.rounding, RoundingChoice{});
  EXPECT_EQ(std::to_string(request.settings.seed), parameterRow("seed").fallback);
  EXPECT_EQ(std::to_string(request.settings.maxBounces), parameterRow("bounces").fallback);
  EXPECT_EQ(request.settings.aov, Aov::Beauty);
}

TEST(TileRequest, CommasMayBeEncoded) { EXPECT_EQ(tile("/64x64/0%2C8,16,16/0-1.png").tile.y, 8u); }

TEST(TileRequest, FrameIsTheTileThatCoversIt) {
  const TileRequest request = frame("/320x200/0-4.png", "seed=3");
  EXPECT_EQ(request.tile.width, 320u);
  EXPECT_EQ(request.tile.height, 200u);
  EXPECT_EQ(request.settings.seed, 3u);
  EXPECT_EQ(refusalOf([] { frame("/320x200/0-4.f16"); }, 400).parameter(), "format");
  refusalOf([] { frame("/320x200/0,0,2,2/0-4.png"); }, 404);
}

struct Refusal {
  const char* path;
  const char* query;
  int status;
  const char* parameter;
  const char* value;
};

class RefusedTile : public testing::TestWithParam<Refusal> {};

TEST_P(RefusedTile, NamesParameterValueAndLimits) {
  const Refusal& refusal = GetParam();
  const ParameterError refused = refusalOf([&] { tile(refusal.path, refusal.query); }, refusal.status);
  EXPECT_EQ(refused.parameter(), refusal.parameter);
  EXPECT_EQ(refused.value(), refusal.value);
  if (refusal.status == 422) {
    EXPECT_TRUE(nlohmann::json::parse(refused.limits()).is_object());
  }
}

constexpr const char* kGood = "/64x64/0,0,64,64/0-1.png";

INSTANTIATE_TEST_SUITE_P(Path, RefusedTile,
                         testing::Values(Refusal{"/64/0,0,64,64/0-1.png", "", 400, "width", "64"},
                                         Refusal{"/64x/0,0,64,64/0-1.png", "", 400, "height", ""},
                                         Refusal{"/64x64x64/0,0,64,64/0-1.png", "", 400, "width", "64x64x64"},
                                         Refusal{"/+64x64/0,0,64,64/0-1.png", "", 400, "width", "+64"},
                                         Refusal{"/064x64/0,0,64,64/0-1.png", "", 400, "width", "064"},
                                         Refusal{"/0x64/0,0,64,64/0-1.png", "", 422, "width", "0"},
                                         Refusal{"/65537x64/0,0,64,64/0-1.png", "", 422, "width", "65537"},
                                         Refusal{"/64x99999999999999999999/0,0,64,64/0-1.png", "", 422,
                                                 "height", "99999999999999999999"},
                                         Refusal{"/64x64/0,0,64/0-1.png", "", 400, "x", "0,0,64"},
                                         Refusal{"/64x64/-1,0,64,64/0-1.png", "", 400, "x", "-1"},
                                         Refusal{"/64x64/0,0,0,64/0-1.png", "", 422, "w", "0"},
                                         Refusal{"/64x64/1,0,64,64/0-1.png", "", 422, "w", "64"},
                                         Refusal{"/64x64/0,60,64,5/0-1.png", "", 422, "h", "5"},
                                         Refusal{"/64x64/0,0,64,64/0-1", "", 400, "s0", "0-1"},
                                         Refusal{"/64x64/0,0,64,64/0.png", "", 400, "s0", "0.png"},
                                         Refusal{"/64x64/0,0,64,64/0-1.jpg", "", 400, "format", "jpg"},
                                         Refusal{"/64x64/0,0,64,64/0-1.PNG", "", 400, "format", "PNG"},
                                         Refusal{"/64x64/0,0,64,64/4-4.png", "", 422, "s1", "4"},
                                         Refusal{"/64x64/0,0,64,64/0-2000000.png", "", 422, "s1",
                                                 "2000000"}));

INSTANTIATE_TEST_SUITE_P(
    Query, RefusedTile,
    testing::Values(
        Refusal{kGood, "sead=1", 400, "sead", "1"}, Refusal{kGood, "seed=1&seed=1", 400, "seed", "1"},
        Refusal{kGood, "seed=1.5", 400, "seed", "1.5"}, Refusal{kGood, "seed=-1", 400, "seed", "-1"},
        Refusal{kGood, "seed= 1", 400, "seed", " 1"},
        Refusal{kGood, "seed=4294967296", 422, "seed", "4294967296"},
        Refusal{kGood, "bounces=65", 422, "bounces", "65"}, Refusal{kGood, "clamp=-1", 422, "clamp", "-1"},
        Refusal{kGood, "radius=x", 400, "radius", "x"}, Refusal{kGood, "radius=", 400, "radius", ""},
        Refusal{kGood, "radius=0.1x", 400, "radius", "0.1x"},
        Refusal{kGood, "radius=0x1p3", 400, "radius", "0x1p3"},
        Refusal{kGood, "radius=0", 422, "radius", "0"}, Refusal{kGood, "radius=-1", 422, "radius", "-1"},
        Refusal{kGood, "radius=nan", 422, "radius", "nan"},
        Refusal{kGood, "radius=inf", 422, "radius", "inf"},
        Refusal{kGood, "radius=1e999", 422, "radius", "1e999"},
        Refusal{kGood, "rounding=soft", 400, "rounding", "soft"},
        Refusal{kGood, "rounding=mesh", 400, "rounding", "mesh"},
        Refusal{kGood, "rounding=mesh:0", 422, "rounding", "mesh:0"},
        Refusal{kGood, "rounding=bevel:99999", 422, "rounding", "bevel:99999"},
        Refusal{kGood, "aov=colour", 400, "aov", "colour"},
        Refusal{kGood, "camera=1,2,3", 400, "camera", "1,2,3"},
        Refusal{kGood, "camera=1,2,3,0,0,0,0,0,1,x", 400, "vfov", "x"},
        Refusal{kGood, "camera=1,2,3,0,0,0,0,0,1,180", 422, "vfov", "180"},
        Refusal{kGood, "camera=nan,2,3,0,0,0,0,0,1,40", 422, "camera", "nan"}));

TEST(TileRequest, RefusesCamerasThatLookNowhere) {
  for (const char* camera : {"1,2,3,1,2,3,0,0,1,40",         // eye is target
                             "1,2,3,0,0,0,0,0,0,40",         // no up
                             "0,0,5,0,0,0,0,0,-1,40",        // up along the view
                             "1,2,3,0,0,0,0,0,1,40,-0.1,1"}) // negative aperture
    EXPECT_EQ(refusalOf([&] { parseCamera(camera); }, 422).parameter(), "camera") << camera;
}

TEST(TileRequest, LimitsTheWorkOfOneRequest) {
  EXPECT_EQ(refusalOf([] { tile("/4096x4096/0,0,4096,257/0-1.png"); }, 422).parameter(), "pixels");
  EXPECT_EQ(refusalOf([] { tile("/1024x1024/0,0,1024,1024/0-4096.png"); }, 422).parameter(), "samples");
  EXPECT_NO_THROW(tile("/4096x4096/0,0,4096,256/0-1.png"));
  refusalOf([] { frame("/8192x8192/0-1.png"); }, 422);
}

TEST(TileRequest, DigestNamesTheAnswerNotItsSpelling) {
  const Digest scene{1, 2};
  const auto digest = [&](const char* path, const char* query) {
    return answerDigest("1.0", scene, tile(path, query));
  };
  const Digest base = digest(kGood, kCamera);
  EXPECT_EQ(base, digest(kGood,
                         "rounding=analytic&seed=0&bounces=8&aov=beauty&camera=1.0,2e0,3,0,0,-0,0,0,1,40.0"));
  EXPECT_EQ(base, digest("/64x64/0%2C0,64,64/0-1.png", kCamera));
  EXPECT_EQ(digest(kGood, "rounding=none&radius=0.1"), digest(kGood, "rounding=none")); // sharp is sharp
  // Everything that changes the bytes changes it.
  for (const char* query :
       {"", "camera=1,2,3,0,0,0,0,0,1,41", "camera=1,2,3,0,0,0,0,0,1,40&seed=1",
        "camera=1,2,3,0,0,0,0,0,1,40&bounces=7", "camera=1,2,3,0,0,0,0,0,1,40&clamp=7",
        "camera=1,2,3,0,0,0,0,0,1,40&aov=depth", "camera=1,2,3,0,0,0,0,0,1,40&radius=0.1",
        "camera=1,2,3,0,0,0,0,0,1,40&radius_clamp=0.5", "camera=1,2,3,0,0,0,0,0,1,40&radius_clamp=0",
        "camera=1,2,3,0,0,0,0,0,1,40&rounding=none", "camera=1,2,3,0,0,0,0,0,1,40&rounding=mesh:8"})
    EXPECT_NE(base, digest(kGood, query)) << query;
  for (const char* path : {"/65x64/0,0,64,64/0-1.png", "/64x65/0,0,64,64/0-1.png", "/64x64/1,0,63,64/0-1.png",
                           "/64x64/0,0,64,64/0-2.png", "/64x64/0,0,64,64/0-1.f16"})
    EXPECT_NE(base, digest(path, kCamera)) << path;
  EXPECT_NE(base, answerDigest("1.0", Digest{1, 3}, tile(kGood, kCamera)));
}

TEST(TileRequest, DigestIsOfTheseBytes) {
  // Caches hold pictures under these digests: their text stays as it is.
  const Digest scene{1, 2};
  const std::string prefix = "1.0|" + scene.hex() + '|';
  EXPECT_EQ(answerDigest("1.0", scene, tile(kGood)),
            digestOf(prefix + "64|64|0|0|64|64|0|1|0|8|png|beauty|analytic|"));
  EXPECT_EQ(answerDigest("1.0", scene,
                         frame("/320x200/4-12.exr", "aov=normal&bounces=3&clamp=2.5&radius=2.5e-2&seed=7"
                                                    "&radius_clamp=0.9&rounding=mesh:3&camera="
                                                    "1,2,3,4,5,6,0,0,1,35.5,0.01,7")),
            digestOf(prefix +
                     "320|200|0|0|320|200|4|12|7|3|exr|normal|mesh:3|0.025|radius clamp 0.9|clamp 2.5"
                     "|1|2|3|4|5|6|0|0|1|35.5|0.01|7"));
}

TEST(TileRequest, CanonicalSettingsAreTheDigestsWithoutVersionSceneAndFormat) {
  const TileRequest png = tile(kGood, kCamera);
  EXPECT_EQ(canonicalSettings(png), "64|64|0|0|64|64|0|1|0|8|beauty|analytic||1|2|3|0|0|0|0|0|1|40|0|0");
  EXPECT_EQ(canonicalSettings(png), canonicalSettings(tile("/64x64/0%2C0,64,64/0-1.f16",
                                                           "seed=0&camera=1.0,2e0,3,0,0,-0,0,0,1,40.0")));
  EXPECT_NE(canonicalSettings(png), canonicalSettings(tile(kGood)));
}

TEST(TileRequest, ReadsParametersOneByOne) {
  TileRequest request = tile(kGood);
  readParameter(request, "camera", "1,2,3,0,0,0,0,0,1,40");
  EXPECT_EQ(canonicalSettings(request), canonicalSettings(tile(kGood, kCamera)));
  readParameter(request, "camera", "1,2,3,0,0,0,0,0,1,41"); // the last one holds
  EXPECT_EQ(request.settings.camera->vfovDegrees, 41);
  // The sharp mesh has no radius, in whatever order it is said.
  readParameter(request, "radius", "0.1");
  readParameter(request, "rounding", "none");
  readParameter(request, "radius_clamp", "0.5");
  EXPECT_EQ(request.rounding, (RoundingChoice{RoundingMode::None, 0, {}}));

  const TileRequest before = request;
  const ParameterError unknown = refusalOf([&] { readParameter(request, "sead", "1"); }, 400);
  EXPECT_EQ(unknown.parameter(), "sead");
  EXPECT_EQ(unknown.value(), "1");
  EXPECT_STREQ(unknown.what(),
               "there is no parameter \"sead\"; known: camera, rounding, radius, radius_clamp, "
               "seed, bounces, clamp, aov");
  for (const char* name : {"width", "s0", "format", "rays", "tnear", "K", "vfov", ""}) // rows of other places
    EXPECT_THROW(readParameter(request, name, "1"), ParameterError) << name;
  EXPECT_EQ(refusalOf([&] { readParameter(request, "aov", "colour"); }, 400).value(), "colour");
  EXPECT_EQ(canonicalSettings(request), canonicalSettings(before)) << "what is refused changes nothing";
}

TEST(Parameters, EveryRowHasReadableLimits) {
  for (const ParameterRow& row : parameterRows()) {
    const auto limits = nlohmann::json::parse(limitsJson(row));
    const bool bounded = limits.contains("one_of") || limits.contains("maximum");
    EXPECT_EQ(bounded, row.kind != ParameterKind::Text) << row.name;
    EXPECT_STRNE(kindWord(row.kind), "") << row.name;
  }
}

} // namespace
} // namespace chamfer
