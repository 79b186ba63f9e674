// Where comparisons that are asked for over HTTP are kept, and how much of them.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>

namespace chamfer::http {

struct JobOptions {
  std::filesystem::path folder{};               ///< empty: no comparisons are taken
  std::uint64_t bytes = std::uint64_t{4} << 30; ///< of the folder; beyond, the oldest finished jobs go
  std::chrono::seconds age{30 * 24 * 3600};     ///< of finished jobs; then they go
  unsigned waiting = 128;                       ///< jobs that may wait or run; beyond, 503
};

} // namespace chamfer::http
