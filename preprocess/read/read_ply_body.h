// The body of a PLY file: values one after the other, in the encoding of the file. In ASCII it is a stream of
// numbers, whatever lines they stand on.
#pragma once

#include "preprocess/read/read_ply_header.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace chamfer::ply {

class Body {
public:
  Body(std::string_view bytes, const Header& header, std::string_view name)
      : bytes_(bytes), at_(header.bytes), encoding_(header.encoding), place_{name},
        headerLines_(header.lines), lines_(bytes.substr(header.bytes)) {}

  /// Begins and ends an element; every message names it. `element` must live as long.
  void begin(const Element& element, std::size_t index);
  void end();

  /// A value as a double; `finite`: nan and inf are errors.
  double value(Kind kind, const char* what, bool finite);
  /// A count or index from 0 to `most`.
  std::uint32_t whole(Kind kind, const char* what, std::uint32_t most);

  /// Behind the last element: words are an error, bytes are counted.
  std::size_t finish();

  /// Throws Error(Malformed) about the element.
  [[noreturn]] void fail(const std::string& what) const;

  std::size_t left() const { return ascii() ? lines_.left() + lineLeft() : bytes_.size() - at_; } ///< bytes
  const TextPlace& place() const { return place_; }
  bool ascii() const { return encoding_ == Encoding::Ascii; }

private:
  std::size_t lineLeft() const;
  /// The next word, of a later line where this one is at its end.
  bool peek();
  /// For errors: the first line that holds more or less than one element, since that may be the cause.
  std::string hint() const;

  std::string_view bytes_;
  std::size_t at_;
  Encoding encoding_;
  TextPlace place_;
  std::size_t headerLines_;
  LineReader lines_; ///< ASCII only; at_ is for the others
  std::vector<std::string_view> tokens_;
  std::size_t next_ = 0;
  const Element* element_ = nullptr;
  std::size_t index_ = 0, beganAt_ = 0, oddLine_ = 0;
};

} // namespace chamfer::ply
