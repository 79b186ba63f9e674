// The page: a fixed list of files, from the program itself or from a folder named at start. A request's path
// is only ever compared with the list; it never becomes a file name.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace chamfer::http {

struct StaticFile {
  std::string contentType;
  std::string bytes;
};

class StaticFiles {
public:
  /// The files in the program.
  StaticFiles();
  /// Those below `folder` (.html .js .css .svg .png .ico), listed now, read at each request, for work on the
  /// page. Throws Error(NotFound) unless it is a folder with an index.html.
  explicit StaticFiles(const std::filesystem::path& folder);

  /// `path` as "index.html"; the empty path is index.html.
  std::optional<StaticFile> find(const std::string& path) const;

private:
  struct Source {
    std::string bytes;
    std::filesystem::path file; ///< empty: bytes
  };
  std::map<std::string, Source> sources_;
};

} // namespace chamfer::http
