#include "server/jobs/suite/side.h"

#include "common/error.h"
#include "common/text.h"
#include "server/render/request/parameter_error.h"
#include "server/render/request/parameters.h"
#include "server/render/request/query.h"
#include "server/render/request/render_words.h"

#include <algorithm>
#include <array>
#include <filesystem>

namespace chamfer {
namespace {

constexpr std::string_view kDigestPrefix = "digest:";
constexpr std::array kImageExtensions = {".exr", ".png", ".hdr",  ".jpg", ".jpeg", ".tif", ".tiff",
                                         ".pfm", ".tga", ".webp", ".bmp", ".ppm",  ".pgm"};

bool isImageName(std::string_view name) {
  const std::string extension = lowerCase(std::filesystem::path(name).extension().string());
  return std::find(kImageExtensions.begin(), kImageExtensions.end(), extension) != kImageExtensions.end();
}

Digest readDigest(const std::string& text) {
  const std::string_view hex = std::string_view(text).substr(kDigestPrefix.size());
  const bool valid = hex.size() == 32 && std::all_of(hex.begin(), hex.end(), [](char c) {
                       return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
                     });
  if (!valid)
    throw Error(ErrorKind::Usage, inQuotes(text) +
                                      ": a digest has 32 hexadecimal digits in lower case; --update writes "
                                      "the one that a render has now");
  const auto half = [&](std::size_t at) { return std::stoull(std::string(hex.substr(at, 16)), nullptr, 16); };
  return {half(0), half(16)};
}

UpAxis readUpAxis(const std::string& value) {
  if (value != "y" && value != "z")
    throw ParameterError(ErrorKind::Usage, "up_axis must be y or z", "up_axis", value);
  return value == "y" ? UpAxis::Y : UpAxis::Z;
}

/// "…/v1/scenes/NAME/tiles/…": where "tiles" or "frames" stands among its segments; 0: it is no such URL.
std::size_t imageSegment(const std::vector<std::string_view>& segments) {
  const std::size_t n = segments.size();
  if (n >= 5 && segments[n - 4] == "tiles") return n - 4;
  if (n >= 4 && segments[n - 3] == "frames") return n - 3;
  return 0;
}

/// The path of a URL without scheme and host.
std::string_view pathOf(std::string_view url) {
  const std::size_t scheme = url.find("://");
  if (scheme == std::string_view::npos) return url;
  const std::size_t path = url.find('/', scheme + 3);
  return path == std::string_view::npos ? std::string_view("/") : url.substr(path);
}

bool readTileUrl(std::string_view path, std::string_view query, SideChoice& side) {
  path = pathOf(path);
  constexpr std::string_view kScenes = "/v1/scenes/";
  if (!path.starts_with(kScenes)) return false;
  path.remove_prefix(kScenes.size() - 1);
  const auto segments = splitPath(path); // the path begins with '/'
  const std::size_t word = imageSegment(segments);
  if (word == 0)
    throw Error(ErrorKind::Usage, inQuotes(side.text, 200) +
                                      ": a side that is a URL is that of a tile or a frame, as in "
                                      "/v1/scenes/blocks/tiles/640x360/0,0,64,64/0-4.exr");
  const std::span all(segments);
  side.kind = SideKind::Tile;
  side.source = decodePath(all.first(word));
  const auto rest = all.subspan(word + 1);
  side.request = segments[word] == "tiles" ? parseTile(rest, query) : parseFrame(rest, query);
  return true;
}

void readSceneQuery(std::string_view query, SideChoice& side) {
  RenderSettings& settings = side.request.settings;
  settings.endSample = 0; // not said
  for (const auto& [name, value] : parseQuery(query)) {
    if (name == "width")
      settings.width = readInteger(parameterRow("width"), value);
    else if (name == "height")
      settings.height = readInteger(parameterRow("height"), value);
    else if (name == "samples")
      settings.endSample = readInteger(parameterRow("s1"), value);
    else if (name == "up_axis")
      side.upAxis = readUpAxis(value);
    else
      readParameter(side.request, name, value);
  }
  if ((settings.width == 0) != (settings.height == 0))
    throw Error(ErrorKind::Usage,
                inQuotes(side.text, 200) + ": width and height of a frame are given together");
}

std::string cameraText(const Camera& c) {
  std::string text;
  for (const double n : {c.eye.x, c.eye.y, c.eye.z, c.target.x, c.target.y, c.target.z, c.up.x, c.up.y,
                         c.up.z, c.vfovDegrees, c.apertureDiameter, c.focusDistance})
    text += (text.empty() ? "" : ",") + exactNumberText(n);
  return text;
}

} // namespace

SideChoice parseSide(const std::string& text) {
  SideChoice side;
  side.text = text;
  if (text.starts_with(kDigestPrefix)) {
    side.kind = SideKind::Digest;
    side.digest = readDigest(text);
    return side;
  }
  const std::size_t mark = text.find('?');
  const std::string_view path = std::string_view(text).substr(0, mark);
  const std::string_view query =
      mark == std::string::npos ? std::string_view() : std::string_view(text).substr(mark + 1);
  if (path.empty()) throw Error(ErrorKind::Usage, "a side names a scene, a tile's URL or an image");
  if (readTileUrl(path, query, side)) return side;
  side.source = path;
  side.kind = isImageName(path) ? SideKind::Image : SideKind::Scene;
  if (side.kind == SideKind::Scene)
    readSceneQuery(query, side);
  else if (mark != std::string::npos)
    throw Error(ErrorKind::Usage, inQuotes(text, 200) + ": an image takes no parameters");
  return side;
}

std::vector<std::pair<std::string, std::string>> settingsOf(const TileRequest& request) {
  const RenderSettings& s = request.settings;
  const RenderSettings usual;
  std::vector<std::pair<std::string, std::string>> all;
  if (request.rounding.mode != RoundingMode::Analytic)
    all.emplace_back("rounding", roundingWord(request.rounding));
  if (request.rounding.radius) all.emplace_back("radius", exactNumberText(*request.rounding.radius));
  if (request.rounding.radiusClamp)
    all.emplace_back("radius_clamp", exactNumberText(*request.rounding.radiusClamp));
  if (s.seed != usual.seed) all.emplace_back("seed", std::to_string(s.seed));
  if (s.maxBounces != usual.maxBounces) all.emplace_back("bounces", std::to_string(s.maxBounces));
  if (s.indirectClamp > 0) all.emplace_back("clamp", exactNumberText(plainNumber(s.indirectClamp)));
  if (s.aov != usual.aov) all.emplace_back("aov", aovWord(s.aov));
  if (s.camera) all.emplace_back("camera", cameraText(*s.camera));
  return all;
}

} // namespace chamfer
