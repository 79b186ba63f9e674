// Tiles and frames: what is sent, what it depends on, and what it does not depend on.
#include "tests/http/service_fixture.h"

#include <cstring>
#include <gmock/gmock.h>

namespace chamfer::http {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class Images : public test::ServiceTest {
protected:
  Images() { folder_.addCube("cube.obj"); }
  std::string tiles() { return "/v1/scenes/" + idOf("cube") + "/tiles/"; }
};

TEST_F(Images, NameLeadsToTheIdItHasNow) {
  serve();
  const Response response = get("/v1/scenes/cube/tiles/64x64/0,0,16,16/0-1.f16?seed=3&aov=normal");
  EXPECT_EQ(response.status, 307);
  EXPECT_EQ(*response.header("Location"), tiles() + "64x64/0,0,16,16/0-1.f16?seed=3&aov=normal");
  EXPECT_EQ(*response.header("Cache-Control"), "no-store");
  EXPECT_EQ(get(*response.header("Location")).status, 200);
  EXPECT_EQ(get("/v1/scenes/cube/frames/64x64/0-1.png").status, 307);
}

TEST_F(Images, TileCarriesWhatIsPromised) {
  serve();
  const Response response = get(tiles() + "64x48/8,4,32,16/2-5.f16");
  ASSERT_EQ(response.status, 200);
  ASSERT_EQ(response.body.size(), 16u + 32 * 16 * 8);
  EXPECT_THAT(response.body, StartsWith("CT16"));
  std::uint32_t header[3];
  std::memcpy(header, response.body.data() + 4, sizeof header);
  EXPECT_EQ(header[0], 32u);
  EXPECT_EQ(header[1], 16u);
  EXPECT_EQ(header[2], 3u);
  EXPECT_EQ(*response.header("Cache-Control"), "public, max-age=31536000, immutable");
  EXPECT_THAT(*response.header("ETag"), testing::MatchesRegex("\"[0-9a-f]{32}\""));
  for (const char* lap : {"queue", "prepare", "render", "encode"})
    EXPECT_THAT(*response.header("Server-Timing"), HasSubstr(lap));
  const unsigned long rays = std::stoul(*response.header("X-Chamfer-Rays"));
  EXPECT_GE(rays, 32u * 16 * 3);
  EXPECT_GT(std::stoul(*response.header("X-Chamfer-Rounded")), 0u);
  EXPECT_LT(std::stoul(*response.header("X-Chamfer-Rounded")), rays);
}

TEST_F(Images, HalfFloatsThatCannotHoldTheirValueAreCounted) {
  folder_.write("bright.scene.json", R"({"meshes":[{"name":"c","file":"cube.obj"}],
      "instances":[{"mesh":"c"}],"lights":[{"type":"environment","color":1e6}]})");
  serve();
  const std::string bright = "/v1/scenes/" + idOf("bright") + "/tiles/16x16/0,0,16,16/0-1.";
  const Response f16 = get(bright + "f16");
  ASSERT_EQ(f16.status, 200);
  ASSERT_NE(f16.header("X-Chamfer-Saturated"), nullptr);
  EXPECT_GT(std::stoul(*f16.header("X-Chamfer-Saturated")), 0u);
  std::uint16_t corner = 0;
  std::memcpy(&corner, f16.body.data() + 16, sizeof corner);
  EXPECT_EQ(corner, 0x7bff) << "65504, no infinity";
  EXPECT_EQ(get(bright + "exr").header("X-Chamfer-Saturated"), nullptr);
  EXPECT_EQ(get(tiles() + "16x16/0,0,16,16/0-1.f16").header("X-Chamfer-Saturated"), nullptr);
}

TEST_F(Images, FormatsAreWhatTheySay) {
  serve();
  EXPECT_THAT(get(tiles() + "16x16/0,0,16,16/0-1.png").body, StartsWith("\x89PNG"));
  EXPECT_EQ(get(tiles() + "16x16/0,0,16,16/0-1.png").contentType, "image/png");
  EXPECT_THAT(get(tiles() + "16x16/0,0,16,16/0-1.exr").body, StartsWith("\x76\x2f\x31\x01"));
  const Response frame = get("/v1/scenes/" + idOf("cube") + "/frames/16x16/0-1.png");
  EXPECT_EQ(frame.body, get(tiles() + "16x16/0,0,16,16/0-1.png").body)
      << "a frame is the tile that covers it";
  EXPECT_THAT(*frame.header("Content-Disposition"), HasSubstr("cube.png"));
}

TEST_F(Images, SameUrlSameBytes) {
  // Twice, with one thread and two, after a restart, with a rounding built anew.
  for (const char* query : {"", "?rounding=none", "?radius=0.25&seed=9"}) {
    const std::string path = "48x32/5,3,20,17/0-3.f16" + std::string(query);
    serve({.threads = 1});
    const Response first = get(tiles() + path), second = get(tiles() + path);
    serve({.threads = 2});
    const Response restarted = get(tiles() + path);
    ASSERT_EQ(first.status, 200);
    EXPECT_EQ(first.body, second.body) << query;
    EXPECT_EQ(first.body, restarted.body) << query;
    EXPECT_EQ(*first.header("ETag"), *restarted.header("ETag"));
    EXPECT_EQ(*first.header("X-Chamfer-Rays"), *restarted.header("X-Chamfer-Rays"));
  }
}

