#include "server/render/scene/json_reader.h"

#include "common/error.h"
#include "common/text.h"

#include <algorithm>
#include <unordered_set>

namespace chamfer {
namespace {

using nlohmann::json;

std::string shorten(const std::string& text) { return printable(text, 60); }

std::string shown(const json& value) {
  return shorten(value.dump(-1, ' ', false, json::error_handler_t::replace));
}

std::size_t lineAt(const std::string& text, std::size_t byte) {
  return 1 + std::size_t(
                 std::count(text.begin(), text.begin() + std::ptrdiff_t(std::min(byte, text.size())), '\n'));
}

/// Walks the document only to refuse what the document model would hide.
class Check : public nlohmann::json_sax<json> {
public:
  Check(const std::string& text, const std::string& file) : text_(text), file_(file) {}

  bool null() override { return value(); }
  bool boolean(bool) override { return value(); }
  bool number_integer(number_integer_t) override { return value(); }
  bool number_unsigned(number_unsigned_t) override { return value(); }
  bool number_float(number_float_t, const string_t&) override { return value(); }
  bool string(string_t&) override { return value(); }
  bool binary(binary_t&) override { return value(); }
  bool start_object(std::size_t) override { return open(false); }
  bool end_object() override { return close(); }
  bool start_array(std::size_t) override { return open(true); }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    Level& level = levels_.back();
    level.key = name;
    if (!level.seen.insert(name).second)
      throw Error(ErrorKind::Malformed,
                  file_ + ": " + path() + ": the key is given twice; remove one of them");
    return true;
  }
  bool parse_error(std::size_t byte, const std::string&, const nlohmann::detail::exception& e) override {
    const std::string number = e.id == 406 ? "a number is too large" : "this is not JSON";
    throw Error(ErrorKind::Malformed, file_ + ":" + std::to_string(lineAt(text_, byte)) + ": " + number +
                                          " (byte " + std::to_string(byte) + ")");
  }

private:
  struct Level {
    bool array;
    std::size_t index = 0;
    std::string key;
    std::unordered_set<std::string> seen;
  };
  bool value() {
    if (!levels_.empty() && levels_.back().array) ++levels_.back().index;
    return true;
  }
  bool open(bool array) {
    if (levels_.size() >= kDeepest)
      throw Error(ErrorKind::Malformed,
                  file_ + ": " + path() + ": nested deeper than " + std::to_string(kDeepest) + " levels");
    levels_.push_back({array, 0, {}, {}});
    return true;
  }
  bool close() {
    levels_.pop_back();
    return value();
  }
  std::string path() const {
    std::string p;
    for (const Level& l : levels_) {
      if (l.array)
        p += "[" + std::to_string(l.index) + "]";
      else
        p += (p.empty() ? "" : ".") + shorten(l.key);
    }
    return p;
  }
  static constexpr std::size_t kDeepest = 32;
  const std::string& text_;
  const std::string& file_;
  std::vector<Level> levels_;
};

} // namespace

json parseJson(const std::string& text, const std::string& file) {
  Check check(text, file);
  json::sax_parse(text, &check);
  return json::parse(text);
}

std::string JsonReader::text() const { return shown(*value_); }

std::string JsonReader::path() const {
  if (!parent_) return "";
  const std::string above = parent_->path();
  if (!key_) return above + "[" + std::to_string(index_) + "]";
  return above.empty() ? key_ : above + "." + key_;
}

void JsonReader::fail(const std::string& what) const {
  const std::string p = path();
  throw Error(ErrorKind::Malformed, *file_ + ": " + (p.empty() ? "" : p + ": ") + what);
}

void JsonReader::requireObject(std::initializer_list<const char*> known) const {
  if (!value_->is_object()) fail("must be an object, is " + shown(*value_));
  for (const auto& [key, unused] : value_->items()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    std::string list;
    for (const char* k : known)
      list += (list.empty() ? "" : ", ") + std::string(k);
    const std::string p = path();
    throw Error(ErrorKind::Malformed, *file_ + ": " + (p.empty() ? "" : p + ".") + shorten(key) +
                                          ": unknown key; known here: " + list);
  }
}

JsonReader JsonReader::at(const char* key) const {
  const auto found = value_->find(key);
  if (found == value_->end()) fail("the key \"" + std::string(key) + "\" is missing");
  return {*found, this, key, 0};
}

JsonReader JsonReader::at(std::size_t index) const { return {(*value_)[index], this, nullptr, index}; }

void JsonReader::requireArray() const {
  if (!value_->is_array()) fail("must be an array, is " + shown(*value_));
}

double JsonReader::number(const NumberRange& range) const {
  if (!value_->is_number()) fail("must be a number, is " + shown(*value_));
  const double v = value_->get<double>();
  if (!std::isfinite(v)) fail("must be finite, is " + shown(*value_));
  if (v < range.low || v > range.high) {
    const auto shownLimit = [](double limit) {
      return limit == kPositive.low ? std::string("above 0") : "at least " + shown(json(limit));
    };
    std::string limits;
    if (range.low > std::numeric_limits<double>::lowest()) limits = shownLimit(range.low);
    if (range.high < std::numeric_limits<double>::max())
      limits += (limits.empty() ? "" : " and ") + ("at most " + shown(json(range.high)));
    fail("must be " + limits + ", is " + shown(*value_));
  }
  return v;
}

std::uint64_t JsonReader::wholeNumber(std::uint64_t low, std::uint64_t high) const {
  const std::uint64_t v = value_->is_number_unsigned() ? value_->get<std::uint64_t>() : 0;
  if (!value_->is_number_unsigned() || v < low || v > high)
    fail("must be a whole number from " + std::to_string(low) + " to " + std::to_string(high) + ", is " +
         shown(*value_));
  return v;
}

bool JsonReader::boolean() const {
  if (!value_->is_boolean()) fail("must be true or false, is " + shown(*value_));
  return value_->get<bool>();
}

std::string JsonReader::string() const {
  if (!value_->is_string() || value_->get_ref<const std::string&>().empty())
    fail("must be a string that is not empty, is " + shown(*value_));
  return value_->get<std::string>();
}

Vector3 JsonReader::vector() const {
  if (!value_->is_array() || size() != 3) fail("must be an array of 3 numbers, is " + shown(*value_));
  return {at(std::size_t(0)).number(), at(1).number(), at(2).number()};
}

Vector3 JsonReader::direction() const {
  const Vector3 v = vector();
  // The squared length must neither vanish nor overflow: directions get normalised.
  const double square = lengthSquared(v);
  if (!(square >= std::numeric_limits<double>::min()) || !std::isfinite(square))
    fail("must be a direction, is " + shown(*value_));
  return v;
}

Color JsonReader::color(const NumberRange& range) const {
  if (isNumber()) return grey(float(number(range)));
  if (!value_->is_array() || size() != 3)
    fail("must be an array of 3 numbers or one number, is " + shown(*value_));
  return {float(at(std::size_t(0)).number(range)), float(at(1).number(range)), float(at(2).number(range))};
}

} // namespace chamfer
