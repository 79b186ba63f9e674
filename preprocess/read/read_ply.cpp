// PLY: ASCII, binary little-endian and big-endian. Elements in any order, polygons of any size, properties
// that we do not use skipped by their declared type. A reader of our own: CGAL's lets vertex indices out of
// range pass and names no place, OpenMesh's returns true for files that end early or hold words for numbers.
#include "common/rounding.h"
#include "preprocess/read/read_formats.h"
#include "preprocess/read/read_ply_header.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace chamfer {
namespace {

using ply::Element, ply::Encoding, ply::Header, ply::Kind, ply::Property;

std::size_t sizeOf(Kind kind) {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[std::size_t(kind)];
}

/// Values one after the other from the body, in the encoding of the file.
class Body {
public:
  Body(std::string_view bytes, const Header& header, std::string_view name)
      : bytes_(bytes), at_(header.bytes), encoding_(header.encoding), place_{name},
        headerLines_(header.lines), lines_(bytes.substr(header.bytes)) {}

  /// Begins an element; in ASCII each has its own line.
  void begin(const Element& element, std::size_t index) {
    element_ = &element;
    index_ = index;
    if (encoding_ != Encoding::Ascii) return;
    next_ = 0;
    do {
      std::string_view line;
      if (!lines_.next(line)) fail("the file ends before it");
      place_.line = headerLines_ + lines_.number();
      splitTokens(line, tokens_);
    } while (tokens_.empty());
  }

  void end() {
    if (encoding_ == Encoding::Ascii && next_ != tokens_.size()) fail("more values than declared");
  }

  /// Behind the last element: blank lines, or bytes that are worth a warning.
  void finish(std::vector<std::string>& warnings) {
    std::string_view line;
    if (!ascii() && at_ < bytes_.size())
      warnings.push_back(std::to_string(bytes_.size() - at_) + " bytes behind the last element are not read");
    while (ascii() && lines_.next(line)) {
      place_.line = headerLines_ + lines_.number();
      splitTokens(line, tokens_);
      if (!tokens_.empty()) malformed(place_, inQuotes(tokens_[0]) + " behind the last declared element");
    }
  }

  /// A value as a double; whatever it is.
  double value(Kind kind, const char* what, bool used) {
    if (encoding_ == Encoding::Ascii) {
      if (next_ == tokens_.size()) fail("fewer values than declared");
      const std::string_view token = tokens_[next_++];
      if (used) return parseReal(token, what, place_);
      checkNumber(token, what, place_);
      return 0;
    }
    const std::size_t size = sizeOf(kind);
    if (bytes_.size() - at_ < size) fail("the file ends in it, at byte " + std::to_string(bytes_.size()));
    std::array<char, 8> raw{};
    const bool swapped = (encoding_ == Encoding::Big) != (std::endian::native == std::endian::big);
    for (std::size_t i = 0; i < size; ++i)
      raw[swapped ? size - 1 - i : i] = bytes_[at_ + i];
    at_ += size;
    const double v = decode(raw, kind);
    if (used && !std::isfinite(v)) fail(std::string(what) + " is not finite");
    return v;
  }

  /// A count or index from 0 to `most`.
  std::uint32_t whole(Kind kind, const char* what, std::uint32_t most) {
    const double v = value(kind, what, true);
    if (v != std::floor(v) || v < 0 || v > most) {
      fail(std::string(what) + " " + std::to_string(v) + " is not a whole number from 0 to " +
           std::to_string(most));
    }
    return std::uint32_t(v);
  }

  [[noreturn]] void fail(const std::string& what) const {
    malformed(place_, element_->name + " " + std::to_string(index_) + " of " +
                          std::to_string(element_->count) + ": " + what);
  }

  std::size_t left() const { return ascii() ? lines_.left() : bytes_.size() - at_; }
  const TextPlace& place() const { return place_; }
  bool ascii() const { return encoding_ == Encoding::Ascii; }

private:
  static double decode(const std::array<char, 8>& raw, Kind kind) {
    const auto as = [&]<class T>(T v) {
      std::memcpy(&v, raw.data(), sizeof v);
      return double(v);
    };
    switch (kind) {
    case Kind::I8:
      return as(std::int8_t{});
    case Kind::U8:
      return as(std::uint8_t{});
    case Kind::I16:
      return as(std::int16_t{});
    case Kind::U16:
      return as(std::uint16_t{});
    case Kind::I32:
      return as(std::int32_t{});
    case Kind::U32:
      return as(std::uint32_t{});
    case Kind::F32:
      return as(float{});
    case Kind::F64:
      return as(double{});
    }
    return 0;
  }

