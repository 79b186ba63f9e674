// The page's files, put into the program when it was built (server/embed_files.cmake).
#pragma once

#include "common/embedded_file.h"

#include <span>

namespace chamfer::http {

/// Paths are below web/.
std::span<const EmbeddedFile> embeddedFiles();

} // namespace chamfer::http
