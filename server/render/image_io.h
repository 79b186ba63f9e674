// Encoding of images (OpenImageIO behind this header).
#pragma once

#include "server/render/render.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace chamfer {

/// 16-byte header ("CT16", then width, height, samples as u32) and RGBA16F, little-endian, linear, top row
/// first.
std::vector<std::byte> encodeF16(const Image& image, unsigned samples);
/// 8-bit sRGB with the display transform of the page (exposure 0), alpha kept. Deterministic bytes.
std::vector<std::byte> encodePng(const Image& image);
/// 32-bit float EXR, linear.
std::vector<std::byte> encodeExr(const Image& image);
/// Writes by extension (.png, .exr). Error(CannotWrite), Error(Usage) for another extension.
void writeImage(const std::filesystem::path& path, const Image& image);

} // namespace chamfer
