// The HTML report's template, style and script, put into the program when it was built
// (server/embed_files.cmake).
#pragma once

#include "common/embedded_file.h"

#include <span>

namespace chamfer {

/// report.html, report.css, report.js, report_views.js.
std::span<const EmbeddedFile> reportFiles();

} // namespace chamfer
