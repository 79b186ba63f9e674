#include "tests/http/failing_calls.h"

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdint>
#include <cstdlib>
#include <fcntl.h>
#include <mutex>
#include <new>
#include <string_view>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace chamfer::test {
namespace {

std::atomic<int> acceptError{0}, acceptsToFail{0};
std::atomic<bool> folderFails{false};
std::mutex folderMutex;
std::string folderSuffix;
int folderError = 0;
std::atomic<std::size_t> allocationToFail{SIZE_MAX};

} // namespace

FailingAccept::FailingAccept(int error, int times) {
  acceptError = error;
  acceptsToFail = times;
}
FailingAccept::~FailingAccept() { acceptsToFail = 0; }
int FailingAccept::pending() { return acceptsToFail; }

FailingFolder::FailingFolder(std::string suffix, int error) {
  const std::lock_guard lock(folderMutex);
  folderSuffix = std::move(suffix);
  folderError = error;
  folderFails = true;
}
FailingFolder::~FailingFolder() { folderFails = false; }

void failNextAllocationOf(std::size_t bytes) { allocationToFail = bytes; }
bool allocationFailed() { return allocationToFail == SIZE_MAX; }

namespace {

/// The error with which this folder cannot be opened, or 0.
int faultOf(const char* path) {
  if (!folderFails) return 0;
  const std::lock_guard lock(folderMutex);
  return std::string_view(path).ends_with(folderSuffix) ? folderError : 0;
}

bool failsNow(std::size_t bytes) {
  std::size_t least = allocationToFail;
  return bytes >= least && least != SIZE_MAX && allocationToFail.compare_exchange_strong(least, SIZE_MAX);
}

} // namespace
} // namespace chamfer::test

extern "C" int accept4(int socket, sockaddr* address, socklen_t* length, int flags) {
  using namespace chamfer::test;
  for (int left = acceptsToFail; left > 0;)
    if (acceptsToFail.compare_exchange_weak(left, left - 1)) {
      errno = acceptError;
      return -1;
    }
  return static_cast<int>(::syscall(SYS_accept4, socket, address, length, flags));
}

extern "C" int openat(int folder, const char* path, int flags, ...) {
  if (flags & O_DIRECTORY)
    if (const int error = chamfer::test::faultOf(path)) {
      errno = error;
      return -1;
    }
  std::va_list more;
  va_start(more, flags);
  const mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(more, mode_t) : 0;
  va_end(more);
  return static_cast<int>(::syscall(SYS_openat, folder, path, flags, mode));
}

// All forms but the aligned ones: sanitizers have each of their own, and would not take what another gave.
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  return chamfer::test::failsNow(bytes) ? nullptr : std::malloc(bytes > 0 ? bytes : 1);
}
void* operator new(std::size_t bytes) {
  if (void* memory = operator new(bytes, std::nothrow)) return memory;
  throw std::bad_alloc();
}
void* operator new[](std::size_t bytes, const std::nothrow_t& n) noexcept { return operator new(bytes, n); }
void* operator new[](std::size_t bytes) { return operator new(bytes); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
