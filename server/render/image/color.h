// Linear RGB with Rec. 709 primaries: radiance, reflectance, transmittance.
#pragma once

#include <algorithm>
#include <cmath>

namespace chamfer {

struct Color {
  float r = 0, g = 0, b = 0;
  constexpr Color operator+(const Color& o) const { return {r + o.r, g + o.g, b + o.b}; }
  constexpr Color operator-(const Color& o) const { return {r - o.r, g - o.g, b - o.b}; }
  constexpr Color operator*(const Color& o) const { return {r * o.r, g * o.g, b * o.b}; }
  constexpr Color operator*(float s) const { return {r * s, g * s, b * s}; }
  constexpr Color& operator+=(const Color& o) { return *this = *this + o; }
  constexpr Color& operator*=(const Color& o) { return *this = *this * o; }
  constexpr Color& operator*=(float s) { return *this = *this * s; }
  constexpr bool operator==(const Color&) const = default;
  constexpr bool isBlack() const { return r == 0 && g == 0 && b == 0; }
};
constexpr Color operator*(float s, const Color& c) { return c * s; }
constexpr Color grey(float v) { return {v, v, v}; }
constexpr Color lerp(const Color& a, const Color& b, float t) { return a * (1 - t) + b * t; }
/// Rec. 709 luminance.
constexpr float luminance(const Color& c) { return 0.2126f * c.r + 0.7152f * c.g + 0.0722f * c.b; }
constexpr float maxComponent(const Color& c) { return std::max(c.r, std::max(c.g, c.b)); }
inline bool isFinite(const Color& c) {
  return std::isfinite(c.r) && std::isfinite(c.g) && std::isfinite(c.b);
}

} // namespace chamfer
