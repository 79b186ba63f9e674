// A folder for what is of no use after the program's end.
#pragma once

#include <filesystem>

namespace chamfer {

/// Below the system's temporary folder; removed at the end, with all that is in it.
class ScratchFolder {
public:
  ScratchFolder(); ///< Error(CannotWrite)
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

private:
  std::filesystem::path path_;
};

} // namespace chamfer
