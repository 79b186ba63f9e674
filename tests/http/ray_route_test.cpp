// POST rays against what is known of a rounded cube without the renderer.
#include "tests/http/service_fixture.h"

#include <cmath>
#include <gmock/gmock.h>
#include <random>

namespace chamfer::http {
namespace {

class Rays : public test::ServiceTest {
protected:
  Rays() {
    folder_.addCube("cube.obj", kRadius);
    serve();
  }
  static constexpr double kRadius = 0.1, kHalf = 0.5;

  /// Distance to the rounded cube: a box of half size kHalf - r grown by r.
  static double distance(const nlohmann::json& p, double r) {
    double squared = 0;
    for (int i = 0; i < 3; ++i) {
      const double beyond = std::max(0.0, std::abs(p[i].get<double>()) - (kHalf - r));
      squared += beyond * beyond;
    }
    return std::sqrt(squared) - r;
  }
};

TEST_F(Rays, AnswersInOrder) {
  const Response response =
      rays("cube", R"({"rays":[[0,0,5,0,0,-1],[9,9,9,0,0,1],[0,0,5,0,0,-4],[0,0.5,0.5,0,-1,-1]]})");
  ASSERT_EQ(response.status, 200) << response.body;
  EXPECT_EQ(response.contentType, "application/json");
  const auto hits = json(response)["hits"];
  ASSERT_EQ(hits.size(), 4u);
  EXPECT_EQ(hits[0]["t"], 4.5);
  EXPECT_EQ(hits[0]["normal"], (nlohmann::json{0, 0, 1}));
  EXPECT_EQ(hits[0]["feature"], "flat");
  EXPECT_EQ(hits[0]["instance"], 0);
  EXPECT_EQ(hits[0]["solid"], 0);
  EXPECT_TRUE(hits[1].is_null());
  EXPECT_EQ(hits[2]["t"], 4.5 / 4) << "in units of the direction's length";
  EXPECT_EQ(hits[3]["feature"], "cylinder") << "from the sliver over the middle of an edge";
  EXPECT_NEAR(hits[3]["normal"][1].get<double>(), std::sqrt(0.5), 1e-7);
}

TEST_F(Rays, EveryHitIsOnTheRoundedCubeAndEveryMissMisses) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> at(-0.75, 0.75), far(-3, 3);
  nlohmann::json body{{"rays", nlohmann::json::array()}};
  for (int i = 0; i < 5000; ++i) {
    const double target[3] = {at(random), at(random), at(random)},
                 eye[3] = {far(random), far(random), far(random)};
    body["rays"].push_back(
        {eye[0], eye[1], eye[2], target[0] - eye[0], target[1] - eye[1], target[2] - eye[2]});
  }
  for (const double r : {kRadius, 0.3}) {
    body["radius"] = r;
    const auto hits = json(rays("cube", body.dump()))["hits"];
    ASSERT_EQ(hits.size(), 5000u);
    std::size_t found = 0, rounded = 0;
    for (std::size_t i = 0; i < hits.size(); ++i) {
      const auto& ray = body["rays"][i];
      if (!hits[i].is_null()) {
        ++found;
        rounded += hits[i]["feature"] != "flat";
        EXPECT_NEAR(distance(hits[i]["position"], r), 0, 1e-6) << ray.dump();
        continue;
      }
      // A miss may not come inside anywhere in front.
      for (int k = 0; k <= 200; ++k) {
        nlohmann::json p;
        for (std::size_t c = 0; c < 3; ++c)
          p.push_back(ray[c].get<double>() + k * 0.01 * ray[c + 3].get<double>());
        ASSERT_GT(distance(p, r), -1e-6) << ray.dump();
      }
    }
    EXPECT_GT(found, 1000u);
    EXPECT_GT(rounded, 100u);
  }
}

TEST_F(Rays, RoundingAndTnearAreObeyed) {
  const auto first = [&](const std::string& rest) {
    return json(rays("cube", R"({"rays":[[0.49,0.49,5,0,0,-1]])" + rest + "}"))["hits"][0];
  };
  EXPECT_TRUE(first("").is_null()) << "the corner is rounded away";
  EXPECT_EQ(first(R"(,"rounding":"none")")["t"], 4.5);
  EXPECT_FALSE(first(R"(,"radius":0.01)").is_null());
  EXPECT_EQ(json(rays("cube", R"({"rays":[[0,0,5,0,0,-1]],"tnear":4.75})"))["hits"][0]["t"], 5.5);
}

TEST_F(Rays, StudioDoesNotAnswer) {
  EXPECT_TRUE(json(rays("cube", R"({"rays":[[3,3,5,0,0,-1]]})"))["hits"][0].is_null())
      << "there is a ground below";
}

TEST_F(Rays, LargestNumbersDoNoHarm) {
  serve();
  for (const char* ray :
       {"[1e30,-3,0.1,-1,1,0]", "[3,-1e30,1e30,-1,1,0]", "[0,0,5,0,0,-1e30]", "[0,0,5e18,0,0,-1]"})
    EXPECT_EQ(rays("cube", std::string(R"({"rays":[)") + ray + "]}").status, 200) << ray;
  const auto hit = json(rays("cube", R"({"rays":[[0,0,1e6,0,0,-1e25]]})"))["hits"][0];
  EXPECT_NEAR(hit["position"][2].get<double>(), 0.5, 1e-6);
  EXPECT_NEAR(hit["t"].get<double>() * 1e25, 1e6 - 0.5, 1e-6);
}

TEST_F(Rays, OnlyJsonIsRead) {
  for (const char* type : {"text/plain", "application/x-www-form-urlencoded", "", "application/jsonx"}) {
    const Response response = ask("POST", "/v1/scenes/cube/rays", {{"content-type", type}}, R"({"rays":[]})");
    EXPECT_EQ(response.status, 415) << type;
  }
  EXPECT_EQ(ask("POST", "/v1/scenes/cube/rays", {{"content-type", "application/json; charset=utf-8"}},
                R"({"rays":[]})")
                .status,
            200);
}

TEST_F(Rays, MalformedListsAreNamedAndDoNoHarm) {
  EXPECT_EQ(rays("cube", "{").status, 400);
  EXPECT_EQ(rays("cube", R"({"rays":[[0,0,0,0,0,0]]})").status, 422);
  EXPECT_EQ(rays("cube", R"({"rays":[[0,0,0,0,0,1]],"radius":0.7})").status, 422);
  EXPECT_EQ(rays("none", R"({"rays":[]})").status, 404);
  EXPECT_EQ(ask("POST", "/v1/scenes/cube/rays?radius=1", {{"content-type", "application/json"}}, "{}").status,
            400);
  EXPECT_EQ(rays("cube", R"({"rays":[[0,0,5,0,0,-1]]})").status, 200);
}

} // namespace
} // namespace chamfer::http
