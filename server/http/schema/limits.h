// Limits of requests as a whole; those of their parameters are in server/render/request/parameters.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace chamfer::http {

inline constexpr std::size_t kMaxRays = 100'000;
/// Body of one request: kMaxRays rays at full precision fit twice.
inline constexpr std::size_t kMaxBodyBytes = 32u << 20;
inline constexpr std::size_t kMaxHeadBytes = 16u << 10;
inline constexpr std::size_t kMaxTargetBytes = 4096;
inline constexpr std::size_t kMaxHeaderFields = 100;
/// Of preview.glb.
inline constexpr std::size_t kMaxPreviewBytes = 32u << 20;

/// Of one job of comparisons: its suite, its cases and what they ask for together.
inline constexpr std::size_t kMaxSuiteBytes = 1u << 20;
inline constexpr std::size_t kMaxCases = 64;
inline constexpr std::uint64_t kMaxComparisonPixels = std::uint64_t{1} << 22;
inline constexpr std::uint64_t kMaxComparisonSamples = std::uint64_t{1} << 34;
inline constexpr std::size_t kMaxComparisonFileBytes = 64u << 20;

struct LimitRow {
  std::string_view name; ///< its unit is the last word
  std::uint64_t value;
  std::string_view about;
};
/// All of the above, and the work that one picture may ask for, under the names by which /v1/info prints
/// them.
std::span<const LimitRow> limitRows();

} // namespace chamfer::http
