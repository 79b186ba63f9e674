#include "server/render/request/tile_request.h"

#include "common/text.h"
#include "server/render/request/parameter_error.h"
#include "server/render/request/parameters.h"
#include "server/render/request/query.h"
#include "server/render/request/render_words.h"

#include <array>
#include <cmath>

namespace chamfer {
namespace {

constexpr ImageFormat kFormats[] = {ImageFormat::F16, ImageFormat::Exr, ImageFormat::Png};

std::string decoded(std::string_view segment) { return decodePath({&segment, 1}); }

/// Cuts `text` at every `separator`.
std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t at = text.find(separator);
    parts.push_back(text.substr(0, at));
    if (at == std::string_view::npos) return parts;
    text.remove_prefix(at + 1);
  }
}

void parseSize(std::string_view segment, RenderSettings& settings) {
  const std::string text = decoded(segment);
  const auto parts = split(text, 'x');
  if (parts.size() != 2)
    throwSyntax(parameterRow("width"), text, "the frame's size must be {width}x{height}, as in 640x480");
  settings.width = readInteger(parameterRow("width"), parts[0]);
  settings.height = readInteger(parameterRow("height"), parts[1]);
}

void parseRectangle(std::string_view segment, const RenderSettings& settings, TileRect& tile) {
  const std::string text = decoded(segment);
  const auto parts = split(text, ',');
  if (parts.size() != 4)
    throwSyntax(parameterRow("x"), text, "the tile must be {x},{y},{w},{h}, as in 0,0,64,64");
  tile.x = readInteger(parameterRow("x"), parts[0]);
  tile.y = readInteger(parameterRow("y"), parts[1]);
  tile.width = readInteger(parameterRow("w"), parts[2]);
  tile.height = readInteger(parameterRow("h"), parts[3]);
  // All are at most 65536: the sums cannot wrap.
  if (tile.x + tile.width > settings.width)
    throwRange(parameterRow("w"), parts[2],
               "the tile ends at column " + std::to_string(tile.x + tile.width) + " of a frame " +
                   std::to_string(settings.width) + " wide");
  if (tile.y + tile.height > settings.height)
    throwRange(parameterRow("h"), parts[3],
               "the tile ends at row " + std::to_string(tile.y + tile.height) + " of a frame " +
                   std::to_string(settings.height) + " high");
}

void parseSamples(std::string_view segment, TileRequest& request) {
  const std::string text = decoded(segment);
  const std::size_t dot = text.rfind('.');
  const auto range = split(std::string_view(text).substr(0, dot), '-');
  if (dot == std::string::npos || range.size() != 2)
    throwSyntax(parameterRow("s0"), text, "the samples must be {s0}-{s1}.{format}, as in 0-4.png");
  request.settings.firstSample = readInteger(parameterRow("s0"), range[0]);
  request.settings.endSample = readInteger(parameterRow("s1"), range[1]);
  if (request.settings.endSample <= request.settings.firstSample)
    throwRange(parameterRow("s1"), range[1],
               "s1 is one past the last sample and must be above s0 = " + std::string(range[0]));
  const std::string_view word = std::string_view(text).substr(dot + 1);
  for (const ImageFormat format : kFormats)
    if (word == formatWord(format)) {
      request.format = format;
      return;
    }
  throwSyntax(parameterRow("format"), word, "the format is not known");
}

std::string queryNames() {
  std::string names;
  for (const ParameterRow& row : parameterRows())
    if (row.standsIn("query")) names += (names.empty() ? "" : ", ") + std::string(row.name);
  return names;
}

void readQuery(std::string_view text, TileRequest& request) {
  for (const auto& [name, value] : parseQuery(text))
    readParameter(request, name, value);
}

void checkWork(const TileRequest& request, std::uint64_t maxPixels) {
  const std::uint64_t pixels = std::uint64_t{request.tile.width} * request.tile.height;
  const auto refuse = [](const char* parameter, std::uint64_t value, std::uint64_t limit,
                         const std::string& what) {
    throw ParameterError(ErrorKind::OutOfRange,
                         what + " " + std::to_string(value) + " exceed " + std::to_string(limit), parameter,
                         std::to_string(value), "{\"maximum\":" + std::to_string(limit) + "}");
  };
  if (pixels > maxPixels) refuse("pixels", pixels, maxPixels, "the image's pixels");
  if (pixels * request.samples() > kMaxRequestSamples)
    refuse("samples", pixels * request.samples(), kMaxRequestSamples,
           "pixels times samples of one request, ask for a smaller tile or fewer samples:");
}

/// canonicalSettings() with `format` in it: the text of answers' digests, whose order must stay.
std::string spelled(const TileRequest& request, const std::string& format) {
  const RenderSettings& s = request.settings;
  const TileRect& t = request.tile;
  std::string text;
  for (const unsigned number :
       {s.width, s.height, t.x, t.y, t.width, t.height, s.firstSample, s.endSample, s.seed, s.maxBounces})
    text += std::to_string(number) + '|';
  text += format;
  text += std::string(aovWord(s.aov)) + '|' + roundingWord(request.rounding);
  text += '|' + (request.rounding.radius ? exactNumberText(*request.rounding.radius) : std::string());
  if (request.rounding.radiusClamp) text += "|radius clamp " + exactNumberText(*request.rounding.radiusClamp);
  if (s.indirectClamp > 0) text += "|clamp " + exactNumberText(double(s.indirectClamp));
  if (s.camera) {
    const Camera& c = *s.camera;
    for (const double number : {c.eye.x, c.eye.y, c.eye.z, c.target.x, c.target.y, c.target.z, c.up.x, c.up.y,
                                c.up.z, c.vfovDegrees, c.apertureDiameter, c.focusDistance})
      text += '|' + exactNumberText(number);
  }
  return text;
}

} // namespace

