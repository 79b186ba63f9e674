// Faults of the system that cannot be had on demand: calls of the C library that fail as a test asks. Defined
// in the test program, they take the place of the library's own.
#pragma once

#include <cstddef>
#include <string>

namespace chamfer::test {

/// The next `times` calls of accept4() end with `error`; `pending()` is how many are still to come.
class FailingAccept {
public:
  FailingAccept(int error, int times);
  ~FailingAccept();
  FailingAccept(const FailingAccept&) = delete;
  FailingAccept& operator=(const FailingAccept&) = delete;
  static int pending();
};

/// Folders whose path ends with `suffix` cannot be opened, for the reason `error`.
class FailingFolder {
public:
  FailingFolder(std::string suffix, int error);
  ~FailingFolder();
  FailingFolder(const FailingFolder&) = delete;
  FailingFolder& operator=(const FailingFolder&) = delete;
};

/// The next allocation of at least `bytes` fails, on whatever thread; once.
void failNextAllocationOf(std::size_t bytes);
/// Has it failed?
bool allocationFailed();

} // namespace chamfer::test
