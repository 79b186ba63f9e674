#include "common/atomic_file.h"

#include "common/error.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <string>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace chamfer {

AtomicFile::AtomicFile(std::filesystem::path target) : target_(std::move(target)) {
  const std::string extension = target_.extension().string();
  std::string name = target_.string() + ".XXXXXX" + extension;
  file_ = ::mkostemps(name.data(), int(extension.size()), O_CLOEXEC);
  if (file_ < 0) fail();
  temporary_ = name;
  const mode_t mask = ::umask(0); // there is no other way to read it
  ::umask(mask);
  if (::fchmod(file_, 0666 & ~mask) == 0) return;
  const int why = errno;
  ::close(file_);
  ::unlink(name.c_str());
  errno = why;
  fail();
}

AtomicFile::~AtomicFile() {
  if (file_ < 0) return;
  ::close(file_);
  ::unlink(temporary_.c_str());
}

void AtomicFile::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(file_, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) fail();
    bytes = bytes.subspan(std::size_t(n));
  }
}

void AtomicFile::commit() {
  if (::fsync(file_) != 0 || ::rename(temporary_.c_str(), target_.c_str()) != 0) fail();
  ::close(std::exchange(file_, -1));
}

void AtomicFile::fail() const {
  throw Error(ErrorKind::CannotWrite, "cannot write " + target_.string() + ": " + std::strerror(errno));
}

void writeAtomically(const std::filesystem::path& target, std::span<const std::byte> bytes) {
  AtomicFile file(target);
  file.write(bytes);
  file.commit();
}

} // namespace chamfer