const char* formatWord(ImageFormat format) {
  switch (format) {
  case ImageFormat::F16:
    return "f16";
  case ImageFormat::Exr:
    return "exr";
  case ImageFormat::Png:
    return "png";
  }
  return "";
}

RoundingChoice parseRoundingWord(std::string_view text) {
  try {
    return parseRounding(text);
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::OutOfRange) throwRange(parameterRow("rounding"), text, error.what());
    throwSyntax(parameterRow("rounding"), text, error.what());
  }
}

Camera parseCamera(std::string_view text) {
  const ParameterRow& row = parameterRow("camera");
  const auto parts = split(text, ',');
  if (parts.size() != 10 && parts.size() != 12)
    throwSyntax(row, text, "camera must be 10 or 12 numbers, there are " + std::to_string(parts.size()));
  std::array<double, 12> n{};
  for (std::size_t i = 0; i < parts.size(); ++i)
    n[i] = readNumber(i == 9 ? parameterRow("vfov") : row, parts[i]) +
           0.0; // -0 becomes 0: one spelling, one image
  Camera camera;
  camera.eye = {n[0], n[1], n[2]};
  camera.target = {n[3], n[4], n[5]};
  camera.up = {n[6], n[7], n[8]};
  camera.vfovDegrees = n[9];
  camera.apertureDiameter = n[10];
  camera.focusDistance = n[11];

  const Vector3 view = camera.target - camera.eye;
  if (!(length(view) > 0)) throwRange(row, text, "the camera's eye and target are the same point");
  if (!(length(camera.up) > 0)) throwRange(row, text, "the camera's up vector is zero");
  // Below this sine double arithmetic leaves no reliable sideways direction.
  if (!(length(cross(normalize(view), normalize(camera.up))) > 1e-9))
    throwRange(row, text, "the camera's up vector is parallel to its view direction");
  if (camera.apertureDiameter < 0 || camera.focusDistance < 0)
    throwRange(row, text, "aperture and focus distance must not be negative");
  return camera;
}

void readParameter(TileRequest& request, std::string_view name, std::string_view value) {
  if (name == "camera")
    request.settings.camera = parseCamera(value);
  else if (name == "rounding") {
    const RoundingChoice choice = parseRoundingWord(value);
    request.rounding.mode = choice.mode;
    request.rounding.count = choice.count;
  } else if (name == "radius")
    request.rounding.radius = readNumber(parameterRow("radius"), value);
  else if (name == "radius_clamp")
    request.rounding.radiusClamp = readNumber(parameterRow("radius_clamp"), value) + 0.0; // no minus zero
  else if (name == "seed")
    request.settings.seed = readInteger(parameterRow("seed"), value);
  else if (name == "bounces")
    request.settings.maxBounces = readInteger(parameterRow("bounces"), value);
  else if (name == "clamp")
    request.settings.indirectClamp = float(readNumber(parameterRow("clamp"), value));
  else if (name == "aov") {
    try {
      request.settings.aov = parseAov(value);
    } catch (const Error& error) {
      throwSyntax(parameterRow("aov"), value, error.what());
    }
  } else
    throw ParameterError(ErrorKind::Usage,
                         "there is no parameter \"" + std::string(name) + "\"; known: " + queryNames(),
                         std::string(name), std::string(value));
  if (request.rounding.mode == RoundingMode::None) {
    request.rounding.radius.reset();
    request.rounding.radiusClamp.reset();
  }
}

TileRequest parseTile(std::span<const std::string_view> segments, std::string_view query) {
  if (segments.size() != 3)
    throw Error(ErrorKind::NotFound, "a tile is tiles/{W}x{H}/{x},{y},{w},{h}/{s0}-{s1}.{f16|exr|png}");
  TileRequest request;
  parseSize(segments[0], request.settings);
  parseRectangle(segments[1], request.settings, request.tile);
  parseSamples(segments[2], request);
  readQuery(query, request);
  checkWork(request, kMaxTilePixels);
  return request;
}

TileRequest parseFrame(std::span<const std::string_view> segments, std::string_view query) {
  if (segments.size() != 2) throw Error(ErrorKind::NotFound, "a frame is frames/{W}x{H}/{s0}-{s1}.{exr|png}");
  TileRequest request;
  parseSize(segments[0], request.settings);
  request.tile = {0, 0, request.settings.width, request.settings.height};
  parseSamples(segments[1], request);
  if (request.format == ImageFormat::F16)
    throwSyntax(parameterRow("format"), "f16", "a frame is exr or png; f16 is for tiles");
  readQuery(query, request);
  checkWork(request, kMaxFramePixels);
  return request;
}

std::string canonicalSettings(const TileRequest& request) { return spelled(request, ""); }

Digest answerDigest(std::string_view version, const Digest& scene, const TileRequest& request) {
  return digestOf(std::string(version) + '|' + scene.hex() + '|' +
                  spelled(request, std::string(formatWord(request.format)) + '|'));
}

} // namespace chamfer
