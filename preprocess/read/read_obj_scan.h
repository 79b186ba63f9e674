// The strict half of reading OBJ. tinyobjloader reads "0,5" and "abc" as 0, takes "3.1+e2" for 3.1, drops
// what it cannot parse without a word, gives no line numbers, and returns two of three 17-digit numbers some
// units in the last place off. So every line with geometry is checked here first, and numbers are taken from
// here; the library then reads the statements of a text in which nothing is left to guess.
#pragma once

#include "common/vec.h"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace chamfer {

struct ObjScan {
  std::vector<Point3> positions;
  std::vector<std::array<float, 2>> uvs;
  std::vector<std::uint32_t> lineOfFace; ///< 1-based
  /// Vertices and uvs above each face's line: what its negative indices count back from.
  std::vector<std::array<std::uint32_t, 2>> above;
  std::vector<std::string> libraries; ///< what mtllib lines name, each once
  std::vector<std::string> warnings;
};

/// Checks `text` and takes its numbers. In place, a byte order mark, line continuations and comments behind a
/// face are overwritten with blanks. On return every face line has three corners or more, each one to three
/// whole numbers other than 0 that fit an int. Throws Error(Malformed) with line and token.
ObjScan scanObj(std::string& text, std::string_view name);

} // namespace chamfer
