// SPDX-License-Identifier: BSD-2-Clause
// Forward-mode differentiation: a value and its derivative in one direction. Duals nest, so Dual<Dual<double>> has second derivatives.
#pragma once

#include <dyn/scalar/select.hpp>

#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace dyn {

/// Computes sine and cosine of an angle [rad] together. For packs and duals this costs hardly more than one of the two.
template <class S>
void sincos(const S& angle, S& sine, S& cosine) {
  using std::cos, std::sin;
  sine = sin(angle);
  cosine = cos(angle);
}
/// Computes sine and cosine of a plain number [rad]. Where |angle| >= 1e5 a wider type is used: the C library's own reduction modulo pi / 2
/// leaves errors of up to 15 u next to some multiples.
template <std::floating_point T>
void sincos(const T& angle, T& sine, T& cosine) {
  using Wide = std::conditional_t<std::is_same_v<T, float>, double, long double>;
  if (std::fabs(angle) < T(1e5)) {
    sine = std::sin(angle);
    cosine = std::cos(angle);
  } else {
    sine = static_cast<T>(std::sin(static_cast<Wide>(angle)));
    cosine = static_cast<T>(std::cos(static_cast<Wide>(angle)));
  }
}

/// A value with its derivative in one direction.
template <class T>
struct Dual {
  T v{},    ///< value
      d{};  ///< derivative

  Dual() = default;
  /// Takes a value and its derivative. A number alone is a constant, whose derivative is zero.
  /// @{
  Dual(const T& value) : v(value) {}  // NOLINT: a number is a constant dual
  Dual(const T& value, const T& derivative) : v(value), d(derivative) {}
  template <class A>
    requires(std::is_arithmetic_v<A> && !std::is_same_v<A, T>)
  Dual(A value) : v(static_cast<T>(value)) {}  // NOLINT
  /// @}

  /// Computes sums, differences, products and quotients with their derivatives.
  /// @{
  friend Dual operator+(const Dual& a, const Dual& b) { return {a.v + b.v, a.d + b.d}; }
  friend Dual operator-(const Dual& a, const Dual& b) { return {a.v - b.v, a.d - b.d}; }
  friend Dual operator-(const Dual& a) { return {-a.v, -a.d}; }
  friend Dual operator*(const Dual& a, const Dual& b) { return {a.v * b.v, a.v * b.d + a.d * b.v}; }
  friend Dual operator/(const Dual& a, const Dual& b) {
    const T q = a.v / b.v;
    return {q, (a.d - q * b.d) / b.v};
  }
  Dual& operator+=(const Dual& b) { return *this = *this + b; }
  Dual& operator-=(const Dual& b) { return *this = *this - b; }
  Dual& operator*=(const Dual& b) { return *this = *this * b; }
  Dual& operator/=(const Dual& b) { return *this = *this / b; }
  /// @}

  /// Compares the values alone. For packs the result is a mask.
  /// @{
  friend auto operator<(const Dual& a, const Dual& b) { return a.v < b.v; }
  friend auto operator>(const Dual& a, const Dual& b) { return a.v > b.v; }
  friend auto operator<=(const Dual& a, const Dual& b) { return a.v <= b.v; }
  friend auto operator>=(const Dual& a, const Dual& b) { return a.v >= b.v; }
  friend auto operator==(const Dual& a, const Dual& b) { return a.v == b.v; }
  /// @}
  /// Returns a or b, value and derivative, for each number of a pack separately.
  template <class Mask>
    requires(!std::is_same_v<Mask, bool>)
  friend Dual select(const Mask& condition, const Dual& a, const Dual& b) {
    return {select(condition, a.v, b.v), select(condition, a.d, b.d)};
  }

  /// Computes the function and its derivative. Angles are in rad. The derivative of |a| at zero is that of a.
  /// @{
  friend Dual sin(const Dual& a) {
    T s, c;
    sincos(a.v, s, c);
    return {s, c * a.d};
  }
  friend Dual cos(const Dual& a) {
    T s, c;
    sincos(a.v, s, c);
    return {c, -(s * a.d)};
  }
  friend Dual tan(const Dual& a) {
    using std::tan;
    const T t = tan(a.v);
    return {t, (T(1) + t * t) * a.d};
  }
  friend Dual sqrt(const Dual& a) {
    using std::sqrt;
    const T r = sqrt(a.v);
    return {r, a.d / (T(2) * r)};
  }
  friend Dual exp(const Dual& a) {
    using std::exp;
    const T e = exp(a.v);
    return {e, e * a.d};
  }
  friend Dual log(const Dual& a) {
    using std::log;
    return {log(a.v), a.d / a.v};
  }
  friend Dual atan2(const Dual& y, const Dual& x) {
    using std::atan2;
    return {atan2(y.v, x.v), (x.v * y.d - y.v * x.d) / (x.v * x.v + y.v * y.v)};
  }
  friend Dual abs(const Dual& a) { return select(a.v < T(0), -a, a); }
  /// @}
};

/// Computes sine and cosine of an angle [rad] with their derivatives.
template <class T>
void sincos(const Dual<T>& angle, Dual<T>& sine, Dual<T>& cosine) {
  T s, c;
  sincos(angle.v, s, c);
  sine = Dual<T>(s, c * angle.d);
  cosine = Dual<T>(c, -(s * angle.d));
}

/// Constants and lanes of a dual are those of its value.
template <class T>
struct RealOf<Dual<T>> {
  using type = Real<T>;                      ///< number type of constants
  static constexpr int lanes = lanes_of<T>;  ///< numbers side by side
};

/// Returns the plain number inside a number or a dual, for decisions that must not be differentiated.
/// @{
inline double valueOf(double x) { return x; }
inline double valueOf(float x) { return static_cast<double>(x); }
inline double valueOf(long double x) { return static_cast<double>(x); }
template <class T>
double valueOf(const Dual<T>& x) {
  return valueOf(x.v);
}
/// @}

}  // namespace dyn
