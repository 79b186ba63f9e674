#include "server/http/routes/ray_list.h"

#include "common/text.h"
#include "server/http/schema/limits.h"
#include "server/render/request/parameter_error.h"
#include "server/render/request/parameters.h"
#include "server/render/request/tile_request.h"

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

namespace chamfer::http {
namespace {

constexpr const char* kComponents[] = {"ox", "oy", "oz", "dx", "dy", "dz"};

/// Receives the parser's events. The only nesting that is allowed is object > list > list of six numbers, so
/// that a depth and a key are all the state there is.
class Reader : public nlohmann::json_sax<nlohmann::json> {
public:
  RayList list;
  bool seenRays = false;

  bool null() override { return scalar("null"); }
  bool boolean(bool value) override { return scalar(value ? "true" : "false"); }
  bool number_integer(number_integer_t value) override {
    return number(static_cast<double>(value), std::to_string(value));
  }
  bool number_unsigned(number_unsigned_t value) override {
    return number(static_cast<double>(value), std::to_string(value));
  }
  bool number_float(number_float_t value, const string_t& text) override { return number(value, text); }
  bool string(string_t& value) override {
    if (depth_ == 1 && key_ == "rounding") {
      const RoundingChoice before = list.rounding;
      list.rounding = parseRoundingWord(value);
      list.rounding.radius = before.radius;
      list.rounding.radiusClamp = before.radiusClamp;
      return true;
    }
    return scalar("\"" + value + "\"");
  }
  bool binary(binary_t&) override { return scalar("binary"); }

  bool start_object(std::size_t) override {
    if (depth_ != 0) return scalar("{...}");
    depth_ = 1;
    return true;
  }
  bool end_object() override {
    depth_ = 0;
    return true;
  }
  bool key(string_t& name) override {
    if (!keys_.insert(name).second)
      refuse(ErrorKind::Usage, name, name, "the key \"" + name + "\" is given more than once");
    if (name != "rays" && name != "rounding" && name != "radius" && name != "radius_clamp" && name != "tnear")
      refuse(ErrorKind::Usage, name, name,
             "there is no key \"" + name + "\"; known: rays, rounding, radius, radius_clamp, tnear");
    key_ = name;
    return true;
  }
  bool start_array(std::size_t) override {
    if (depth_ == 1 && key_ == "rays") {
      depth_ = 2;
      seenRays = true;
      return true;
    }
    if (depth_ == 2) {
      if (list.rays.size() == kMaxRays)
        refuse(ErrorKind::OutOfRange, "rays", std::to_string(kMaxRays + 1) + " or more",
               "one call takes at most " + std::to_string(kMaxRays) + " rays; send the rest in another");
      depth_ = 3;
      component_ = 0;
      return true;
    }
    return scalar("[...]");
  }
  bool end_array() override {
    if (depth_ == 3) finishRay();
    --depth_;
    return true;
  }
  bool parse_error(std::size_t position, const std::string& token,
                   const nlohmann::detail::exception& error) override {
    // The library's text stays here: 406 is its number for a numeral beyond double, everything else is
    // syntax.
    if (error.id == 406)
      refuse(ErrorKind::OutOfRange, place(), token,
             "the number at byte " + std::to_string(position) + where() + " is beyond double");
    refuse(ErrorKind::Usage, "body", token,
           "the body is not JSON: it goes wrong at byte " + std::to_string(position) + where());
  }

private:
  [[noreturn]] void refuse(ErrorKind kind, const std::string& parameter, const std::string& value,
                           const std::string& detail) const {
    std::string limits;
    for (const ParameterRow& row : parameterRows())
      if (row.name == key_) limits = limitsJson(row);
    if (parameter == "rays") limits = "{\"maximum\":" + std::to_string(kMaxRays) + "}";
    throw ParameterError(kind, detail, parameter, value, limits);
  }

  /// The place that a value stands at, as a JSON path.
  std::string place() const {
    if (depth_ == 0) return "body";
    if (depth_ == 1) return key_;
    std::string path = "rays[" + std::to_string(list.rays.size()) + "]";
    if (depth_ == 3) path += "[" + std::to_string(component_) + "]";
    return path;
  }
  std::string where() const { return depth_ > 1 ? ", in " + place() : std::string(); }

  /// A value of a kind that has no business where it stands.
  [[noreturn]] bool scalar(const std::string& value) const {
    const std::string at = place();
    if (depth_ == 0) refuse(ErrorKind::Usage, at, value, "the body must be an object with the key \"rays\"");
    if (depth_ == 1 && key_ == "rays") refuse(ErrorKind::Usage, at, value, "rays must be a list of rays");
    if (depth_ == 1 && key_ == "rounding")
      refuse(ErrorKind::Usage, at, value, "rounding must be a word in quotes");
    if (depth_ == 1) refuse(ErrorKind::Usage, at, value, key_ + " must be a number");
    if (depth_ == 2)
      refuse(ErrorKind::Usage, at, value, at + " must be a list of six numbers: ox,oy,oz,dx,dy,dz");
    refuse(ErrorKind::Usage, at, value,
           at + (component_ < 6 ? std::string(" (") + kComponents[component_] + ")" : std::string()) +
               " must be a number");
  }

