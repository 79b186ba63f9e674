#include "server/jobs/cli/scratch_folder.h"

#include "common/error.h"

#include <cstdlib>
#include <string>
#include <system_error>

namespace chamfer {

ScratchFolder::ScratchFolder() {
  std::error_code problem;
  std::string name = (std::filesystem::temp_directory_path(problem) / "chamfer-seeds-XXXXXX").string();
  if (problem || !::mkdtemp(name.data()))
    throw Error(ErrorKind::CannotWrite, "cannot make a temporary folder for rendered seeds; --keep DIR names "
                                        "another place");
  path_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

} // namespace chamfer
