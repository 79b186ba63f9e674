// This process as the kernel sees it, for the metrics.
#pragma once

#include <cstddef>

namespace chamfer::http {

struct ProcessFigures {
  std::size_t residentBytes = 0, virtualBytes = 0;
  std::size_t openDescriptors = 0, maxDescriptors = 0;
  double cpuSeconds = 0;       ///< user and system, of all threads
  double startTimeSeconds = 0; ///< since the Unix epoch; 0: unknown
};

/// From /proc; what cannot be read is 0.
ProcessFigures processFigures();

} // namespace chamfer::http
