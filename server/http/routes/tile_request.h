// What a tile's or frame's URL asks for: the parser of
//   tiles/{W}x{H}/{x},{y},{w},{h}/{s0}-{s1}.{f16|exr|png}?camera=..&rounding=..&radius=..&radius_clamp=..&seed=..&bounces=..&clamp=..&aov=..
//   frames/{W}x{H}/{s0}-{s1}.{exr|png}?...
// camera = ex,ey,ez,tx,ty,tz,ux,uy,uz,vfov[,aperture,focus]: eye, target and up in world units, the vertical
// field of view in degrees, and for a thin lens the aperture's diameter and the focus distance (0: distance
// to the target). Limits of every value: schema.cpp.
#pragma once

#include "common/digest.h"
#include "server/http/connection/url.h"
#include "server/render/path/render.h"

#include <span>
#include <string>

namespace chamfer::http {

enum class ImageFormat : std::uint8_t { F16, Exr, Png };
const char* formatWord(ImageFormat format);
const char* contentTypeOf(ImageFormat format);

struct TileRequest {
  RenderSettings settings;
  TileRect tile; ///< a frame is the tile that covers it
  RoundingChoice rounding;
  ImageFormat format = ImageFormat::F16;
  unsigned samples() const { return settings.endSample - settings.firstSample; }
};

/// `segments`: what follows "tiles", still percent-encoded: size, rectangle, samples. All throw ProblemError
/// with parameter, value and limits: 400 for syntax and unknown or repeated parameters, 404 for another
/// number of segments, 422 for values out of range.
TileRequest parseTile(std::span<const std::string_view> segments, std::string_view query);
/// `segments`: what follows "frames": size, samples.
TileRequest parseFrame(std::span<const std::string_view> segments, std::string_view query);
Camera parseCamera(std::string_view text);
RoundingChoice parseRoundingWord(std::string_view text);

/// The digest that stands for the answer's bytes before they exist: scene, settings in one canonical
/// spelling, and the version of the program. Equal requests in other spellings share it.
Digest answerDigest(const Digest& scene, const TileRequest& request);

} // namespace chamfer::http
