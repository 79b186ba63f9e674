#include "server/jobs/seeds/seed_store.h"

#include "common/error.h"
#include "common/text.h"

#include <system_error>
#include <utility>

namespace chamfer {

SeedStore::SeedStore(std::filesystem::path folder) : folder_(std::move(folder)) {
  std::error_code problem;
  std::filesystem::create_directories(folder_, problem);
  if (problem)
    throw Error(ErrorKind::CannotWrite,
                "cannot make the folder " + fileInQuotes(folder_.string()) + ": " + problem.message());
}

std::optional<Picture> SeedStore::find(const Digest& key) const {
  const std::filesystem::path file = fileOf(key);
  std::error_code problem;
  if (!std::filesystem::exists(file, problem)) return {};
  try {
    return readPicture(file);
  } catch (const Error&) {
    std::filesystem::remove(file, problem);
    return {};
  }
}

void SeedStore::keep(const Digest& key, const Picture& picture) const { writePicture(fileOf(key), picture); }

} // namespace chamfer
