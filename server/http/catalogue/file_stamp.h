// Has a file changed since it was read? Told by what the file system says of it, not by its content.
#pragma once

#include <ctime>
#include <filesystem>
#include <span>
#include <vector>

namespace chamfer::http {

/// Identity, size and times of a file. The time of its last status change cannot be set by programs, so that
/// a file replaced by one of equal size and date is noticed.
struct FileStamp {
  std::filesystem::path file;
  bool exists = false;
  bool unsettled = false; ///< it was changed about when it was read: what was read may be of before
  std::uintmax_t device = 0, inode = 0, size = 0;
  timespec modified{}, changed{};
};

/// The time by which the file system stamps, read before files are read.
timespec fileClock();
/// Stamps of files that were read since `begin`.
std::vector<FileStamp> stampsOf(std::span<const std::filesystem::path> files, const timespec& begin);
/// Are all files as they were then? False, too, for one that is unsettled.
bool unchanged(std::span<const FileStamp> stamps);

} // namespace chamfer::http
