// Files that a scene names: found only below the served root, read once.
#pragma once

#include <filesystem>
#include <string>

namespace chamfer {

/// The file that `name` means in a scene file of folder `base`. Error(Malformed) when `name` is absolute, has
/// a ".." or leads out of `root` through a symbolic link; Error(NotFound) when there is no such regular file.
/// Messages carry `name` as written, never a path of this machine.
std::filesystem::path resolveBelow(const std::filesystem::path& root, const std::filesystem::path& base,
                                   const std::string& name);

/// The whole file. Error(NotFound), Error(PayloadTooLarge) above `limit` bytes.
std::string readFileText(const std::filesystem::path& file, std::uintmax_t limit);

} // namespace chamfer
