#include "server/jobs/suite/canonical.h"

#include <gtest/gtest.h>

namespace chamfer {
namespace {

const CaseOrigins kOrigins{"id a", "id b", ""};

std::string canonical(const std::string& members, const CaseOrigins& origins = kOrigins,
                      const std::string& defaults = "{}") {
  const auto cases = parseSuite(R"({"schema":"chamfer.cases/1","defaults":)" + defaults +
                                    R"(,"cases":[{"name":"n",)" + members + "}]}",
                                "test");
  return canonicalCase(cases.at(0), origins);
}

TEST(Canonical, SpellingsOfOneCaseAreOneText) {
  const std::string plain = canonical(R"("a":"x.scene.json","b":"x.scene.json?rounding=mesh:4")");
  for (
      const char* same : {
          R"("b":"x.scene.json?rounding=mesh:4","a":"x.scene.json")", // order
          R"("a":"other name","b":"y.obj?rounding=mesh:4")",          // what counts is the origin
          R"("a":"x.scene.json?rounding=analytic","b":"x.scene.json?rounding=mesh:4")",
          R"("a":"x.scene.json?seed=0&bounces=8","b":"x.scene.json?bounces=8&rounding=mesh:4")",
          R"("a":"x.scene.json","b":"x.scene.json?rounding=mesh:4","samples":4,"seeds":128,"width":640,"height":360)",
          R"("a":"x?width=640&height=360","b":"x?rounding=mesh:4")", // the other side's size
          R"("a":"x?samples=4","b":"x?rounding=mesh:4")",
          R"("a":"x","b":"x?rounding=mesh:4","statistics":true)",
          R"("a":"x","b":"x?rounding=mesh:4","seconds":0,"limits":{},"only":[],"tolerance":{"absolute":0})",
      })
    EXPECT_EQ(canonical(same), plain) << same;
  EXPECT_EQ(canonical(R"("a":"x","b":"x?rounding=mesh:4")", kOrigins, R"({"samples":4})"), plain);
  EXPECT_EQ(canonical(R"("a":"x","b":"y","limits":{"mae":1,"rmse":2})"),
            canonical(R"("a":"x","b":"y","limits":{"rmse":2,"mae":1.0})"));
}

TEST(Canonical, WhatMattersIsInTheText) {
  const std::string plain = canonical(R"("a":"x","b":"y")");
  for (const char* other : {
           R"("a":"x?seed=1","b":"y")",
           R"("a":"x?radius=0.1","b":"y")",
           R"("a":"x?aov=normal","b":"y")",
           R"("a":"x","b":"y","samples":5)",
           R"("a":"x","b":"y","seeds":64)",
           R"("a":"x","b":"y","seconds":1)",
           R"("a":"x","b":"y","width":641,"height":360)",
           R"("a":"x","b":"y","crop":[0,0,8,8])",
           R"("a":"x","b":"y","only":[[0,0,8,8]])",
           R"("a":"x","b":"y","except":[[0,0,8,8]])",
           R"("a":"x","b":"y","limits":{"mae":1})",
           R"("a":"x","b":"y","tolerance":{"relative":0.1})",
           R"("a":"x","b":"y","statistics":{"significance":0.02})",
           R"("a":"x","b":"y","statistics":{"resolution":{"pixel":2}})",
           R"("a":"x","b":"y.exr")",
           R"("a":"x","b":"digest:00000000000000000000000000000000")",
           R"("a":"/v1/scenes/x/frames/640x360/0-4.png","b":"y")",
       })
    EXPECT_NE(canonical(other), plain) << other;
  EXPECT_NE(canonical(R"("a":"x","b":"y")", {"id a", "id c", ""}), plain);
  EXPECT_NE(canonical(R"("a":"x","b":"y")", {"id a", "id b", "mask"}), plain);
}

TEST(Canonical, ASizeLeftToAnImageStaysOpen) {
  const auto cases = parseSuite(
      R"({"schema":"chamfer.cases/1","cases":[{"name":"n","a":"x","b":"y.exr"},{"name":"m","a":"x","b":"y"}]})",
      "test");
  EXPECT_EQ(resolvedRequest(cases[0].a, cases[0].b, cases[0]).settings.width, 0u);
  EXPECT_EQ(resolvedRequest(cases[1].a, cases[1].b, cases[1]).settings.width, kUsualWidth);
}

} // namespace
} // namespace chamfer
