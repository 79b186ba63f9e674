#include "preprocess/read/read_ply_body.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>

namespace chamfer::ply {
namespace {

std::size_t sizeOf(Kind kind) {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[std::size_t(kind)];
}

double decode(const std::array<char, 8>& raw, Kind kind) {
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

} // namespace

bool Body::peek() {
  std::string_view line;
  while (next_ >= tokens_.size()) {
    if (!lines_.next(line)) return false;
    place_.line = headerLines_ + lines_.number();
    splitTokens(line, tokens_);
    next_ = 0;
  }
  return true;
}

std::size_t Body::lineLeft() const {
  if (next_ >= tokens_.size()) return 0;
  return std::size_t(tokens_.back().data() + tokens_.back().size() - tokens_[next_].data());
}

void Body::begin(const Element& element, std::size_t index) {
  element_ = &element;
  index_ = index;
  if (!ascii() || element.properties.empty()) return;
  if (!peek()) fail("the file ends before it");
  beganAt_ = place_.line;
  if (next_ > 0 && oddLine_ == 0) oddLine_ = place_.line;
}

void Body::end() {
  if (ascii() && oddLine_ == 0 && !element_->properties.empty() &&
      (next_ < tokens_.size() || place_.line != beganAt_))
    oddLine_ = beganAt_;
}

std::size_t Body::finish() {
  if (!ascii()) return bytes_.size() - at_;
  if (peek()) malformed(place_, inQuotes(tokens_[next_]) + " behind the last declared element" + hint());
  return 0;
}

double Body::value(Kind kind, const char* what, bool finite) {
  if (ascii()) {
    if (!peek()) fail("the file ends in it");
    const std::string_view token = tokens_[next_++];
    const double v = checkNumber(token, what, place_);
    if (finite && !std::isfinite(v)) fail(std::string(what) + " " + inQuotes(token) + " is not finite");
    return v;
  }
  const std::size_t size = sizeOf(kind);
  if (bytes_.size() - at_ < size) fail("the file ends in it, at byte " + std::to_string(bytes_.size()));
  std::array<char, 8> raw{};
  const bool swapped = (encoding_ == Encoding::Big) != (std::endian::native == std::endian::big);
  for (std::size_t i = 0; i < size; ++i)
    raw[swapped ? size - 1 - i : i] = bytes_[at_ + i];
  at_ += size;
  const double v = decode(raw, kind);
  if (finite && !std::isfinite(v)) fail(std::string(what) + " is not finite");
  return v;
}

std::uint32_t Body::whole(Kind kind, const char* what, std::uint32_t most) {
  const double v = value(kind, what, true);
  if (v != std::floor(v) || v < 0 || v > most)
    fail(std::string(what) + " " + numberText(v) + " is not a whole number from 0 to " +
         std::to_string(most));
  return std::uint32_t(v);
}

void Body::fail(const std::string& what) const {
  malformed(place_, inQuotes(element_->name) + " " + std::to_string(index_) + " of " +
                        std::to_string(element_->count) + ": " + what + hint());
}

std::string Body::hint() const {
  if (oddLine_ == 0) return "";
  return "; the first line with more or less than one element is line " + std::to_string(oddLine_);
}

} // namespace chamfer::ply
