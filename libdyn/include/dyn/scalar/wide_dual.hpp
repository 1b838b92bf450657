// SPDX-License-Identifier: BSD-2-Clause
// Forward-mode differentiation along N directions at once. With replay() (dyn/codegen/graph.hpp) it works for every algorithm that can be traced.
#pragma once

#include <array>
#include <cmath>
#include <type_traits>

namespace dyn {

/// A value with its derivatives along N directions.
template <class T, int N>
struct WideDual {
  T v{};                 ///< value
  std::array<T, N> d{};  ///< derivative of v along each direction

  WideDual() = default;
  /// Makes a constant, whose derivatives are zero.
  template <class A>
    requires std::is_arithmetic_v<A>
  WideDual(A value) : v(static_cast<T>(value)) {}  // NOLINT: a number is a constant

  /// Returns a value with derivative 1 along one direction, 0 to N - 1, and 0 along the others. The direction is not checked.
  static WideDual variable(T value, int direction) {
    WideDual x(value);
    x.d[static_cast<std::size_t>(direction)] = T(1);
    return x;
  }
  /// Returns f(x) by the chain rule, from the value and the slope of f at x, or f(x, y) from both slopes.
  /// @{
  static WideDual chain(const T& value, const T& slope, const WideDual& x) {
    WideDual out;
    out.v = value;
    for (std::size_t k = 0; k < N; ++k) out.d[k] = slope * x.d[k];
    return out;
  }
  static WideDual chain(const T& value, const T& slope_x, const WideDual& x, const T& slope_y, const WideDual& y) {
    WideDual out;
    out.v = value;
    for (std::size_t k = 0; k < N; ++k) out.d[k] = slope_x * x.d[k] + slope_y * y.d[k];
    return out;
  }
  /// @}

  /// Computes sums, differences, products and quotients with their derivatives.
  /// @{
  friend WideDual operator+(const WideDual& a, const WideDual& b) { return chain(a.v + b.v, T(1), a, T(1), b); }
  friend WideDual operator-(const WideDual& a, const WideDual& b) { return chain(a.v - b.v, T(1), a, T(-1), b); }
  friend WideDual operator-(const WideDual& a) { return chain(-a.v, T(-1), a); }
  friend WideDual operator*(const WideDual& a, const WideDual& b) { return chain(a.v * b.v, b.v, a, a.v, b); }
  friend WideDual operator/(const WideDual& a, const WideDual& b) {
    const T q = a.v / b.v, r = T(1) / b.v;
    return chain(q, r, a, -q * r, b);
  }
  WideDual& operator+=(const WideDual& b) { return *this = *this + b; }
  WideDual& operator-=(const WideDual& b) { return *this = *this - b; }
  WideDual& operator*=(const WideDual& b) { return *this = *this * b; }
  WideDual& operator/=(const WideDual& b) { return *this = *this / b; }
  /// @}
  /// Compares the values alone.
  friend bool operator<(const WideDual& a, const WideDual& b) { return a.v < b.v; }

  /// Computes the function and its derivatives. Angles are in rad. The derivatives of |a| at zero are those of a.
  /// @{
  friend WideDual sqrt(const WideDual& a) {
    using std::sqrt;
    const T r = sqrt(a.v);
    return chain(r, T(0.5) / r, a);
  }
  friend WideDual sin(const WideDual& a) {
    using std::cos, std::sin;
    return chain(sin(a.v), cos(a.v), a);
  }
  friend WideDual cos(const WideDual& a) {
    using std::cos, std::sin;
    return chain(cos(a.v), -sin(a.v), a);
  }
  friend WideDual tan(const WideDual& a) {
    using std::tan;
    const T t = tan(a.v);
    return chain(t, T(1) + t * t, a);
  }
  friend WideDual exp(const WideDual& a) {
    using std::exp;
    const T e = exp(a.v);
    return chain(e, e, a);
  }
  friend WideDual log(const WideDual& a) {
    using std::log;
    return chain(log(a.v), T(1) / a.v, a);
  }
  friend WideDual atan2(const WideDual& y, const WideDual& x) {
    using std::atan2;
    const T r = T(1) / (x.v * x.v + y.v * y.v);
    return chain(atan2(y.v, x.v), x.v * r, y, -y.v * r, x);
  }
  friend WideDual abs(const WideDual& a) { return a.v < T(0) ? -a : a; }
  /// @}
};

}  // namespace dyn
