// URLs' paths and queries taken apart strictly: nothing is repaired, every byte is accounted for.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace chamfer {

/// Decodes %XX; '+' stays a plus. Nothing for a broken escape or one that yields a control character (0-31,
/// 127).
std::optional<std::string> percentDecode(std::string_view text);
/// Encodes everything but unreserved characters (RFC 3986) and, with `keepSlashes`, '/'.
std::string percentEncode(std::string_view text, bool keepSlashes = true);

/// The path's segments as sent (still encoded): "/v1/scenes/a%2Fb" -> "v1", "scenes", "a%2Fb". A final '/'
/// gives a last empty segment; "/" gives one empty segment.
std::vector<std::string_view> splitPath(std::string_view path);

/// The segments decoded, '/' between them. Throws Error(Usage) for a broken escape.
std::string decodePath(std::span<const std::string_view> segments);

/// Decoded name=value pairs in the order sent.
using Query = std::vector<std::pair<std::string, std::string>>;
/// Throws ParameterError(Usage): a part without '=', an empty name, a broken escape, or a name given twice.
Query parseQuery(std::string_view text);

} // namespace chamfer
