#include "preprocess/read/read_ply_header.h"

namespace chamfer::ply {
namespace {

std::optional<Kind> kindOf(std::string_view word) {
  constexpr struct {
    const char *name, *other;
    Kind kind;
  } kKinds[] = {{"char", "int8", Kind::I8},      {"uchar", "uint8", Kind::U8},
                {"short", "int16", Kind::I16},   {"ushort", "uint16", Kind::U16},
                {"int", "int32", Kind::I32},     {"uint", "uint32", Kind::U32},
                {"float", "float32", Kind::F32}, {"double", "float64", Kind::F64}};
  for (const auto& k : kKinds)
    if (word == k.name || word == k.other) return k.kind;
  return std::nullopt;
}

} // namespace

Header readHeader(std::string_view bytes, std::string_view name) {
  Header header;
  TextPlace place{name};
  LineReader reader(bytes);
  std::string_view line;
  std::vector<std::string_view> t;
  bool format = false;
  while (reader.next(line)) {
    place.line = reader.number();
    splitTokens(line, t);
    if (place.line == 1 && (t.size() != 1 || t[0] != "ply"))
      malformed(place, "no PLY: the first line is not \"ply\"");
    if (t.size() > 2 && t[0] == "comment" && t[1] == "TextureFile" && header.textureLine == 0)
      header.textureLine = place.line;
    if (place.line == 1 || t.empty() || t[0] == "comment" || t[0] == "obj_info") continue;
    if (t[0] == "end_header") {
      if (!format) malformed(place, "the header has no format line");
      header.lines = reader.number();
      header.bytes = reader.offset();
      // Where lines end in "\r" alone, a "\n" behind the last one is the first byte of the body.
      if (const std::size_t first = bytes.find_first_of("\r\n");
          bytes[first] == '\r' && bytes[first + 1] != '\n' && bytes.substr(0, header.bytes).ends_with("\r\n"))
        --header.bytes;
      return header;
    }
    if (t[0] == "format" && t.size() == 3) {
      if (t[2] != "1.0") malformed(place, "PLY version " + inQuotes(t[2]) + "; 1.0 is read");
      format = true;
      if (t[1] == "ascii")
        header.encoding = Encoding::Ascii;
      else if (t[1] == "binary_little_endian")
        header.encoding = Encoding::Little;
      else if (t[1] == "binary_big_endian")
        header.encoding = Encoding::Big;
      else
        malformed(place, "format " + inQuotes(t[1]) + " is not known");
    } else if (t[0] == "element" && t.size() == 3) {
      header.elements.push_back(
          {std::string(t[1]), parseCount(t[2], UINT32_MAX, "the number of elements", place), place.line, {}});
    } else if (t[0] == "property" && !header.elements.empty() &&
               (t.size() == 3 || (t.size() == 5 && t[1] == "list"))) {
      const bool list = t.size() == 5;
      const std::optional<Kind> kind = kindOf(t[list ? 3 : 1]),
                                countKind = list ? kindOf(t[2]) : std::nullopt;
      if (!kind || (list && (!countKind || *countKind >= Kind::F32)))
        malformed(place, "property type in " + inQuotes(line) + " is not known");
      header.elements.back().properties.push_back({std::string(t.back()), *kind, countKind});
    } else {
      malformed(place, inQuotes(line) + " is not understood in a PLY header");
    }
  }
  malformed(place, "the header has no end_header");
}

} // namespace chamfer::ply
