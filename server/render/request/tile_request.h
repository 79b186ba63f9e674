// What a tile's or frame's URL asks for: the parser of
//   tiles/{W}x{H}/{x},{y},{w},{h}/{s0}-{s1}.{f16|exr|png}?camera=..&rounding=..&radius=..&radius_clamp=..&seed=..&bounces=..&clamp=..&aov=..
//   frames/{W}x{H}/{s0}-{s1}.{exr|png}?...
// camera = ex,ey,ez,tx,ty,tz,ux,uy,uz,vfov[,aperture,focus]: eye, target and up in world units, the vertical
// field of view in degrees, and for a thin lens the aperture's diameter and the focus distance (0: distance
// to the target). Limits of every value: parameters.cpp.
#pragma once

#include "common/digest.h"
#include "server/render/path/render.h"

#include <span>
#include <string>
#include <string_view>

namespace chamfer {

enum class ImageFormat : std::uint8_t { F16, Exr, Png };
const char* formatWord(ImageFormat format);

struct TileRequest {
  RenderSettings settings;
  TileRect tile;           ///< a frame is the tile that covers it
  RoundingChoice rounding; ///< the sharp mesh (None) has neither radius nor clamp: one spelling for it
  ImageFormat format = ImageFormat::F16;
  unsigned samples() const { return settings.endSample - settings.firstSample; }
};

/// `segments`: what follows "tiles", still percent-encoded: size, rectangle, samples. Throws ParameterError:
/// Usage for syntax and unknown or repeated parameters, OutOfRange for values outside their limits; and
/// Error(Usage) for a broken escape in `segments`, Error(NotFound) for another number of them.
TileRequest parseTile(std::span<const std::string_view> segments, std::string_view query);
/// `segments`: what follows "frames": size, samples.
TileRequest parseFrame(std::span<const std::string_view> segments, std::string_view query);

/// Sets what one parameter of a query says; `name` and `value` are decoded. Throws ParameterError, as
/// parseTile() does.
void readParameter(TileRequest& request, std::string_view name, std::string_view value);
Camera parseCamera(std::string_view text);
RoundingChoice parseRoundingWord(std::string_view text);

/// All that the pixels depend on beside the scene, in one spelling, so that requests spelled otherwise share
/// it. The format is not in it.
std::string canonicalSettings(const TileRequest& request);
/// The digest that stands for the answer's bytes before they exist: version of the program, scene, canonical
/// settings and format.
Digest answerDigest(std::string_view version, const Digest& scene, const TileRequest& request);

} // namespace chamfer