TEST_F(Images, TileIsACropOfTheFrame) {
  serve();
  const std::string frame = get(tiles() + "32x24/0,0,32,24/0-2.f16").body.substr(16);
  const std::string tile = get(tiles() + "32x24/7,5,11,9/0-2.f16").body.substr(16);
  for (std::size_t row = 0; row < 9; ++row)
    EXPECT_EQ(tile.substr(row * 11 * 8, 11 * 8), frame.substr(((row + 5) * 32 + 7) * 8, 11 * 8)) << row;
}

TEST_F(Images, SettingsChangeThePicture) {
  serve();
  const std::string base = get(tiles() + "32x32/0,0,32,32/0-1.f16").body;
  for (const char* query :
       {"?radius=0.4", "?rounding=none", "?seed=1", "?aov=normal", "?camera=0,-4,0.1,0,0,0,0,0,1,30"}) {
    const Response other = get(tiles() + "32x32/0,0,32,32/0-1.f16" + query);
    ASSERT_EQ(other.status, 200) << other.body;
    EXPECT_NE(other.body, base) << query;
  }
}

TEST_F(Images, EtagIsKnownWithoutRendering) {
  serve();
  const std::string tile = tiles() + "4096x4096/0,0,1024,1024/0-1024.png"; // minutes of work
  const Response head = ask("HEAD", tile);
  EXPECT_EQ(head.status, 200);
  EXPECT_TRUE(head.body.empty());
  const std::string etag = *head.header("ETag");
  for (const std::string& field : {etag, "W/" + etag, "\"x\", " + etag, std::string("*")}) {
    const Response response = get(tile, {{"if-none-match", field}});
    EXPECT_EQ(response.status, 304) << field;
    EXPECT_EQ(*response.header("ETag"), etag);
    EXPECT_TRUE(response.body.empty());
  }
}

TEST_F(Images, RadiusTooLargeNamesTheLargest) {
  serve();
  const Response response = get(tiles() + "16x16/0,0,16,16/0-1.f16?radius=0.5");
  EXPECT_EQ(response.status, 422);
  EXPECT_EQ(json(response)["parameter"], "radius");
  EXPECT_EQ(json(response)["value"], "0.5");
  EXPECT_NEAR(json(response)["limits"]["below"].get<double>(), 0.5, 1e-9);
  EXPECT_EQ(get(tiles() + "16x16/0,0,16,16/0-1.f16?radius=0.499").status, 200);
}

TEST_F(Images, ClientThatLeavesStopsItsRender) {
  serve({.threads = 1, .slots = 1});
  Request slow = request("GET", tiles() + "4096x4096/0,0,1024,1024/0-1024.f16");
  std::thread leaver([gone = slow.cancelled.clientGone] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    *gone = true;
  });
  const auto begin = std::chrono::steady_clock::now();
  const Response response = service_->answer(slow);
  leaver.join();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1));
  EXPECT_EQ(response.status, 499);
  EXPECT_EQ(json(get("/v1/info"))["queue"]["running"], 0);
}

TEST_F(Images, DeadlineEndsARender) {
  serve({.threads = 1, .deadline = std::chrono::milliseconds(150)});
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(get(tiles() + "4096x4096/0,0,1024,1024/0-1024.f16").status, 504);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(2));
}

TEST_F(Images, BeyondTheQueueIs503AndHealthAnswers) {
  serve({.threads = 1, .slots = 1, .waiting = 0});
  Request slow = request("GET", tiles() + "4096x4096/0,0,1024,1024/0-1024.f16");
  std::jthread renderer([&] { service_->answer(slow); });
  for (int i = 0; i < 500 && json(get("/v1/info"))["queue"]["running"] == 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  const Response refused = get(tiles() + "16x16/0,0,16,16/0-1.f16");
  EXPECT_EQ(refused.status, 503);
  EXPECT_GE(std::stoi(*refused.header("Retry-After")), 1);
  EXPECT_EQ(get("/livez").status, 200);
  *slow.cancelled.clientGone = true;
  renderer.join();
  EXPECT_EQ(get(tiles() + "16x16/0,0,16,16/0-1.f16").status, 200);
}

TEST_F(Images, WhatTheDeadlineCannotServeIsRefusedSoonWithWhatFits) {
  ServiceOptions options{.threads = 1, .slots = 1};
  options.deadline = std::chrono::seconds(4);
  serve(options);
  // Some hours of work, in many pixels or in many samples of a few.
  for (const char* resource : {"frames/4096x4096/0-128.exr", "tiles/64x64/0,0,64,64/0-500000.f16"}) {
    const auto begin = std::chrono::steady_clock::now();
    const Response response = get("/v1/scenes/" + idOf("cube") + '/' + resource);
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(2)) << resource;
    ASSERT_EQ(response.status, 422) << resource << ' ' << response.body;
    const auto problem = json(response);
    EXPECT_EQ(problem["parameter"], "samples");
    const auto asked = std::stoull(problem["value"].get<std::string>());
    const std::uint64_t most = problem["limits"]["maximum"];
    EXPECT_GT(most, 1000u);
    EXPECT_LT(most, asked / 4);
    EXPECT_EQ(json(get("/v1/info"))["queue"]["running"], 0) << "its slot is free";
  }
  EXPECT_EQ(get(tiles() + "64x64/0,0,64,64/0-4.f16").status, 200);
}

} // namespace
} // namespace chamfer::http
