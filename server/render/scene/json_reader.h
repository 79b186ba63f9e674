// Strict reading of JSON: every fault is an Error(Malformed) that names the file and the key's path, such as
// `instances[2].scale[0]`. nlohmann-json alone keeps the last of duplicate keys, truncates 64.9 to 64 and
// wraps -1.
#pragma once

#include "common/vec.h"
#include "server/render/image/color.h"

#include <functional>
#include <initializer_list>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace chamfer {

/// Limits of a number, both included.
struct NumberRange {
  double low = std::numeric_limits<double>::lowest();
  double high = std::numeric_limits<double>::max();
};
inline constexpr NumberRange kAnyNumber{};
inline constexpr NumberRange kUnitRange{0, 1};
inline constexpr NumberRange kNotNegative{0, std::numeric_limits<double>::max()};
/// Above zero: from the smallest normal number.
inline constexpr NumberRange kPositive{std::numeric_limits<double>::min(),
                                       std::numeric_limits<double>::max()};

/// One value of a JSON document and where it stands. Refers to the document: keep that alive.
class JsonReader {
public:
  /// `file` is the name used in messages.
  JsonReader(const nlohmann::json& document, const std::string& file) : value_(&document), file_(&file) {}

  [[noreturn]] void fail(const std::string& what) const;
  bool isString() const { return value_->is_string(); }
  bool isNumber() const { return value_->is_number(); }
  bool isArray() const { return value_->is_array(); }
  bool isObject() const { return value_->is_object(); }
  bool isBool() const { return value_->is_boolean(); }

  /// Fails unless this is an object whose keys are all among `known`.
  void requireObject(std::initializer_list<const char*> known) const;
  bool has(const char* key) const { return value_->contains(key); }
  JsonReader at(const char* key) const; ///< fails when it is missing
  /// Calls `f` with the member's reader if there is one.
  template <class F>
  void with(const char* key, F&& f) const {
    if (has(key)) f(at(key));
  }

  /// Fails unless this is an object; calls `f` with each member's key and reader.
  template <class F>
  void forEachMember(F&& f) const {
    if (!isObject()) fail("must be an object, is " + text());
    for (const auto& member : value_->items())
      f(member.key(), at(member.key().c_str()));
  }

  std::size_t size() const { return value_->size(); } ///< of an array
  JsonReader at(std::size_t index) const;
  /// Fails unless this is an array; calls `f` for each element in order.
  template <class F>
  void forEach(F&& f) const {
    requireArray();
    for (std::size_t i = 0; i < size(); ++i)
      f(at(i));
  }
  void requireArray() const;

  double number(const NumberRange& range = kAnyNumber) const;
  std::uint64_t wholeNumber(std::uint64_t low, std::uint64_t high) const;
  bool boolean() const;
  std::string string() const; ///< not empty
  Vector3 vector() const;     ///< three finite numbers
  Vector3 direction() const;  ///< the same, not all zero; not normalised
  Point3 point() const { return Point3(vector()); }
  Color color(const NumberRange& range) const; ///< three numbers, or one for a grey
  std::string path() const;
  std::string text() const; ///< the value as JSON, for messages; long ones are cut

private:
  JsonReader(const nlohmann::json& value, const JsonReader* parent, const char* key, std::size_t index)
      : value_(&value), file_(parent->file_), parent_(parent), key_(key), index_(index) {}

  const nlohmann::json* value_;
  const std::string* file_;
  const JsonReader* parent_ = nullptr; // readers live on the stack below their parents'
  const char* key_ = nullptr;
  std::size_t index_ = 0;
};

/// Parses strictly: one value, no duplicate keys, no number beyond double's range. Messages name the line.
nlohmann::json parseJson(const std::string& text, const std::string& file);

} // namespace chamfer
