#include "server/http/comparisons/job_lock.h"

#include "common/error.h"
#include "common/text.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>

namespace chamfer::http {
namespace {

/// Locks of the open file, not of the process: two threads exclude each other, too.
struct flock wholeFile() {
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  return lock;
}

} // namespace

std::optional<JobLock> JobLock::tryTake(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0 && errno == ENOENT) return {};
  if (descriptor >= 0) {
    struct flock lock = wholeFile();
    if (::fcntl(descriptor, F_OFD_SETLK, &lock) == 0) return JobLock(descriptor);
  }
  const int why = errno;
  if (descriptor >= 0) ::close(descriptor);
  if (descriptor >= 0 && (why == EAGAIN || why == EACCES)) return {};
  throw Error(ErrorKind::CannotWrite,
              "cannot lock " + fileInQuotes(file.string()) + ": " + std::strerror(why) +
                  "; the folder of jobs must be writable, on a file system with locks");
}

bool JobLock::held(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor < 0) return false;
  struct flock lock = wholeFile();
  const bool taken = ::fcntl(descriptor, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
  ::close(descriptor);
  return taken;
}

JobLock::~JobLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

} // namespace chamfer::http
