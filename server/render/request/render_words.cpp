#include "server/render/request/render_words.h"

#include "common/error.h"

#include <charconv>

namespace chamfer {
namespace {

struct AovRow {
  Aov aov;
  const char* word;
};
constexpr AovRow kAovs[] = {{Aov::Beauty, "beauty"},    {Aov::Albedo, "albedo"},
                            {Aov::Normal, "normal"},    {Aov::GeometricNormal, "geometric_normal"},
                            {Aov::Depth, "depth"},      {Aov::Feature, "feature"},
                            {Aov::Instance, "instance"}};

unsigned parseCount(std::string_view text, std::string_view digits) {
  unsigned value = 0;
  const char* end = digits.data() + digits.size();
  const auto [stop, status] = std::from_chars(digits.data(), end, value);
  if (status == std::errc::result_out_of_range ||
      (status == std::errc{} && stop == end && (value < 1 || value > kMaxRoundingCount)))
    throw Error(ErrorKind::OutOfRange, "rounding \"" + std::string(text) + "\": the number must be 1 to " +
                                           std::to_string(kMaxRoundingCount));
  if (status != std::errc{} || stop != end)
    throw Error(ErrorKind::Usage,
                "rounding \"" + std::string(text) + "\": a whole number must follow the colon, as in mesh:4");
  return value;
}

} // namespace

RoundingChoice parseRounding(std::string_view text) {
  if (text == "none") return {RoundingMode::None, 0, {}};
  if (text == "analytic") return {RoundingMode::Analytic, 0, {}};
  if (text.starts_with("mesh:")) return {RoundingMode::Mesh, parseCount(text, text.substr(5)), {}};
  if (text.starts_with("bevel:")) return {RoundingMode::Bevel, parseCount(text, text.substr(6)), {}};
  throw Error(ErrorKind::Usage,
              "rounding \"" + std::string(text) + "\" is not known; use analytic, none, mesh:K or bevel:N");
}

std::string roundingWord(const RoundingChoice& choice) {
  switch (choice.mode) {
  case RoundingMode::None:
    return "none";
  case RoundingMode::Analytic:
    return "analytic";
  case RoundingMode::Mesh:
    return "mesh:" + std::to_string(choice.count);
  case RoundingMode::Bevel:
    return "bevel:" + std::to_string(choice.count);
  }
  throw Error(ErrorKind::Internal, "unknown rounding mode");
}

double plainNumber(float value) {
  char text[32];
  double number = 0;
  std::from_chars(text, std::to_chars(text, text + sizeof text, value).ptr, number);
  return number;
}

Aov parseAov(std::string_view text) {
  for (const AovRow& row : kAovs)
    if (text == row.word) return row.aov;
  throw Error(
      ErrorKind::Usage,
      "aov \"" + std::string(text) +
          "\" is not known; use beauty, albedo, normal, geometric_normal, depth, feature or instance");
}

const char* aovWord(Aov aov) {
  for (const AovRow& row : kAovs)
    if (aov == row.aov) return row.word;
  throw Error(ErrorKind::Internal, "unknown aov");
}

} // namespace chamfer
