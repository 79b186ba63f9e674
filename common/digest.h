// Content digests: XXH3, 128 bits. They name content (scene ids, stale sidecars, ETags) and find damage; they
// are not a defence against somebody who forges a collision.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace chamfer {

struct Digest {
  std::uint64_t high = 0, low = 0;
  bool operator==(const Digest&) const = default;
  std::string hex() const; ///< 32 lower-case hexadecimal digits
};

Digest digestOf(std::span<const std::byte> bytes);
inline Digest digestOf(std::string_view text) { return digestOf(std::as_bytes(std::span(text))); }
/// 64-bit XXH3, for checksums of sections.
std::uint64_t checksumOf(std::span<const std::byte> bytes);

} // namespace chamfer
