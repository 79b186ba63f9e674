#include "server/render/request/parameters.h"

#include "common/sidecar.h"
#include "common/text.h"
#include "server/render/request/parameter_error.h"
#include "server/render/request/render_words.h"

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

namespace chamfer {
namespace {

constexpr double kMaxCoordinate = 1e12;
constexpr double kMaxSample = 1u << 20;

constexpr ParameterRow kRows[] = {
    {"scene", "path", ParameterKind::Text, "", "", 0, 0, false, "", "name or id of a scene, as listed"},
    {"width", "path", ParameterKind::Integer, "pixels", "", 1, 65536, false, "", "of the whole frame"},
    {"height", "path", ParameterKind::Integer, "pixels", "", 1, 65536, false, "", "of the whole frame"},
    {"x", "path", ParameterKind::Integer, "pixels", "", 0, 65535, false, "", "left column of the tile"},
    {"y", "path", ParameterKind::Integer, "pixels", "", 0, 65535, false, "",
     "top row of the tile, down from the frame's top"},
    {"w", "path", ParameterKind::Integer, "pixels", "", 1, 65536, false, "",
     "width of the tile; it must lie inside the frame"},
    {"h", "path", ParameterKind::Integer, "pixels", "", 1, 65536, false, "", "height of the tile"},
    {"s0", "path", ParameterKind::Integer, "samples", "", 0, kMaxSample - 1, false, "",
     "first sample of every pixel"},
    {"s1", "path", ParameterKind::Integer, "samples", "", 1, kMaxSample, false, "",
     "one past the last sample"},
    {"format", "path", ParameterKind::Word, "", "", 0, 0, false, "f16|exr|png",
     "f16: 16-byte header (CT16; width, height, samples as u32) and RGBA16F, little-endian, linear; what is "
     "beyond +-65504 is stored as that and counted in X-Chamfer-Saturated; frames: "
     "exr, png"},
    {"camera", "query", ParameterKind::Numbers, "world units; degrees", "the scene's camera", -kMaxCoordinate,
     kMaxCoordinate, false, "ex,ey,ez,tx,ty,tz,ux,uy,uz,vfov[,aperture,focus]",
     "eye, target, up, vertical field of view; aperture diameter and focus distance (0: distance to the "
     "target)"},
    {"vfov", "camera", ParameterKind::Number, "degrees", "", 0.01, 170, false, "", "tenth number of camera"},
    {"rounding", "query, body", ParameterKind::Word, "", "analytic", 0, 0, false,
     "analytic|none|mesh:K|bevel:N",
     "the exact rounding, the sharp mesh, the explicit rounded mesh of K segments, or a shader of N probes"},
    {"K", "rounding", ParameterKind::Integer, "segments", "", 1, kMaxRoundingCount, false, "",
     "over a quarter turn of mesh:K"},
    {"N", "rounding", ParameterKind::Integer, "probes", "", 1, kMaxRoundingCount, false, "",
     "of bevel:N at every hit"},
    {"radius", "query, body", ParameterKind::Number, "mesh units", "the sidecar's", 0, kMaxCoordinate, true,
     "", "rounding radius; it must be below radius.max of the scene"},
    {"radius_clamp", "query, body", ParameterKind::Number, "share of a solid's inradius", "the sidecar's", 0,
     kMostClamp, false, "",
     "no solid is rounded by more than this share of its own inradius, so that no radius is too large; 0: "
     "none"},
    {"seed", "query", ParameterKind::Integer, "", "0", 0, 4294967295.0, false, "", "of the sampler"},
    {"bounces", "query", ParameterKind::Integer, "", "8", 0, 64, false, "",
     "longest path, in scattering events"},
    {"clamp", "query", ParameterKind::Number, "radiance", "0", 0, 1e9, false, "",
     "largest value of one contribution of indirect light, against fireflies; biased: it darkens. 0: none"},
    {"aov", "query", ParameterKind::Word, "", "beauty", 0, 0, false,
     "beauty|albedo|normal|geometric_normal|depth|feature|instance", "what the pixels hold"},
    {"rays", "body", ParameterKind::Numbers, "world units", "", -1e30, 1e30, false, "ox,oy,oz,dx,dy,dz",
     "one list of six numbers a ray: origin and direction; the direction must not be zero"},
    {"tnear", "body", ParameterKind::Number, "lengths of the ray's direction", "0", 0, 1e30, false, "",
     "hits must lie beyond it"},
};

std::string rangeText(const ParameterRow& row) {
  return std::string(row.aboveMinimum ? "above " : "") + exactNumberText(row.minimum) + " to " +
         exactNumberText(row.maximum);
}

} // namespace

std::span<const ParameterRow> parameterRows() { return kRows; }

const ParameterRow& parameterRow(std::string_view name) {
  for (const ParameterRow& row : kRows)
    if (row.name == name) return row;
  throw Error(ErrorKind::Internal, "no parameter row " + std::string(name));
}

const char* kindWord(ParameterKind kind) {
  switch (kind) {
  case ParameterKind::Integer:
    return "integer";
  case ParameterKind::Number:
    return "number";
  case ParameterKind::Numbers:
    return "numbers";
  case ParameterKind::Word:
    return "word";
  case ParameterKind::Text:
    return "text";
  }
  return "";
}

std::string limitsJson(const ParameterRow& row) {
  nlohmann::ordered_json limits = nlohmann::ordered_json::object();
  if (row.kind == ParameterKind::Word) {
    limits["one_of"] = row.words;
  } else if (row.kind != ParameterKind::Text) {
    if (row.kind == ParameterKind::Numbers) limits["numbers"] = row.words;
    // Whole limits are printed without a fraction.
    const auto put = [&](const char* key, double value) {
      if (std::abs(value) < 1e15 && value == std::floor(value))
        limits[key] = static_cast<std::int64_t>(value);
      else
        limits[key] = value;
    };
    put(row.aboveMinimum ? "above" : "minimum", row.minimum);
    put("maximum", row.maximum);
  }
  if (!row.unit.empty()) limits["unit"] = row.unit;
  return limits.dump();
}

void throwSyntax(const ParameterRow& row, std::string_view value, const std::string& detail) {
  throw ParameterError(ErrorKind::Usage, detail, std::string(row.name), std::string(value), limitsJson(row));
}

void throwRange(const ParameterRow& row, std::string_view value, const std::string& detail) {
  throw ParameterError(ErrorKind::OutOfRange, detail, std::string(row.name), std::string(value),
                       limitsJson(row));
}

std::uint32_t readInteger(const ParameterRow& row, std::string_view text) {
  const std::string name(row.name);
  std::uint64_t value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  // from_chars reads no sign into an unsigned number and skips no blanks; what is left to refuse is 007,
  // which would give one tile two URLs.
  if (status == std::errc::invalid_argument || end != text.data() + text.size() ||
      (text.size() > 1 && text[0] == '0'))
    throwSyntax(row, text, name + " must be a whole decimal number without sign or leading zeros");
  if (status == std::errc::result_out_of_range || static_cast<double>(value) < row.minimum ||
      static_cast<double>(value) > row.maximum)
    throwRange(row, text, name + " must be " + rangeText(row));
  return static_cast<std::uint32_t>(value);
}

double readNumber(const ParameterRow& row, std::string_view text) {
  double value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status == std::errc::invalid_argument || end != text.data() + text.size())
    throwSyntax(row, text, std::string(row.name) + " must be a decimal number such as 0.25 or 1e-3");
  if (status == std::errc::result_out_of_range || !std::isfinite(value))
    throwRange(row, text, std::string(row.name) + " must be a finite double");
  checkNumber(row, value);
  return value;
}

void checkNumber(const ParameterRow& row, double value) {
  const bool low = row.aboveMinimum ? !(value > row.minimum) : !(value >= row.minimum);
  if (low || !(value <= row.maximum))
    throwRange(row, exactNumberText(value), std::string(row.name) + " must be " + rangeText(row));
}

} // namespace chamfer
