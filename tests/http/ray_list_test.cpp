#include "server/http/routes/ray_list.h"

#include "server/http/schema/limits.h"
#include "tests/http/expect_problem.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace chamfer::http {
namespace {

using test::problemFrom;

TEST(RayList, ReadsEveryKey) {
  const RayList list = parseRayList(
      R"({"tnear":0.5,"radius":2e-2,"radius_clamp":0.5,"rounding":"analytic","rays":[[0,0.5,-1e3,1,0,0],[1,2,3,-4,5.25,6]]})");
  ASSERT_EQ(list.rays.size(), 2u);
  EXPECT_EQ(list.rays[0].origin, Point3(0, 0.5, -1000));
  EXPECT_EQ(list.rays[0].direction, Vector3(1, 0, 0));
  EXPECT_EQ(list.rays[1].direction, Vector3(-4, 5.25, 6));
  EXPECT_EQ(list.rounding.radius, 0.02);
  EXPECT_EQ(list.rounding.radiusClamp, 0.5);
  EXPECT_EQ(list.rounding.mode, RoundingMode::Analytic);
  EXPECT_EQ(list.tnear, 0.5);
}

TEST(RayList, NeedsNothingButRays) {
  const RayList list = parseRayList(R"({"rays":[]})");
  EXPECT_TRUE(list.rays.empty());
  EXPECT_EQ(list.rounding, RoundingChoice{});
  EXPECT_EQ(list.tnear, 0);
}

TEST(RayList, RadiusSurvivesWhateverTheOrderOfKeys) {
  EXPECT_EQ(parseRayList(R"({"rays":[],"radius":0.1,"rounding":"mesh:4"})").rounding.radius, 0.1);
  EXPECT_EQ(parseRayList(R"({"rays":[],"radius_clamp":0,"rounding":"mesh:4"})").rounding.radiusClamp, 0.0);
  EXPECT_EQ(parseRayList(R"({"rays":[],"rounding":"mesh:4","radius":0.1})").rounding.count, 4u);
}

struct Refusal {
  const char* body;
  int status;
  const char* parameter;
  const char* value;
};

class RefusedRays : public testing::TestWithParam<Refusal> {};

TEST_P(RefusedRays, NamesPlaceAndValue) {
  const Problem problem = problemFrom([] { parseRayList(GetParam().body); }, GetParam().status);
  EXPECT_EQ(problem.parameter, GetParam().parameter);
  EXPECT_EQ(problem.value, GetParam().value);
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, RefusedRays,
    testing::Values(Refusal{R"({"rays":[],"radius_clamp":1})", 422, "radius_clamp", "1"},
                    Refusal{"[]", 400, "body", "[...]"}, Refusal{"7", 400, "body", "7"},
                    Refusal{"{}", 400, "rays", ""}, Refusal{R"({"rays":7})", 400, "rays", "7"},
                    Refusal{R"({"rays":{}})", 400, "rays", "{...}"},
                    Refusal{R"({"rays":[7]})", 400, "rays[0]", "7"},
                    Refusal{R"({"rays":[[0,0,0,0,0,1],null]})", 400, "rays[1]", "null"},
                    Refusal{R"({"rays":[[0,0,0,0,0]]})", 400, "rays[0]", "a list of 5"},
                    Refusal{R"({"rays":[[0,0,0,0,0,1,2]]})", 400, "rays[0][6]", "2"},
                    Refusal{R"({"rays":[[0,0,0,0,0,1],[0,0,"x",0,0,1]]})", 400, "rays[1][2]", "\"x\""},
                    Refusal{R"({"rays":[[0,0,0,0,0,[1]]]})", 400, "rays[0][5]", "[...]"},
                    Refusal{R"({"rays":[[true,0,0,0,0,1]]})", 400, "rays[0][0]", "true"},
                    Refusal{R"({"rays":[],"rays":[]})", 400, "rays", "rays"},
                    Refusal{R"({"rays":[],"seed":1})", 400, "seed", "seed"},
                    Refusal{R"({"rays":[],"rounding":1})", 400, "rounding", "1"},
                    Refusal{R"({"rays":[],"rounding":"soft"})", 400, "rounding", "soft"},
                    Refusal{R"({"rays":[],"radius":"0.1"})", 400, "radius", "\"0.1\""},
                    Refusal{R"({"rays":[],"tnear":null})", 400, "tnear", "null"}));

INSTANTIATE_TEST_SUITE_P(
    Ranges, RefusedRays,
    testing::Values(Refusal{R"({"rays":[[0,0,0,0,0,1],[1,2,3,0,0,0]]})", 422, "rays[1]", "0,0,0"},
                    Refusal{R"({"rays":[[0,0,0,0,-0.0,0]]})", 422, "rays[0]", "0,0,0"},
                    Refusal{R"({"rays":[[0,0,0,0,0,1e-200]]})", 422, "rays[0]", "0"},
                    Refusal{R"({"rays":[[0,0,0,0,0,1e999]]})", 422, "rays[0][5]", "1e999"},
                    Refusal{R"({"rays":[[0,-1e31,0,0,0,1]]})", 422, "rays[0][1]", "-1e31"},
                    Refusal{R"({"rays":[],"radius":0})", 422, "radius", "0"},
                    Refusal{R"({"rays":[],"radius":-3})", 422, "radius", "-3"},
                    Refusal{R"({"rays":[],"tnear":-1})", 422, "tnear", "-1"}));

TEST(RayList, BrokenJsonNamesTheByteAndNothingOfTheLibrary) {
  for (const char* body :
       {"", "{", "{\"rays\":[[0,0,0,0,0,NaN]]}", "{\"rays\":[[0,0,0,0,0,1],]}", "{\"rays\":[]}x",
        "{\"rays\":[[0,0,0,0,0,01]]}", "\xff\xfe", "{\"ra\xc3ys\":[]}"}) {
    const Problem problem = problemFrom([&] { parseRayList(body); }, 400);
    EXPECT_NE(problem.detail.find("byte"), std::string::npos) << problem.detail;
    EXPECT_EQ(problem.detail.find("json"), std::string::npos) << problem.detail;
    EXPECT_EQ(problem.detail.find("exception"), std::string::npos) << problem.detail;
  }
}

TEST(RayList, DeepNestingIsRefusedAtOnce) {
  const Problem problem = problemFrom([] { parseRayList(std::string(1'000'000, '[')); }, 400);
  EXPECT_EQ(problem.parameter, "body");
}

TEST(RayList, TakesAsManyRaysAsStatedAndNoMore) {
  std::string body = R"({"rays":[)";
  for (std::size_t i = 0; i < kMaxRays; ++i)
    body += i ? ",[0,0,0,0,0,1]" : "[0,0,0,0,0,1]";
  EXPECT_EQ(parseRayList(body + "]}").rays.size(), kMaxRays);
  EXPECT_EQ(problemFrom([&] { parseRayList(body + ",[0,0,0,0,0,1]]}"); }, 422).parameter, "rays");
}

TEST(RayList, HitsReadBackExactly) {
  TraceHit hit{};
  hit.t = 1.0 / 3;
  hit.position = {0.1, -2e-17, 3e17};
  hit.normal = {0, 0.6, 0.8};
  hit.feature = Feature::Cylinder;
  hit.instance = 4;
  hit.solid = 2;
  hit.triangle = 17;
  TraceHit sharp = hit;
  sharp.feature = Feature::Flat;
  sharp.solid = kNone;
  sharp.t = INFINITY;
  const std::vector<std::optional<TraceHit>> hits{hit, std::nullopt, sharp};
  const auto json = nlohmann::json::parse(printHits(hits))["hits"];
  ASSERT_EQ(json.size(), 3u);
  EXPECT_EQ(json[0]["t"].get<double>(), hit.t);
  EXPECT_EQ(json[0]["position"][1].get<double>(), hit.position.y);
  EXPECT_EQ(json[0]["position"][2].get<double>(), hit.position.z);
  EXPECT_EQ(json[0]["normal"][2].get<double>(), 0.8);
  EXPECT_EQ(json[0]["feature"], "cylinder");
  EXPECT_EQ(json[0]["instance"], 4);
  EXPECT_EQ(json[0]["solid"], 2);
  EXPECT_EQ(json[0]["triangle"], 17);
  EXPECT_TRUE(json[1].is_null());
  EXPECT_TRUE(json[2]["solid"].is_null());
  EXPECT_TRUE(json[2]["t"].is_null());
}

} // namespace
} // namespace chamfer::http
