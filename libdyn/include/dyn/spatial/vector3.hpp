// SPDX-License-Identifier: BSD-2-Clause
// Three-vectors and 3x3 matrices as plain arrays of scalars. Their layout depends on the scalar alone, so they may cross the boundary of the library
// or of a plugin, whatever flags each side was compiled with.
#pragma once

#include <cmath>

namespace dyn {

/// Vector of three numbers, zero by default.
template <class S>
struct Vec3 {
  /// Components.
  /// @{
  S x{}, y{}, z{};
  /// @}

  /// Returns component i, which is 0, 1 or 2. The index is not checked.
  /// @{
  S& operator[](int i) { return (&x)[i]; }
  const S& operator[](int i) const { return (&x)[i]; }
  /// @}

  /// Computes sums, differences and multiples, component by component.
  /// @{
  friend Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  friend Vec3 operator*(const S& s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
  Vec3& operator+=(const Vec3& b) { return *this = *this + b; }
  Vec3& operator-=(const Vec3& b) { return *this = *this - b; }
  /// @}
};

/// Returns the scalar product a . b.
template <class S>
S dot(const Vec3<S>& a, const Vec3<S>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// Returns the vector product a x b.
template <class S>
Vec3<S> cross(const Vec3<S>& a, const Vec3<S>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// General 3 x 3 matrix, zero by default.
template <class S>
struct Mat3 {
  S m[9]{};  ///< entries, row after row

  /// Returns the unit matrix.
  static Mat3 identity() { return {{S(1), S(0), S(0), S(0), S(1), S(0), S(0), S(0), S(1)}}; }

  /// Returns the entry at row r and column c, a column, or a row. Indices start at 0 and are not checked.
  /// @{
  S& operator()(int r, int c) { return m[3 * r + c]; }
  const S& operator()(int r, int c) const { return m[3 * r + c]; }
  Vec3<S> col(int c) const { return {m[c], m[3 + c], m[6 + c]}; }
  Vec3<S> row(int r) const { return {m[3 * r], m[3 * r + 1], m[3 * r + 2]}; }
  /// @}

  /// Computes products with vectors and matrices, and entry by entry sums, differences and multiples.
  /// @{
  friend Vec3<S> operator*(const Mat3& a, const Vec3<S>& b) {
    return {a.m[0] * b.x + a.m[1] * b.y + a.m[2] * b.z, a.m[3] * b.x + a.m[4] * b.y + a.m[5] * b.z, a.m[6] * b.x + a.m[7] * b.y + a.m[8] * b.z};
  }
  friend Mat3 operator*(const Mat3& a, const Mat3& b) {
    Mat3 c;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) c(i, j) = a(i, 0) * b(0, j) + a(i, 1) * b(1, j) + a(i, 2) * b(2, j);
    return c;
  }
  friend Mat3 operator+(const Mat3& a, const Mat3& b) {
    Mat3 c;
    for (int i = 0; i < 9; ++i) c.m[i] = a.m[i] + b.m[i];
    return c;
  }
  Mat3& operator+=(const Mat3& b) { return *this = *this + b; }
  friend Mat3 operator-(const Mat3& a, const Mat3& b) {
    Mat3 c;
    for (int i = 0; i < 9; ++i) c.m[i] = a.m[i] - b.m[i];
    return c;
  }
  friend Mat3 operator*(const S& s, const Mat3& a) {
    Mat3 c;
    for (int i = 0; i < 9; ++i) c.m[i] = s * a.m[i];
    return c;
  }
  /// @}
};

/// Returns a^T.
template <class S>
Mat3<S> transpose(const Mat3<S>& a) {
  return {{a.m[0], a.m[3], a.m[6], a.m[1], a.m[4], a.m[7], a.m[2], a.m[5], a.m[8]}};
}

/// Returns a^T b, without forming the transpose.
template <class S>
Vec3<S> transposeTimes(const Mat3<S>& a, const Vec3<S>& b) {
  return {a.m[0] * b.x + a.m[3] * b.y + a.m[6] * b.z, a.m[1] * b.x + a.m[4] * b.y + a.m[7] * b.z, a.m[2] * b.x + a.m[5] * b.y + a.m[8] * b.z};
}

/// Returns [a], the matrix that maps b to a x b.
template <class S>
Mat3<S> skew(const Vec3<S>& a) {
  return {{S(0), -a.z, a.y, a.z, S(0), -a.x, -a.y, a.x, S(0)}};
}

/// Returns the vector whose skew() is the antisymmetric part of a.
template <class S>
Vec3<S> vee(const Mat3<S>& a) {
  return {S(0.5) * (a.m[7] - a.m[5]), S(0.5) * (a.m[2] - a.m[6]), S(0.5) * (a.m[3] - a.m[1])};
}

/// Symmetric 3 x 3 matrix, stored by its six entries; zero by default.
template <class S>
struct Sym3 {
  /// Entries of the upper triangle.
  /// @{
  S xx{}, xy{}, xz{}, yy{}, yz{}, zz{};
  /// @}

  /// Returns all nine entries.
  Mat3<S> matrix() const { return {{xx, xy, xz, xy, yy, yz, xz, yz, zz}}; }
  /// Returns the symmetric part of a, (a + a^T) / 2.
  static Sym3 of(const Mat3<S>& a) {
    return {a.m[0], S(0.5) * (a.m[1] + a.m[3]), S(0.5) * (a.m[2] + a.m[6]), a.m[4], S(0.5) * (a.m[5] + a.m[7]), a.m[8]};
  }
  /// Computes the product with a vector, and entry by entry sums, differences and multiples.
  /// @{
  friend Vec3<S> operator*(const Sym3& a, const Vec3<S>& b) {
    return {a.xx * b.x + a.xy * b.y + a.xz * b.z, a.xy * b.x + a.yy * b.y + a.yz * b.z, a.xz * b.x + a.yz * b.y + a.zz * b.z};
  }
  friend Sym3 operator+(const Sym3& a, const Sym3& b) { return {a.xx + b.xx, a.xy + b.xy, a.xz + b.xz, a.yy + b.yy, a.yz + b.yz, a.zz + b.zz}; }
  Sym3& operator+=(const Sym3& b) { return *this = *this + b; }
  friend Sym3 operator-(const Sym3& a, const Sym3& b) { return {a.xx - b.xx, a.xy - b.xy, a.xz - b.xz, a.yy - b.yy, a.yz - b.yz, a.zz - b.zz}; }
  friend Sym3 operator*(const S& s, const Sym3& a) { return {s * a.xx, s * a.xy, s * a.xz, s * a.yy, s * a.yz, s * a.zz}; }
  /// @}
};

/// Returns the same numbers in another scalar.
/// @{
template <class To, class From>
Vec3<To> cast(const Vec3<From>& a) {
  return {static_cast<To>(a.x), static_cast<To>(a.y), static_cast<To>(a.z)};
}
template <class To, class From>
Mat3<To> cast(const Mat3<From>& a) {
  Mat3<To> b;
  for (int i = 0; i < 9; ++i) b.m[i] = static_cast<To>(a.m[i]);
  return b;
}
template <class To, class From>
Sym3<To> cast(const Sym3<From>& a) {
  return {static_cast<To>(a.xx), static_cast<To>(a.xy), static_cast<To>(a.xz), static_cast<To>(a.yy), static_cast<To>(a.yz), static_cast<To>(a.zz)};
}
/// @}

/// Returns R a R^T. Computes only the six entries of the symmetric result.
template <class S>
Sym3<S> congruence(const Mat3<S>& R, const Sym3<S>& a) {
  const Vec3<S> u = a * R.row(0), v = a * R.row(1), w = a * R.row(2);
  return {dot(R.row(0), u), dot(R.row(0), v), dot(R.row(0), w), dot(R.row(1), v), dot(R.row(1), w), dot(R.row(2), w)};
}

/// Returns |c|^2 1 - c c^T, the rotational inertia about the origin of a unit mass at c.
template <class S>
Sym3<S> pointInertia(const Vec3<S>& c) {
  return {c.y * c.y + c.z * c.z, -(c.x * c.y), -(c.x * c.z), c.x * c.x + c.z * c.z, -(c.y * c.z), c.x * c.x + c.y * c.y};
}

}  // namespace dyn
