#include "server/http/catalogue/file_stamp.h"

#include <algorithm>
#include <sys/stat.h>

namespace chamfer::http {
namespace {

bool before(const timespec& a, const timespec& b) {
  return a.tv_sec != b.tv_sec ? a.tv_sec < b.tv_sec : a.tv_nsec < b.tv_nsec;
}
bool same(const timespec& a, const timespec& b) { return a.tv_sec == b.tv_sec && a.tv_nsec == b.tv_nsec; }

FileStamp stampOf(const std::filesystem::path& file) {
  FileStamp stamp;
  stamp.file = file;
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) return stamp;
  stamp.exists = true;
  stamp.device = status.st_dev;
  stamp.inode = status.st_ino;
  stamp.size = static_cast<std::uintmax_t>(status.st_size);
  stamp.modified = status.st_mtim;
  stamp.changed = status.st_ctim;
  return stamp;
}

} // namespace

timespec fileClock() {
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME_COARSE, &now); // Linux stamps files by this clock
  return now;
}

std::vector<FileStamp> stampsOf(std::span<const std::filesystem::path> files, const timespec& begin) {
  std::vector<FileStamp> stamps;
  for (const std::filesystem::path& file : files) {
    FileStamp stamp = stampOf(file);
    // Of one tick of that clock it is not known whether the change or the reading was first.
    stamp.unsettled = stamp.exists && !before(stamp.changed, begin);
    stamps.push_back(std::move(stamp));
  }
  return stamps;
}

bool unchanged(std::span<const FileStamp> stamps) {
  return std::all_of(stamps.begin(), stamps.end(), [](const FileStamp& then) {
    const FileStamp now = stampOf(then.file);
    return !then.unsettled && now.exists == then.exists && now.device == then.device &&
           now.inode == then.inode && now.size == then.size && same(now.modified, then.modified) &&
           same(now.changed, then.changed);
  });
}

} // namespace chamfer::http
