// Lanes: eight float32 numbers, with which formulas read as they do for one. Everything is done to each lane
// alone and rounded as for a float, so that a lane's bits are those of the scalar formula.
#pragma once

#include "common/vec.h"
#include "server/render/image/color.h"
#include "server/render/path/elementary.h"
#include "server/render/path/sampler.h"

#include <cstdint>
#include <experimental/simd>

namespace chamfer {

namespace simd = std::experimental;

inline constexpr std::size_t kLanes = 8;
using Lanes = simd::simd<float, simd::simd_abi::deduce_t<float, kLanes>>;
using LaneMask = Lanes::mask_type;

/// Lanes in memory, to be filled and read one by one.
struct alignas(32) LaneFloats {
  float at[kLanes];
  LaneFloats() = default;
  explicit LaneFloats(const Lanes& lanes) { lanes.copy_to(at, simd::vector_aligned); }
  operator Lanes() const { return Lanes(at, simd::vector_aligned); }
  float& operator[](std::size_t i) { return at[i]; }
  float operator[](std::size_t i) const { return at[i]; }
};

using WordLanes = simd::simd<std::uint32_t, simd::simd_abi::deduce_t<std::uint32_t, kLanes>>;

/// Points of the sampler in memory: what they are made of is set one by one, they are made in lanes.
struct PointWords {
  alignas(32) std::uint32_t reversedIndex[kLanes], shuffle[kLanes], first[kLanes], second[kLanes];
  void set(std::size_t i, const Sampler::PairWords<std::uint32_t>& w) {
    reversedIndex[i] = w.reversedIndex;
    shuffle[i] = w.shuffle;
    first[i] = w.first;
    second[i] = w.second;
  }
  void make(LaneFloats& x, LaneFloats& y) const {
    const auto load = [](const std::uint32_t* at) { return WordLanes(at, simd::vector_aligned); };
    WordLanes u, v;
    Sampler::point<WordLanes>({load(reversedIndex), load(shuffle), load(first), load(second)}, u, v);
    const auto unit = [](const WordLanes& w) { // below 2^24: the sign bit of a cheaper conversion is free
      using IntLanes = simd::rebind_simd_t<int, WordLanes>;
      return LaneFloats(simd::static_simd_cast<Lanes>(simd::static_simd_cast<IntLanes>(w)) * Lanes(0x1p-24f));
    };
    x = unit(u);
    y = unit(v);
  }
};

using VectorLanes = Vector3T<Lanes>;
struct VectorLaneFloats {
  LaneFloats x, y, z;
  VectorLaneFloats() = default;
  explicit VectorLaneFloats(const VectorLanes& v) : x(v.x), y(v.y), z(v.z) {}
  operator VectorLanes() const { return {x, y, z}; }
  void set(std::size_t i, const Vector3f& v) { x[i] = v.x, y[i] = v.y, z[i] = v.z; }
  Vector3f operator[](std::size_t i) const { return {x[i], y[i], z[i]}; }
};

struct ColorLanes {
  Lanes r = 0, g = 0, b = 0;
  ColorLanes operator+(const ColorLanes& o) const { return {r + o.r, g + o.g, b + o.b}; }
  ColorLanes operator*(const ColorLanes& o) const { return {r * o.r, g * o.g, b * o.b}; }
  ColorLanes operator*(const Lanes& s) const { return {r * s, g * s, b * s}; }
};
inline Lanes luminance(const ColorLanes& c) { return 0.2126f * c.r + 0.7152f * c.g + 0.0722f * c.b; }
inline ColorLanes select(const LaneMask& condition, const ColorLanes& yes, const ColorLanes& no) {
  return {select(condition, yes.r, no.r), select(condition, yes.g, no.g), select(condition, yes.b, no.b)};
}
struct ColorLaneFloats {
  LaneFloats r, g, b;
  ColorLaneFloats() = default;
  explicit ColorLaneFloats(const ColorLanes& c) : r(c.r), g(c.g), b(c.b) {}
  operator ColorLanes() const { return {r, g, b}; }
  void set(std::size_t i, const Color& c) { r[i] = c.r, g[i] = c.g, b[i] = c.b; }
  Color operator[](std::size_t i) const { return {r[i], g[i], b[i]}; }
};

} // namespace chamfer
