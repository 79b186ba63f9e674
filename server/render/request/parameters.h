// Every parameter of the interface, one row each: where it stands, kind, unit, default, limits. The parsers
// check against these rows, errors quote them, the server's descriptions of itself print them.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace chamfer {

enum class ParameterKind : std::uint8_t { Integer, Number, Numbers, Word, Text };

struct ParameterRow {
  std::string_view name;
  std::string_view where; ///< "path", "query" or "body"; "query, body" when both; a part's: the whole's name
  ParameterKind kind;
  std::string_view unit;     ///< empty: none
  std::string_view fallback; ///< what holds when it is absent; empty: it must be given
  double minimum = 0;        ///< Integer and Number
  double maximum = 0;
  bool aboveMinimum = false; ///< the minimum itself is outside
  std::string_view words;    ///< Word: the words, '|' between them, a capital for a number of its own row.
                             ///< Numbers: the names of the numbers, in brackets those that may be left out
  std::string_view about;

  /// Does it stand in a request's "path", "query" or "body"?
  bool standsIn(std::string_view place) const { return where.find(place) != std::string_view::npos; }
};

/// Work that one request may ask for.
inline constexpr std::uint64_t kMaxTilePixels = 1u << 20;
inline constexpr std::uint64_t kMaxFramePixels = 1u << 24;
/// Pixels times samples of one request.
inline constexpr std::uint64_t kMaxRequestSamples = std::uint64_t{1} << 31;

std::span<const ParameterRow> parameterRows();
/// The row of that name; it must exist.
const ParameterRow& parameterRow(std::string_view name);
/// JSON text of the row's limits.
std::string limitsJson(const ParameterRow& row);
const char* kindWord(ParameterKind kind);

/// Whole decimal number: digits only, no sign, blank or leading zero. Throws ParameterError: Usage when it
/// is no such number, OutOfRange when it is outside the row's limits.
std::uint32_t readInteger(const ParameterRow& row, std::string_view text);
/// Decimal number, "1e-3" included; finite. Throws as readInteger().
double readNumber(const ParameterRow& row, std::string_view text);
/// Checks a number from elsewhere (JSON) against the row. Throws ParameterError(OutOfRange).
void checkNumber(const ParameterRow& row, double value);

/// Throw ParameterErrors that name the row, the value and the limits: Usage, OutOfRange.
[[noreturn]] void throwSyntax(const ParameterRow& row, std::string_view value, const std::string& detail);
[[noreturn]] void throwRange(const ParameterRow& row, std::string_view value, const std::string& detail);

} // namespace chamfer