  bool number(double value, const std::string& text) {
    if (depth_ == 3) {
      if (component_ == 6)
        refuse(ErrorKind::Usage, place(), text, place() + ": a ray has six numbers, this one has more");
      if (!std::isfinite(value) || std::abs(value) > parameterRow("rays").maximum)
        refuse(ErrorKind::OutOfRange, place(), text,
               place() + " (" + kComponents[component_] + ") must be a finite number within +-1e30");
      numbers_[component_++] = value;
      return true;
    }
    if (depth_ == 1 && key_ == "radius") {
      checkNumber(parameterRow("radius"), value);
      list.rounding.radius = value;
      return true;
    }
    if (depth_ == 1 && key_ == "radius_clamp") {
      checkNumber(parameterRow("radius_clamp"), value);
      list.rounding.radiusClamp = value;
      return true;
    }
    if (depth_ == 1 && key_ == "tnear") {
      checkNumber(parameterRow("tnear"), value);
      list.tnear = value;
      return true;
    }
    scalar(text);
  }

  void finishRay() {
    depth_ = 2; // the message's place is the ray, not a component
    if (component_ != 6)
      refuse(ErrorKind::Usage, place(), "a list of " + std::to_string(component_),
             place() + " must have six numbers, it has " + std::to_string(component_));
    const Ray ray{{numbers_[0], numbers_[1], numbers_[2]}, {numbers_[3], numbers_[4], numbers_[5]}};
    if (ray.direction == Vector3{})
      refuse(ErrorKind::OutOfRange, place(), "0,0,0", place() + ": the direction is zero");
    // The tracer works with the square of a direction's length.
    const double squared = lengthSquared(ray.direction);
    if (!std::isnormal(squared))
      refuse(ErrorKind::OutOfRange, place(), exactNumberText(length(ray.direction)),
             place() + ": the square of the direction's length is beyond double");
    list.rays.push_back(ray);
    depth_ = 3;
  }

  int depth_ = 0; ///< 0 outside, 1 in the object, 2 in the list of rays, 3 in a ray
  std::string key_;
  std::set<std::string> keys_;
  std::size_t component_ = 0;
  double numbers_[6] = {};
};

void put(std::string& out, double value) {
  if (!std::isfinite(value)) {
    out += "null";
    return;
  }
  char text[32];
  out.append(text, std::to_chars(text, text + sizeof text, value).ptr);
}

void put(std::string& out, std::uint32_t value) {
  if (value == kNone)
    out += "null";
  else
    out += std::to_string(value);
}

void put(std::string& out, double x, double y, double z) {
  out += '[';
  put(out, x);
  out += ',';
  put(out, y);
  out += ',';
  put(out, z);
  out += ']';
}

const char* featureWord(Feature feature) {
  switch (feature) {
  case Feature::Flat:
    return "flat";
  case Feature::Cylinder:
    return "cylinder";
  case Feature::Sphere:
    return "sphere";
  }
  return "";
}

} // namespace

RayList parseRayList(std::string_view body) {
  Reader reader;
  nlohmann::json::sax_parse(body.begin(), body.end(), &reader);
  if (!reader.seenRays) throw ParameterError(ErrorKind::Usage, "the key \"rays\" is missing", "rays");
  if (reader.list.rounding.mode == RoundingMode::None) {
    reader.list.rounding.radius.reset();
    reader.list.rounding.radiusClamp.reset();
  }
  return std::move(reader.list);
}

std::string printHits(std::span<const std::optional<TraceHit>> hits) {
  std::string out = "{\"hits\":[";
  out.reserve(16 + hits.size() * 240);
  bool first = true;
  for (const std::optional<TraceHit>& hit : hits) {
    if (!first) out += ',';
    first = false;
    if (!hit) {
      out += "null";
      continue;
    }
    out += "{\"t\":";
    put(out, hit->t);
    out += ",\"position\":";
    put(out, hit->position.x, hit->position.y, hit->position.z);
    out += ",\"normal\":";
    put(out, hit->normal.x, hit->normal.y, hit->normal.z);
    out += ",\"feature\":\"";
    out += featureWord(hit->feature);
    out += "\",\"instance\":";
    put(out, hit->instance);
    out += ",\"solid\":";
    put(out, hit->solid);
    out += ",\"triangle\":";
    put(out, hit->triangle);
    out += '}';
  }
  out += "]}\n";
  return out;
}

} // namespace chamfer::http
