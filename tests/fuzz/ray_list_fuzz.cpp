// The body of POST .../rays: any bytes are refused with a Problem, or are rays that a tracer can work with.
#include "server/http/routes/problem.h"
#include "server/http/routes/ray_list.h"
#include "server/http/schema/limits.h"
#include "tests/fuzz/require.h"

#include <cmath>

using namespace chamfer;
using namespace chamfer::http;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const RayList list = parseRayList({reinterpret_cast<const char*>(data), size});
    REQUIRE(list.rays.size() <= kMaxRays);
    REQUIRE(std::isfinite(list.tnear) && list.tnear >= 0);
    REQUIRE(!list.rounding.radius || (std::isfinite(*list.rounding.radius) && *list.rounding.radius > 0));
    for (const auto& [origin, direction] : list.rays) {
      REQUIRE(std::isfinite(origin.x) && std::isfinite(origin.y) && std::isfinite(origin.z));
      REQUIRE(std::isnormal(lengthSquared(direction)));
    }
  } catch (const Error& error) {
    const Problem problem = problemOf(error, "");
    REQUIRE(problem.status == 400 || problem.status == 422);
    (void)toResponse(problem, "fuzz");
  }
  return 0;
}
