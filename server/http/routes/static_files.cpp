#include "server/http/routes/static_files.h"

#include "common/error.h"
#include "server/http/routes/embedded_files.h"

#include <fstream>
#include <iterator>

namespace chamfer::http {
namespace {

namespace fs = std::filesystem;

constexpr std::pair<std::string_view, const char*> kTypes[] = {{".html", "text/html; charset=utf-8"},
                                                               {".js", "text/javascript; charset=utf-8"},
                                                               {".css", "text/css; charset=utf-8"},
                                                               {".svg", "image/svg+xml"},
                                                               {".png", "image/png"},
                                                               {".ico", "image/x-icon"}};

const char* typeOf(std::string_view path) {
  for (const auto& [extension, type] : kTypes)
    if (path.ends_with(extension)) return type;
  return nullptr;
}

} // namespace

StaticFiles::StaticFiles() {
  for (const EmbeddedFile& file : embeddedFiles())
    sources_[std::string(file.path)] = {std::string(file.bytes), {}};
}

StaticFiles::StaticFiles(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_regular_file(folder / "index.html", error))
    throw Error(ErrorKind::NotFound, folder.string() + " holds no index.html; name the folder of the page");
  auto entry = fs::recursive_directory_iterator(folder, error);
  for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
    const std::string path = entry->path().lexically_relative(folder).generic_string();
    std::error_code gone;
    if (fs::is_regular_file(entry->symlink_status(gone)) && typeOf(path))
      sources_[path] = {{}, entry->path()};
  }
  if (error)
    throw Error(ErrorKind::NotFound,
                "the page's folder " + folder.string() + " cannot be read as a whole: " + error.message());
}

std::optional<StaticFile> StaticFiles::find(const std::string& path) const {
  const auto found = sources_.find(path.empty() ? "index.html" : path);
  if (found == sources_.end()) return std::nullopt;
  StaticFile file{typeOf(found->first), found->second.bytes};
  if (!found->second.file.empty()) {
    std::ifstream stream(found->second.file, std::ios::binary);
    if (!stream) return std::nullopt;
    file.bytes.assign(std::istreambuf_iterator<char>(stream), {});
  }
  return file;
}

} // namespace chamfer::http
