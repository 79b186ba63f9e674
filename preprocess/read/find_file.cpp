#include "preprocess/read/find_file.h"

#include "common/text.h"

#include <algorithm>

namespace chamfer {
namespace {

namespace fs = std::filesystem;

/// More parts than this are no path that somebody wrote: a bound on the folders that are looked through.
constexpr std::size_t kMostParts = 32;

struct NameParts {
  std::vector<std::string> parts; ///< without "" and "."
  bool absolute = false;
};

NameParts partsOf(std::string_view name) {
  NameParts result;
  name = trimmed(name);
  if (name.size() > 1 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
  if (name.find('\0') != std::string_view::npos) return result;
  std::string text(name);
  std::replace(text.begin(), text.end(), '\\', '/');
  result.absolute =
      text.starts_with('/') || (text.size() > 1 && text[1] == ':' && lowerCase(text.substr(0, 1)) >= "a" &&
                                lowerCase(text.substr(0, 1)) <= "z");
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('/', at), text.size());
    const std::string part = text.substr(at, end - at);
    if (!part.empty() && part != ".") result.parts.push_back(part);
    at = end + 1;
  }
  if (result.parts.size() > kMostParts)
    result.parts.erase(result.parts.begin(), result.parts.end() - std::ptrdiff_t(kMostParts));
  return result;
}

fs::path placeOf(const NameParts& name, const fs::path& folder) {
  fs::path place = folder;
  for (const std::string& part : name.parts)
    place /= part;
  return place.lexically_normal();
}

class Finder {
public:
  explicit Finder(const fs::path& top) {
    std::error_code error;
    top_ = fs::canonical(top.empty() ? "." : top, error);
    if (error) top_.clear();
  }

  /// `real`: without symbolic links.
  bool below(const fs::path& real) const {
    return !top_.empty() &&
           std::mismatch(top_.begin(), top_.end(), real.begin(), real.end()).first == top_.end();
  }

  bool reallyBelow(const fs::path& path) const {
    std::error_code error;
    const fs::path real = fs::canonical(path, error);
    return !error && below(real);
  }

  bool isFile(const fs::path& path) const {
    std::error_code error;
    return fs::is_regular_file(path, error) && reallyBelow(path);
  }

  /// Follows the parts from `first` on, each in any letter case where it is not there as it is.
  std::optional<fs::path> follow(fs::path at, const std::vector<std::string>& parts,
                                 std::size_t first) const {
    if (at.empty()) at = ".";
    for (std::size_t i = first; i < parts.size(); ++i) {
      if (!reallyBelow(at)) return std::nullopt;
      std::error_code error;
      if (parts[i] != ".." && !fs::exists(at / parts[i], error)) {
        const auto other = inAnyCase(at, parts[i]);
        if (!other) return std::nullopt;
        at = *other;
      } else {
        at /= parts[i];
      }
    }
    if (!isFile(at)) return std::nullopt;
    return at;
  }

private:
  /// The first by name of those that differ in letter case alone.
  static std::optional<fs::path> inAnyCase(const fs::path& folder, const std::string& name) {
    std::optional<fs::path> found;
    const std::string wanted = lowerCase(name);
    std::error_code error;
    for (fs::directory_iterator i(folder, error), end; !error && i != end; i.increment(error))
      if (lowerCase(i->path().filename().string()) == wanted && (!found || i->path() < *found))
        found = i->path();
    return found;
  }

  fs::path top_;
};

std::optional<FoundFile> find(std::string_view name, const std::vector<fs::path>& folders,
                              const Finder& finder) {
  const NameParts n = partsOf(name);
  if (n.parts.empty()) return std::nullopt;
  if (!n.absolute)
    for (const fs::path& folder : folders)
      if (const fs::path file = placeOf(n, folder); finder.isFile(file)) return FoundFile{file, {}};
  for (std::size_t first = 0; first < n.parts.size(); ++first)
    for (const fs::path& folder : folders)
      if (const auto file = finder.follow(folder, n.parts, first))
        return FoundFile{*file, file->lexically_relative(folder.empty() ? "." : folder).generic_string()};
  return std::nullopt;
}

} // namespace

fs::path namedPlace(const std::string& name, const fs::path& folder, const fs::path& top) {
  const NameParts n = partsOf(name);
  if (n.absolute || n.parts.empty()) return {};
  const fs::path place = placeOf(n, folder);
  std::error_code error;
  const fs::path real = fs::weakly_canonical(place, error);
  return error || !Finder(top).below(real) ? fs::path() : place;
}

std::optional<FoundFile> findFile(const std::string& name, const std::vector<fs::path>& folders,
                                  const fs::path& top) {
  const Finder finder(top);
  auto found = find(name, folders, finder);
  if (found) return found;
  const std::size_t comment = name.find(" #");
  if (comment == std::string::npos) return std::nullopt;
  return find(std::string_view(name).substr(0, comment), folders, finder);
}

} // namespace chamfer
