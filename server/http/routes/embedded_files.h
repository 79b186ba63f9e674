// The page's files, put into the program when it was built (embed_web.cmake).
#pragma once

#include <span>
#include <string_view>

namespace chamfer::http {

struct EmbeddedFile {
  std::string_view path; ///< below web/, as "index.html"
  std::string_view bytes;
};
std::span<const EmbeddedFile> embeddedFiles();

} // namespace chamfer::http