  std::string_view bytes_;
  std::size_t at_;
  Encoding encoding_;
  TextPlace place_;
  std::size_t headerLines_;
  LineReader lines_; ///< ASCII only; at_ is for the others
  std::vector<std::string_view> tokens_;
  std::size_t next_ = 0;
  const Element* element_ = nullptr;
  std::size_t index_ = 0;
};

class PlyReader {
public:
  PlyReader(std::string_view bytes, std::string_view name)
      : header_(ply::readHeader(bytes, name)), body_(bytes, header_, name), name_(name) {}

  TriangleMesh run() {
    const Element* vertices = nullptr;
    for (const Element& element : header_.elements) {
      checkCount(element);
      if (element.name == "vertex" && !vertices)
        readVertices(*(vertices = &element));
      else if (element.name == "face" && vertices)
        readFaces(element);
      else
        skip(element);
    }
    if (!vertices) malformed({name_}, "no element named vertex before the faces");
    body_.finish(mesh_.warnings);
    return std::move(mesh_);
  }

private:
  /// Every property takes a byte at least, so larger counts are wrong whatever follows.
  void checkCount(const Element& element) const {
    const std::size_t least = std::max<std::size_t>(1, element.properties.size());
    if (element.count > (body_.left() + 1) / least)
      malformed({name_, element.line}, std::to_string(element.count) + " elements " + inQuotes(element.name) +
                                           " are declared, but only " + std::to_string(body_.left()) +
                                           " bytes follow");
  }

  void readVertices(const Element& e) {
    const std::size_t none = e.properties.size();
    const std::size_t at[5] = {e.find({"x"}), e.find({"y"}), e.find({"z"}), e.find({"u", "s", "texture_u"}),
                               e.find({"v", "t", "texture_v"})};
    if (at[0] == none || at[1] == none || at[2] == none)
      malformed({name_, e.line}, "the vertices have no properties x, y and z");
    const bool uv = at[3] != none && at[4] != none;
    mesh_.positions.reserve(e.count);
    for (std::size_t i = 0; i < e.count; ++i) {
      body_.begin(e, i);
      double values[5] = {};
      for (std::size_t p = 0; p < none; ++p) {
        const auto slot = std::size_t(std::find(at, at + (uv ? 5 : 3), p) - at);
        if (e.properties[p].countKind || slot >= (uv ? 5u : 3u))
          skip(e.properties[p]);
        else
          values[slot] = body_.value(e.properties[p].kind, e.properties[p].name.c_str(), true);
      }
      body_.end();
      mesh_.positions.emplace_back(values[0], values[1], values[2]);
      if (uv) mesh_.uvs.push_back({float(values[3]), float(values[4])});
    }
  }

  void readFaces(const Element& e) {
    const std::size_t list = e.find({"vertex_indices", "vertex_index"});
    if (list == e.properties.size() || !e.properties[list].countKind)
      malformed({name_, e.line}, "the faces have no list vertex_indices");
    for (std::size_t i = 0; i < e.count; ++i) {
      body_.begin(e, i);
      for (std::size_t p = 0; p < e.properties.size(); ++p)
        if (p == list)
          readCorners(e.properties[p]);
        else
          skip(e.properties[p]);
      body_.end();
      if (body_.ascii()) mesh_.lineOfFace.push_back(std::uint32_t(body_.place().line));
      appendPolygon(mesh_, std::uint32_t(i), corners_,
                    mesh_.uvs.empty() ? std::span<std::uint32_t>() : corners_);
    }
  }

  void readCorners(const Property& property) {
    const std::uint32_t count = body_.whole(*property.countKind, "the number of corners", kNone);
    if (count < 3) body_.fail("a face has at least 3 corners, here are " + std::to_string(count));
    if (!body_.ascii() && count > body_.left())
      body_.fail(std::to_string(count) + " corners do not fit in what is left of the file");
    corners_.clear();
    if (mesh_.positions.empty()) body_.fail("a face without vertices");
    for (std::uint32_t k = 0; k < count; ++k)
      corners_.push_back(
          body_.whole(property.kind, "vertex index", std::uint32_t(mesh_.positions.size() - 1)));
  }

  void skip(const Property& property) {
    const std::uint32_t count =
        property.countKind ? body_.whole(*property.countKind, "the length of a list", kNone) : 1;
    for (std::uint32_t k = 0; k < count; ++k)
      body_.value(property.kind, property.name.c_str(), false);
  }

  void skip(const Element& e) {
    for (std::size_t i = 0; i < e.count; ++i) {
      body_.begin(e, i);
      for (const Property& property : e.properties)
        skip(property);
      body_.end();
    }
  }

  Header header_;
  Body body_;
  std::string_view name_;
  std::vector<std::uint32_t> corners_;
  TriangleMesh mesh_;
};

} // namespace

TriangleMesh readPly(std::string_view bytes, std::string_view name) {
  TriangleMesh mesh = PlyReader(bytes, name).run();
  checkSize(mesh, {name});
  return mesh;
}

} // namespace chamfer
