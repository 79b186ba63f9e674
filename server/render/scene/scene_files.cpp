#include "server/render/scene/scene_files.h"

#include "common/error.h"
#include "common/text.h"

#include <algorithm>
#include <fstream>

namespace chamfer {

namespace fs = std::filesystem;

fs::path resolveBelow(const fs::path& root, const fs::path& base, const std::string& name) {
  const fs::path relative(name);
  if (name.find('\0') != std::string::npos)
    throw Error(ErrorKind::Malformed, "a file's name must not contain a zero character");
  if (name.empty() || relative.is_absolute())
    throw Error(ErrorKind::Malformed, fileInQuotes(name) + ": name the file relative to the scene file");
  if (std::find(relative.begin(), relative.end(), "..") != relative.end())
    throw Error(ErrorKind::Malformed, fileInQuotes(name) + ": \"..\" is not allowed in a file's name");
  std::error_code error;
  const fs::path file = fs::canonical(base / relative, error);
  if (error || !fs::is_regular_file(file, error))
    throw Error(ErrorKind::NotFound, fileInQuotes(name) + ": there is no such file");
  const fs::path top = fs::canonical(root, error);
  const auto [end, unused] = std::mismatch(top.begin(), top.end(), file.begin(), file.end());
  if (error || end != top.end())
    throw Error(ErrorKind::Malformed, fileInQuotes(name) + ": the file lies outside of the served folder");
  return file;
}

std::string readFileText(const fs::path& file, std::uintmax_t limit) {
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  if (!in) throw Error(ErrorKind::NotFound, fileInQuotes(file.filename().string()) + ": cannot be opened");
  const auto size = in.tellg();
  if (size < 0) throw Error(ErrorKind::NotFound, fileInQuotes(file.filename().string()) + ": cannot be read");
  if (std::uintmax_t(size) > limit)
    throw Error(ErrorKind::PayloadTooLarge, fileInQuotes(file.filename().string()) + ": " +
                                                std::to_string(size) + " bytes, the limit is " +
                                                std::to_string(limit));
  std::string text(std::size_t(size), '\0');
  in.seekg(0);
  if (size > 0 && !in.read(text.data(), size))
    throw Error(ErrorKind::NotFound, fileInQuotes(file.filename().string()) + ": cannot be read");
  return text;
}

} // namespace chamfer
