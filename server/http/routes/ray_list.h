// The body of POST /v1/scenes/{scene}/rays and its answer.
//   {"rays":[[ox,oy,oz,dx,dy,dz],...], "rounding":"analytic", "radius":r?, "radius_clamp":c?, "tnear":0?}
//   {"hits":[{"t":..,"position":[..],"normal":[..],"feature":"flat|cylinder|sphere","instance":i,"solid":s,
//             "triangle":k}, null, ...]}
#pragma once

#include "server/render/path/render.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace chamfer::http {

struct RayList {
  std::vector<Ray> rays; ///< world; directions of any length but zero
  RoundingChoice rounding;
  double tnear = 0; ///< in lengths of each ray's direction
};

/// Reads the body in one pass, without building a document. Throws ParameterError, Usage for what is not of
/// that form and OutOfRange for values out of range; each names the ray's index, the component and the value.
RayList parseRayList(std::string_view body);

/// `hits` in the rays' order, nothing for a miss. Numbers read back as the same doubles; one that is not
/// finite becomes null, `solid` is null where the mesh stays sharp.
std::string printHits(std::span<const std::optional<TraceHit>> hits);

} // namespace chamfer::http
