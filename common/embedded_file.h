// A file that was put into the program when it was built (server/embed_files.cmake).
#pragma once

#include <string_view>

namespace chamfer {

struct EmbeddedFile {
  std::string_view path; ///< below the folder that it came from, as "index.html"
  std::string_view bytes;
};

} // namespace chamfer
