// A folder of its own for a test that reads and writes files, and what a call throws as one text.
#pragma once

#include "common/error.h"

#include <atomic>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

namespace chamfer::test {

/// Made empty, removed with everything in it at the end.
class TemporaryFolder {
public:
  TemporaryFolder() {
    static std::atomic<int> count{0};
    path_ = std::filesystem::temp_directory_path() /
            ("chamfer-test-" + std::to_string(::getpid()) + "-" + std::to_string(count++));
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Writes `content` to a file below, making folders on the way.
  std::filesystem::path write(const std::string& name, const std::string& content) const {
    const std::filesystem::path file = path_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream out(file, std::ios::binary | std::ios::trunc);
    out << content;
    return file;
  }

private:
  std::filesystem::path path_;
};

/// What a call throws, as "kind: message"; "nothing" when it does not.
template <class F>
std::string thrownBy(F&& f) {
  try {
    f();
  } catch (const Error& e) {
    return std::string(errorWord(e.kind())) + ": " + e.what();
  }
  return "nothing";
}

} // namespace chamfer::test
