// The header of a PLY file: which elements follow, with which properties, in which encoding.
#pragma once

#include "preprocess/read/read_text.h"

#include <initializer_list>
#include <optional>

namespace chamfer::ply {

enum class Kind : std::uint8_t { I8, U8, I16, U16, I32, U32, F32, F64 };

struct Property {
  std::string name;
  Kind kind = Kind::F32;
  std::optional<Kind> countKind; ///< set for lists
};

struct Element {
  std::string name;
  std::size_t count = 0, line = 0;
  std::vector<Property> properties;
  std::size_t find(std::initializer_list<const char*> names) const {
    for (std::size_t i = 0; i < properties.size(); ++i)
      for (const char* candidate : names)
        if (properties[i].name == candidate) return i;
    return properties.size();
  }
};

enum class Encoding : std::uint8_t { Ascii, Little, Big };

struct Header {
  Encoding encoding = Encoding::Ascii;
  std::vector<Element> elements;
  std::size_t lines = 0, bytes = 0; ///< up to and with end_header
  std::size_t textureLine = 0; ///< of the first comment that names a texture (MeshLab's TextureFile); 0: none
};

/// Throws Error(Malformed) with the line.
Header readHeader(std::string_view bytes, std::string_view name);

} // namespace chamfer::ply
