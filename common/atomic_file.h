// Files that take their names only when they are whole: no reader sees half of one, and what stood under the
// name stays if writing fails.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

namespace chamfer {

/// A file under a temporary name beside its target, gone unless it is committed.
class AtomicFile {
public:
  /// Creates it, empty, with the permissions of new files. Throws Error(CannotWrite) naming the target.
  explicit AtomicFile(std::filesystem::path target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  const std::filesystem::path& target() const { return target_; }
  /// In the target's folder, with its extension. For what writes files by name; it must not replace the file.
  const std::filesystem::path& temporary() const { return temporary_; }
  /// Appends. Throws Error(CannotWrite).
  void write(std::span<const std::byte> bytes);
  /// Syncs the content to the disk and renames the file to its target. Throws Error(CannotWrite).
  void commit();

private:
  [[noreturn]] void fail() const;

  std::filesystem::path target_, temporary_;
  int file_ = -1;
};

/// The whole file at once. Throws Error(CannotWrite).
void writeAtomically(const std::filesystem::path& target, std::span<const std::byte> bytes);

} // namespace chamfer
