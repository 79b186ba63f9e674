// Encoding and reading of images (OpenImageIO behind this header).
#pragma once

#include "server/render/material/texture.h"
#include "server/render/path/render.h"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace chamfer {

/// The sRGB curve (IEC 61966-2-1), decoded.
float linearFromSRgb(float v);

/// 16-byte header ("CT16", then width, height, samples as u32) and RGBA16F, little-endian, linear, top row
/// first. Half floats end at 65504: what is beyond is stored as that (see beyondHalf()); NaN stays NaN.
std::vector<std::byte> encodeF16(const Image& image, unsigned samples);
/// How many of the image's numbers are beyond a half float's range.
std::size_t beyondHalf(const Image& image);
/// 8-bit sRGB: values are clamped to [0, 1] and encoded by the sRGB curve (IEC 61966-2-1), nothing else;
/// alpha is linear. NaN becomes 0. Deterministic bytes.
std::vector<std::byte> encodePng(const Image& image);
/// 32-bit float EXR, linear. Deterministic bytes.
std::vector<std::byte> encodeExr(const Image& image);
/// Writes by extension (.png, .exr). Error(CannotWrite), Error(Usage) for another extension.
void writeImage(const std::filesystem::path& path, const Image& image);

/// How the colours of a file's pixels are meant. Automatic: sRGB for integer pixels, linear for floating
/// point.
enum class PixelEncoding { Automatic, Linear };
/// Reads any format OpenImageIO knows; grey becomes RGB, alpha is dropped. Error(Malformed) for what cannot
/// be read or is larger than 16384 pixels a side (Error(NotFound): no such file). Values that no light or
/// colour has are replaced, with a warning that names the first such pixel: what is negative or no number by
/// 0, what is infinite by 65504 (the largest half float, which is where such files come from), what is above
/// 1e9 by that. `name` stands in messages.
Texture readTexture(const std::filesystem::path& file, PixelEncoding encoding, const std::string& name,
                    std::vector<std::string>& warnings);

/// Channels by name, values as they are in the file (NaN and infinities, too).
struct ChannelImage {
  unsigned width = 0, height = 0;
  std::vector<std::string> names; ///< of the channels
  std::vector<float> values;      ///< [height][width][names.size()], top row first
  /// The file's pixels are integer and sRGB-encoded; `values` are decoded to linear (alpha as it is).
  bool fromSRgb = false;
  std::map<std::string, std::string> attributes; ///< those that are texts
};
/// Which of a file's channels are wanted, as places in the list of their names, in the order wanted. May
/// throw.
using ChannelChoice = std::function<std::vector<std::size_t>(const std::vector<std::string>& names)>;
/// Reads any format OpenImageIO knows. Integer pixels are sRGB unless the file says that they are linear.
/// Error(NotFound), Error(Malformed): not an image, damaged, more than 16384 pixels a side, several pictures
/// in one file, a picture that is a part of its frame. `name` stands in messages.
ChannelImage readChannels(const std::filesystem::path& file, const std::string& name,
                          const ChannelChoice& choice);
/// Width and height, by the file's head alone. Errors as readChannels().
std::pair<unsigned, unsigned> imageSize(const std::filesystem::path& file, const std::string& name);
/// 32-bit float EXR. Deterministic bytes. Not for pixels that are to stay sRGB: they are written linear.
std::vector<std::byte> encodeExr(const ChannelImage& image);

} // namespace chamfer
