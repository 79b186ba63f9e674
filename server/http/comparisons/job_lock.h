// Which process works on a job: a lock on a file in the job's folder. The kernel lets go of it when the
// process ends, however it ends, so that a job whose server was killed is free at once; over NFS, when the
// lease of a dead machine is over. No clock is compared with another.
#pragma once

#include <filesystem>
#include <optional>
#include <utility>

namespace chamfer::http {

class JobLock {
public:
  /// Nothing where somebody has it, this process included, or where the file's folder is gone.
  /// Error(CannotWrite) where the file system has no locks.
  static std::optional<JobLock> tryTake(const std::filesystem::path& file);
  /// Has somebody taken it?
  static bool held(const std::filesystem::path& file);

  JobLock(JobLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  JobLock(const JobLock&) = delete;
  JobLock& operator=(const JobLock&) = delete;
  ~JobLock();

private:
  explicit JobLock(int descriptor) : descriptor_(descriptor) {}
  int descriptor_;
};

} // namespace chamfer::http
