// The texture statements of MTL: a file's name with options before or behind it.
#pragma once

#include "preprocess/mesh.h"

#include <string>
#include <string_view>
#include <vector>

namespace chamfer {

struct TextureStatement {
  MeshTexture texture;            ///< file, scale, offset, clamp, strength; an empty file: none is named
  bool hasBumpMultiplier = false; ///< -bm stood there
  std::string channel;            ///< of -imfchan; empty: none is named
  std::vector<std::string> notSupported; ///< options that would change the picture, with their values
};

/// Options are those of the specification with values that they can have, wherever they stand; all else is
/// the name, which may hold blanks. `rest` is the statement without its key.
TextureStatement parseTextureStatement(std::string_view rest);

} // namespace chamfer
