// The program's version. It is part of every ETag, so that a cached image does not outlive the renderer that
// made it.
#pragma once

namespace chamfer::http {

inline constexpr const char* kVersion = CHAMFER_VERSION;

} // namespace chamfer::http
