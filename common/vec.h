// Vectors, points and normals. The type picks the transform rule (see transform.h), as in pbrt-v4's
// util/vecmath.h: a Vector3 is a displacement, a Point3 a position, a Normal3 a covector of a surface.
// Conversions between the three are explicit. Geometry is double; storage (Float3) is float32.
#pragma once

#include <cmath>
#include <cstddef>

namespace chamfer {

/// Storage form of a point or a unit normal: 12 bytes, no arithmetic of its own.
struct Float3 {
  float x = 0, y = 0, z = 0;
  bool operator==(const Float3&) const = default;
};

template <class T>
struct Vector3T {
  T x = 0, y = 0, z = 0;
  constexpr Vector3T() = default;
  constexpr Vector3T(T x_, T y_, T z_) : x(x_), y(y_), z(z_) {}
  constexpr explicit Vector3T(const Float3& f) : x(T(f.x)), y(T(f.y)), z(T(f.z)) {}
  template <class U>
  constexpr explicit Vector3T(const Vector3T<U>& v) : x(T(v.x)), y(T(v.y)), z(T(v.z)) {}
  constexpr T operator[](std::size_t i) const { return i == 0 ? x : i == 1 ? y : z; }
  constexpr T& operator[](std::size_t i) { return i == 0 ? x : i == 1 ? y : z; }
  constexpr Vector3T operator+(const Vector3T& o) const { return {x + o.x, y + o.y, z + o.z}; }
  constexpr Vector3T operator-(const Vector3T& o) const { return {x - o.x, y - o.y, z - o.z}; }
  constexpr Vector3T operator-() const { return {-x, -y, -z}; }
  constexpr Vector3T operator*(T s) const { return {x * s, y * s, z * s}; }
  constexpr Vector3T operator/(T s) const { return *this * (T(1) / s); }
  constexpr Vector3T& operator+=(const Vector3T& o) { return *this = *this + o; }
  constexpr Vector3T& operator-=(const Vector3T& o) { return *this = *this - o; }
  constexpr Vector3T& operator*=(T s) { return *this = *this * s; }
  constexpr bool operator==(const Vector3T& o) const { return x == o.x && y == o.y && z == o.z; }
};
template <class T>
constexpr Vector3T<T> operator*(T s, const Vector3T<T>& v) {
  return v * s;
}
template <class T>
constexpr T dot(const Vector3T<T>& a, const Vector3T<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
constexpr Vector3T<T> cross(const Vector3T<T>& a, const Vector3T<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
constexpr T lengthSquared(const Vector3T<T>& v) {
  return dot(v, v);
}
template <class T>
T length(const Vector3T<T>& v) {
  using std::sqrt; // or that of T's own namespace
  return sqrt(dot(v, v));
}
/// Unit vector along `v`; `v` must not be zero (the result is then not finite).
template <class T>
Vector3T<T> normalize(const Vector3T<T>& v) {
  return v * (T(1) / length(v));
}
template <class T>
bool isFinite(const Vector3T<T>& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

template <class T>
struct Point3T {
  T x = 0, y = 0, z = 0;
  constexpr Point3T() = default;
  constexpr Point3T(T x_, T y_, T z_) : x(x_), y(y_), z(z_) {}
  constexpr explicit Point3T(const Float3& f) : x(T(f.x)), y(T(f.y)), z(T(f.z)) {}
  constexpr explicit Point3T(const Vector3T<T>& v) : x(v.x), y(v.y), z(v.z) {}
  template <class U>
  constexpr explicit Point3T(const Point3T<U>& v) : x(T(v.x)), y(T(v.y)), z(T(v.z)) {}
  constexpr explicit operator Vector3T<T>() const { return {x, y, z}; }
  constexpr T operator[](std::size_t i) const { return i == 0 ? x : i == 1 ? y : z; }
  constexpr T& operator[](std::size_t i) { return i == 0 ? x : i == 1 ? y : z; }
  constexpr Point3T operator+(const Vector3T<T>& v) const { return {x + v.x, y + v.y, z + v.z}; }
  constexpr Point3T operator-(const Vector3T<T>& v) const { return {x - v.x, y - v.y, z - v.z}; }
  constexpr Vector3T<T> operator-(const Point3T& o) const { return {x - o.x, y - o.y, z - o.z}; }
  constexpr bool operator==(const Point3T&) const = default;
};
template <class T>
bool isFinite(const Point3T<T>& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

template <class T>
struct Normal3T {
  T x = 0, y = 0, z = 0;
  constexpr Normal3T() = default;
  constexpr Normal3T(T x_, T y_, T z_) : x(x_), y(y_), z(z_) {}
  constexpr explicit Normal3T(const Float3& f) : x(T(f.x)), y(T(f.y)), z(T(f.z)) {}
  constexpr explicit Normal3T(const Vector3T<T>& v) : x(v.x), y(v.y), z(v.z) {}
  constexpr explicit operator Vector3T<T>() const { return {x, y, z}; }
  constexpr Normal3T operator-() const { return {-x, -y, -z}; }
  constexpr bool operator==(const Normal3T&) const = default;
};
template <class T>
constexpr T dot(const Normal3T<T>& n, const Vector3T<T>& v) {
  return n.x * v.x + n.y * v.y + n.z * v.z;
}
template <class T>
constexpr T dot(const Vector3T<T>& v, const Normal3T<T>& n) {
  return dot(n, v);
}

using Vector3 = Vector3T<double>;
using Point3 = Point3T<double>;
using Normal3 = Normal3T<double>;
using Vector3f = Vector3T<float>;

constexpr Float3 toFloat3(const Vector3& v) { return {float(v.x), float(v.y), float(v.z)}; }
constexpr Float3 toFloat3(const Point3& v) { return {float(v.x), float(v.y), float(v.z)}; }

/// A ray, or the line that carries it: points `origin + t * direction`, `t` in units of the direction's
/// length.
struct Ray {
  Point3 origin;
  Vector3 direction;
  constexpr Point3 at(double t) const { return origin + direction * t; }
};

/// Axis-aligned box; empty (lower > upper) when default made.
struct Bounds3 {
  Point3 lower{INFINITY, INFINITY, INFINITY};
  Point3 upper{-INFINITY, -INFINITY, -INFINITY};
  void extend(const Point3& p) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (p[i] < lower[i]) lower[i] = p[i];
      if (p[i] > upper[i]) upper[i] = p[i];
    }
  }
  void extend(const Bounds3& b) {
    extend(b.lower);
    extend(b.upper);
  }
  bool empty() const { return !(lower.x <= upper.x); }
  Point3 centre() const { return lower + (upper - lower) * 0.5; }
  /// Length of the diagonal; 0 when empty.
  double diagonal() const { return empty() ? 0 : length(upper - lower); }
};

} // namespace chamfer
