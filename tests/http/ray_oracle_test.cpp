// POST rays against the oracle: 100,000 rays at the cube, half of them aimed near its edges, in one request.
#include "tests/http/service_fixture.h"
#include "tests/oracle/agreement.h"
#include "tests/oracle/convex_families.h"
#include "tests/oracle/ray_samples.h"

#include <iostream>
#include <map>

namespace chamfer::http {
namespace {

using RayOracle = test::ServiceTest;

oracle::Feature featureOf(const std::string& word) {
  if (word == "flat") return oracle::Feature::Flat;
  return word == "cylinder" ? oracle::Feature::Cylinder : oracle::Feature::Sphere;
}

TEST_F(RayOracle, AgreesOnAHundredThousandRays) {
  const double radius = 0.1;
  folder_.addCube("cube.obj", radius);
  serve();
  const oracle::ConvexSolid cube = oracle::cube();
  const auto rounded = std::make_shared<oracle::RoundedOracle>(cube, radius);
  oracle::RaySampler sampler(cube, *rounded, 21);
  constexpr std::size_t kRays = 100'000;
  std::vector<oracle::Ray> asked;
  for (const auto& [kind, share] : std::map<oracle::RayKind, std::size_t>{{oracle::RayKind::Distant, 4},
                                                                          {oracle::RayKind::Inside, 10},
                                                                          {oracle::RayKind::Far10, 10},
                                                                          {oracle::RayKind::Edge, 4},
                                                                          {oracle::RayKind::GrazingEdge, 8},
                                                                          {oracle::RayKind::Corner, 8},
                                                                          {oracle::RayKind::Tangent, 20}}) {
    const auto some = sampler.sample(kind, kRays / share);
    asked.insert(asked.end(), some.begin(), some.end());
  }
  asked.resize(std::min(asked.size(), kRays));
  nlohmann::json body{{"rays", nlohmann::json::array()}};
  for (oracle::Ray& ray : asked) {
    ray.tnear = 0;
    body["rays"].push_back({ray.origin.x(), ray.origin.y(), ray.origin.z(), ray.direction.x(),
                            ray.direction.y(), ray.direction.z()});
  }
  const Response response = rays("cube", body.dump());
  ASSERT_EQ(response.status, 200) << response.body;
  const nlohmann::json answer = json(response);
  const auto& hits = answer["hits"];
  ASSERT_EQ(hits.size(), asked.size());

  const oracle::Subject subject = [&](const oracle::Ray& ray) -> std::optional<oracle::Answer> {
    const auto& hit = hits[std::size_t(&ray - asked.data())];
    if (hit.is_null()) return std::nullopt;
    const auto& n = hit["normal"];
    return oracle::Answer{hit["t"].get<double>(),
                          {n[0].get<double>(), n[1].get<double>(), n[2].get<double>()},
                          featureOf(hit["feature"].get<std::string>())};
  };
  const auto report = oracle::compare(subject, oracle::UnionOracle(rounded), asked);
  std::cout << report.summary() << "\n";
  EXPECT_TRUE(report.agrees()) << report.complaint();
  EXPECT_GE(report.rays, 90'000u);
  // The position is the one at t.
  for (std::size_t i = 0; i < hits.size(); i += 97) {
    if (hits[i].is_null()) continue;
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(hits[i]["position"][std::size_t(k)].get<double>(),
                  asked[i].origin(k) + hits[i]["t"].get<double>() * asked[i].direction(k), 1e-9);
  }
}

} // namespace
} // namespace chamfer::http
