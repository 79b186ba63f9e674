// One side of a comparison as people write it:
//   SCENE[?rounding=mesh:64&radius=..&seed=..&samples=..&width=..&height=..&up_axis=y]   a scene file or mesh
//   /v1/scenes/NAME/tiles/640x360/0,0,64,64/0-4.exr?rounding=..  (or frames/..)           a tile's URL
//   reference.exr                                                                         an image
//   digest:32HEX                                                                          the bits of a
//   render
// Parameters after '?' are those of tiles (tile_request.h).
#pragma once

#include "common/digest.h"
#include "server/render/request/tile_request.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace chamfer {

enum class SideKind : std::uint8_t {
  Scene,  ///< a scene of which as much is rendered as is compared
  Tile,   ///< the tile or frame of a URL: it is rendered whole, as the URL's answer is
  Image,  ///< a file
  Digest, ///< of a picture's bits: pictureDigest()
};

struct SideChoice {
  SideKind kind = SideKind::Image;
  std::string text; ///< as it was written
  /// Image and Scene: the file, relative to the suite's folder; of a tile's URL the name or id of the scene.
  std::string source;
  std::optional<UpAxis> upAxis; ///< of a bare mesh
  /// Scene: width and height are 0 and the samples 0-0 where the side does not say them.
  TileRequest request;
  Digest digest;

  bool isRender() const { return kind == SideKind::Scene || kind == SideKind::Tile; }
};

/// Throws ParameterError and Error(Usage) for what is no side.
SideChoice parseSide(const std::string& text);

/// What is not as by default, for people: ("rounding", "mesh:64") ...
std::vector<std::pair<std::string, std::string>> settingsOf(const TileRequest& request);

} // namespace chamfer
