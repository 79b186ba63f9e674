// Files that a mesh or a material library names, as tools of other machines write the names.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace chamfer {

struct FoundFile {
  std::filesystem::path file;
  /// Set when the name does not lead there as it is written: the place below the folder that was taken
  /// instead, for a warning.
  std::string instead;
};

/// The regular file that `name` means: '\' is '/', quotes around it are not part of it. Relative names begin
/// in each of `folders` in turn. Where none is there, the name is taken in other letter case and then by its
/// last parts
/// ("textures/wood.png", "wood.png"), which also finds what has an absolute path of another machine, and
/// without what follows " #". Nothing outside of `top` is found, neither by ".." nor through symbolic links;
/// an empty path is the folder that the program runs in.
std::optional<FoundFile> findFile(const std::string& name, const std::vector<std::filesystem::path>& folders,
                                  const std::filesystem::path& top);

/// Where that file would lie if it were there as named, in `folder`; empty for absolute names and outside of
/// `top`.
std::filesystem::path namedPlace(const std::string& name, const std::filesystem::path& folder,
                                 const std::filesystem::path& top);

} // namespace chamfer
