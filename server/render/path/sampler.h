// Quasi-random numbers addressed by (pixel, sample, dimension, seed) alone: no state, so any tile, order and
// number of threads sees the same ones, and sample ranges join without a seam.
//
// Each pair of dimensions is the two-dimensional Sobol sequence, a (0,2)-sequence, with hash-based Owen
// scrambling of both coordinates; pairs are decorrelated by an Owen-scrambled (nested uniform) shuffle of the
// sample index, which keeps every aligned power-of-two block of samples a (0,m,2)-net.
//   Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020: shuffled, padded, scrambled Sobol pairs.
//   Laine and Karras, "Stratified Sampling for Stochastic Transparency", EGSR 2011: the scrambling hash.
//   Vegdahl, "Building a Better LK Hash", 2021: the constants of the hash used here.
//   Ahmed, "An Implementation Algorithm of 2D Sobol Sequence Fast, Elegant, and Compact", EGSR 2024: the
//   second coordinate is the index times the Pascal matrix mod 2, five shifts instead of a loop over bits.
#pragma once

#include <cstdint>
#include <type_traits>

namespace chamfer {

/// Two numbers in [0, 1).
struct Float2 {
  float x = 0, y = 0;
};

// Words are std::uint32_t, or lanes of them (wavefront/lanes.h).

template <class Word>
constexpr Word reverseBits(Word v) {
  if constexpr (std::is_same_v<Word, std::uint32_t>)
    v = __builtin_bswap32(v);
  else
    v = (v << 24) | ((v & 0xff00u) << 8) | ((v >> 8) & 0xff00u) | (v >> 24);
  v = ((v & 0x0f0f0f0fu) << 4) | ((v >> 4) & 0x0f0f0f0fu);
  v = ((v & 0x33333333u) << 2) | ((v >> 2) & 0x33333333u);
  return ((v & 0x55555555u) << 1) | ((v >> 1) & 0x55555555u);
}

/// Owen scrambling of a number whose bits are reversed: every bit is flipped by a hash of the bits below it.
template <class Word>
constexpr Word owenScrambleReversed(Word v, const Word& seed) {
  v ^= v * 0x3d20adeau;
  v += seed;
  v *= (seed >> 16) | 1u;
  v ^= v * 0x05526c56u;
  v ^= v * 0x53a22864u;
  return v;
}

/// Second Sobol coordinate of sample `index`, bits reversed: bit r is the parity of the index bits k with
/// C(k, r) odd.
template <class Word>
constexpr Word sobolSecondReversed(Word index) {
  index ^= index >> 16;
  index ^= (index & 0xff00ff00u) >> 8;
  index ^= (index & 0xf0f0f0f0u) >> 4;
  index ^= (index & 0xccccccccu) >> 2;
  return index ^ ((index & 0xaaaaaaaau) >> 1);
}

/// Bijective mix of 64 bits (Stafford's variant 13, as in SplitMix64).
constexpr std::uint64_t mixBits(std::uint64_t v) {
  v ^= v >> 30;
  v *= 0xbf58476d1ce4e5b9ull;
  v ^= v >> 27;
  v *= 0x94d049bb133111ebull;
  return v ^ (v >> 31);
}

class Sampler {
public:
  constexpr Sampler(std::uint32_t x, std::uint32_t y, std::uint32_t sample, std::uint32_t seed)
      : pixel_(mixBits(mixBits((std::uint64_t(y) << 32) | x) + seed)), reversedIndex_(reverseBits(sample)) {}

  /// What the point of a dimension pair is made of.
  template <class Word>
  struct PairWords {
    Word reversedIndex, shuffle, first, second;
  };
  constexpr PairWords<std::uint32_t> words(std::uint32_t pair) const {
    const std::uint64_t a = mixBits(pixel_ + (pair + 1) * 0x9e3779b97f4a7c15ull);
    const std::uint64_t b = a * 0xd1342543de82ef95ull + 1; // a second, independent word
    return {reversedIndex_, std::uint32_t(a), std::uint32_t(a >> 32), std::uint32_t(b >> 32)};
  }
  /// The point, its coordinates as shares of 2^24.
  template <class Word>
  static constexpr void point(const PairWords<Word>& w, Word& x, Word& y) {
    const Word index = reverseBits(owenScrambleReversed(w.reversedIndex, w.shuffle));
    x = reverseBits(owenScrambleReversed(index, w.first)) >> 8;
    y = reverseBits(owenScrambleReversed(sobolSecondReversed(index), w.second)) >> 8;
  }

  /// The point of dimension pair `pair`.
  constexpr Float2 pair(std::uint32_t pair) const {
    std::uint32_t x = 0, y = 0;
    point(words(pair), x, y);
    return {float(x) * 0x1p-24f, float(y) * 0x1p-24f};
  }

private:
  std::uint64_t pixel_;
  std::uint32_t reversedIndex_;
};

} // namespace chamfer
