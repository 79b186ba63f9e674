// Rendered seeds in a folder, so that none is rendered twice: what several cases share, and what was finished
// before a job was stopped. Each file is written at once or not at all.
#pragma once

#include "common/digest.h"
#include "server/jobs/image/picture.h"

#include <filesystem>
#include <optional>

namespace chamfer {

class SeedStore {
public:
  /// Makes the folder if there is none. Error(CannotWrite).
  explicit SeedStore(std::filesystem::path folder);

  /// Nothing where there is none. A file that cannot be read is removed: it is rendered again.
  std::optional<Picture> find(const Digest& key) const;
  /// Error(CannotWrite).
  void keep(const Digest& key, const Picture& picture) const;

  const std::filesystem::path& folder() const { return folder_; }

private:
  std::filesystem::path fileOf(const Digest& key) const { return folder_ / (key.hex() + ".exr"); }
  std::filesystem::path folder_;
};

} // namespace chamfer
