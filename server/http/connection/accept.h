// Taking connections from a listening socket, whatever accept(2) says.
#pragma once

#include <optional>

namespace chamfer::http {

struct Accepted {
  std::optional<int> socket; ///< non-blocking, closed on exec; nothing: nobody waits, or see `shortage`
  /// Descriptors or the kernel's memory do not suffice now: who waits goes on waiting, to be taken later.
  bool shortage = false;
};

/// The next connection of `listener` (non-blocking). Passes over those that failed before they were taken.
Accepted acceptNext(int listener);

} // namespace chamfer::http
