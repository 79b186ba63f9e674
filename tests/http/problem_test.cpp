// Errors as clients see them: which are told whole, and word for word what is said of a request's parameters.
#include "server/http/routes/problem.h"

#include "server/render/request/parameter_error.h"
#include "tests/http/service_fixture.h"

namespace chamfer::http {
namespace {

TEST(Problem, OfAnErrorNamesNoFolderOfTheServerAndOfARequestItsOwnWords) {
  const Error ours(ErrorKind::StaleSidecar, "/srv/scenes/a.obj is newer");
  EXPECT_EQ(problemOf(ours, "/srv/scenes").detail, "a.obj is newer");
  const ParameterError theirs(ErrorKind::OutOfRange, "no /srv/scenes/a", "name", "/srv/scenes/a",
                              R"({"maximum":1})");
  const Problem problem = problemOf(theirs, "/srv/scenes");
  EXPECT_EQ(problem.status, 422);
  EXPECT_EQ(problem.kind, "out-of-range");
  EXPECT_EQ(problem.detail, "no /srv/scenes/a");
  EXPECT_EQ(problem.parameter, "name");
  EXPECT_EQ(problem.value, "/srv/scenes/a");
  EXPECT_EQ(problem.limits, R"({"maximum":1})");
}

class Refusals : public test::ServiceTest {};

TEST_F(Refusals, AreAnsweredWithParameterValueAndLimits) {
  folder_.addCube("cube.obj");
  serve();
  const struct {
    std::string target;
    int status;
    const char* rest; ///< of the answer, from "detail" on
  } refused[] = {
      {"tiles/0x64/0,0,64,64/0-1.png", 422,
       R"("width must be 1 to 65536","parameter":"width","value":"0","limits":{"minimum":1,"maximum":65536,"unit":"pixels"})"},
      {"tiles/64x64/0,0,64/0-1.png", 400,
       R"("the tile must be {x},{y},{w},{h}, as in 0,0,64,64","parameter":"x","value":"0,0,64","limits":{"minimum":0,"maximum":65535,"unit":"pixels"})"},
      {"tiles/64x64/%zz/0-1.png", 400,
       R"("the path has a broken percent escape, or one of a control character")"},
      {"tiles/64x64/0,0,64,64/0-1.png/x", 404,
       R"("a tile is tiles/{W}x{H}/{x},{y},{w},{h}/{s0}-{s1}.{f16|exr|png}")"},
      {"tiles/1024x1024/0,0,1024,1024/0-4096.png", 422,
       R"("pixels times samples of one request, ask for a smaller tile or fewer samples: 4294967296 exceed 2147483648","parameter":"samples","value":"4294967296","limits":{"maximum":2147483648})"},
      {"tiles/64x64/0,0,64,64/0-1.png?sead=1", 400,
       R"("there is no parameter \"sead\"; known: camera, rounding, radius, radius_clamp, seed, bounces, clamp, aov","parameter":"sead","value":"1")"},
      {"tiles/64x64/0,0,64,64/0-1.png?a=%", 400,
       R"("the query has a broken percent escape, or one of a control character","parameter":"query","value":"a=%")"},
      {"tiles/64x64/0,0,64,64/0-1.png?radius=1e999", 422,
       R"("radius must be a finite double","parameter":"radius","value":"1e999","limits":{"above":0,"maximum":1000000000000,"unit":"mesh units"})"},
      {"tiles/64x64/0,0,64,64/0-1.png?rounding=mesh:0", 422,
       R"("rounding \"mesh:0\": the number must be 1 to 256","parameter":"rounding","value":"mesh:0","limits":{"one_of":"analytic|none|mesh:K|bevel:N"})"},
      {"frames/320x200/0-4.f16", 400,
       R"("a frame is exr or png; f16 is for tiles","parameter":"format","value":"f16","limits":{"one_of":"f16|exr|png"})"},
  };
  for (const auto& [target, status, rest] : refused) {
    const Response response = get("/v1/scenes/" + idOf("cube") + '/' + target);
    EXPECT_EQ(response.status, status) << target;
    const std::string head =
        status == 400 ? R"({"type":"urn:chamfer:problem:usage","title":"Bad request","status":400,"detail":)"
        : status == 404
            ? R"({"type":"urn:chamfer:problem:not-found","title":"Not found","status":404,"detail":)"
            : R"({"type":"urn:chamfer:problem:out-of-range","title":"Value out of range",)"
              R"("status":422,"detail":)";
    EXPECT_EQ(response.body, head + rest + ",\"request_id\":\"" + *response.header("X-Request-Id") + "\"}\n");
  }
}

} // namespace
} // namespace chamfer::http
