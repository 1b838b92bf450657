// SPDX-License-Identifier: BSD-2-Clause
// A scalar that records operations. A function that is templated on the scalar and does not branch on values can run once on traced scalars; it then
// leaves its expression graph in the recorder (dyn/codegen/graph.hpp).
#pragma once

#include <dyn/scalar/dual.hpp>
#include <dyn/scalar/select.hpp>

#include <cmath>
#include <cstdint>
#include <type_traits>

namespace dyn {

/// Operations that a recorder knows, on arguments a, b, c and d.
enum class Operation : std::int32_t {
  input,        ///< unknown value, given at evaluation
  constant,     ///< known number
  add,          ///< a + b
  subtract,     ///< a - b
  multiply,     ///< a b
  divide,       ///< a / b
  negate,       ///< -a
  sqrt,         ///< square root of a
  sin,          ///< sine of a [rad]
  cos,          ///< cosine of a [rad]
  tan,          ///< tangent of a [rad]
  exp,          ///< e^a
  log,          ///< natural logarithm of a
  atan2,        ///< angle [rad] of the point with y = a, x = b
  abs,          ///< |a|
  select_less,  ///< a < b ? c : d
};

/// Returns the number of arguments of an operation, 0 to 4.
constexpr int arity(Operation o) {
  switch (o) {
    case Operation::input:
    case Operation::constant:
      return 0;
    case Operation::add:
    case Operation::subtract:
    case Operation::multiply:
    case Operation::divide:
    case Operation::atan2:
      return 2;
    case Operation::select_less:
      return 4;
    default:
      return 1;
  }
}

class Recorder;

/// A known number, or the unknown value of a node in a recorder's graph.
struct Traced {
  Recorder* recorder = nullptr;  ///< null for a known number
  double value = 0;              ///< value of a known number
  std::uint32_t node = 0;        ///< recorder's node of an unknown value

  Traced() = default;  ///< Makes the known number 0.
  /// Makes a known number.
  template <class A>
    requires std::is_arithmetic_v<A>
  Traced(A x) : value(static_cast<double>(x)) {}  // NOLINT: a number is a constant

  /// Records or computes as the operators on two values do.
  /// @{
  Traced& operator+=(const Traced& b);
  Traced& operator-=(const Traced& b);
  Traced& operator*=(const Traced& b);
  Traced& operator/=(const Traced& b);
  /// @}
};

/// Records operations. Plugins call the recorder through this interface, so that they need not link to the library.
class Recorder {
 public:
  /// Records an operation on up to four values, at least one of them unknown, and returns its result.
  virtual Traced record(Operation operation, const Traced& a, const Traced& b, const Traced& c, const Traced& d) noexcept = 0;

 protected:
  ~Recorder() = default;
};

/// Returns a < b ? x : y. Scalars that record operations themselves bring their own overload.
template <class S>
S selectLess(const S& a, const S& b, const S& x, const S& y) {
  return select(a < b, x, y);
}

/// Applies an operation to its arguments value(0), value(1), ... and returns the result. Inputs and constants have no arguments: they give value(0).
template <class Value>
auto applied(Operation operation, const Value& value) {
  using std::sqrt, std::sin, std::cos, std::tan, std::exp, std::log, std::atan2, std::abs;
  using S = std::remove_cvref_t<decltype(value(0))>;
  switch (operation) {
    case Operation::input:
    case Operation::constant:
      break;
    case Operation::add:
      return S(value(0) + value(1));
    case Operation::subtract:
      return S(value(0) - value(1));
    case Operation::multiply:
      return S(value(0) * value(1));
    case Operation::divide:
      return S(value(0) / value(1));
    case Operation::negate:
      return S(-value(0));
    case Operation::sqrt:
      return S(sqrt(value(0)));
    case Operation::sin:
      return S(sin(value(0)));
    case Operation::cos:
      return S(cos(value(0)));
    case Operation::tan:
      return S(tan(value(0)));
    case Operation::exp:
      return S(exp(value(0)));
    case Operation::log:
      return S(log(value(0)));
    case Operation::atan2:
      return S(atan2(value(0), value(1)));
    case Operation::abs:
      return S(abs(value(0)));
    case Operation::select_less:
      return S(selectLess(value(0), value(1), value(2), value(3)));
  }
  return S(value(0));
}

namespace detail {
inline Traced trace(Operation operation, const Traced& a, const Traced& b = 0, const Traced& c = 0, const Traced& d = 0) {
  const Traced& unknown = a.recorder ? a : b.recorder ? b : c.recorder ? c : d;
  if (unknown.recorder) return unknown.recorder->record(operation, a, b, c, d);
  const double known[] = {a.value, b.value, c.value, d.value};
  return applied(operation, [&](int k) { return known[k]; });
}
}  // namespace detail

/// Records an operation and returns its result. Operations on known numbers are computed at once.
/// @{
inline Traced operator+(const Traced& a, const Traced& b) { return detail::trace(Operation::add, a, b); }
inline Traced operator-(const Traced& a, const Traced& b) { return detail::trace(Operation::subtract, a, b); }
inline Traced operator*(const Traced& a, const Traced& b) { return detail::trace(Operation::multiply, a, b); }
inline Traced operator/(const Traced& a, const Traced& b) { return detail::trace(Operation::divide, a, b); }
inline Traced operator-(const Traced& a) { return detail::trace(Operation::negate, a); }
/// @}
inline Traced& Traced::operator+=(const Traced& b) { return *this = *this + b; }
inline Traced& Traced::operator-=(const Traced& b) { return *this = *this - b; }
inline Traced& Traced::operator*=(const Traced& b) { return *this = *this * b; }
inline Traced& Traced::operator/=(const Traced& b) { return *this = *this / b; }
/// Records a function of unknown values and returns the result. Functions of known numbers are computed at once. Angles are in rad.
/// @{
inline Traced sqrt(const Traced& a) { return detail::trace(Operation::sqrt, a); }
inline Traced sin(const Traced& a) { return detail::trace(Operation::sin, a); }
inline Traced cos(const Traced& a) { return detail::trace(Operation::cos, a); }
inline Traced tan(const Traced& a) { return detail::trace(Operation::tan, a); }
inline Traced exp(const Traced& a) { return detail::trace(Operation::exp, a); }
inline Traced log(const Traced& a) { return detail::trace(Operation::log, a); }
inline Traced atan2(const Traced& y, const Traced& x) { return detail::trace(Operation::atan2, y, x); }
inline Traced abs(const Traced& a) { return detail::trace(Operation::abs, a); }
inline void sincos(const Traced& angle, Traced& sine, Traced& cosine) {
  sine = sin(angle);
  cosine = cos(angle);
}
/// @}

/// Result of a comparison. Code cannot branch on it, only pass it to select().
struct TracedCondition {
  Traced a,              ///< left side of a < b
      b;                 ///< right side of a < b
  bool negated = false;  ///< true if the condition is !(a < b)
};
/// Makes a condition. a <= b stands for !(b < a), also where a value is NaN.
/// @{
inline TracedCondition operator<(const Traced& a, const Traced& b) { return {a, b, false}; }
inline TracedCondition operator>(const Traced& a, const Traced& b) { return {b, a, false}; }
inline TracedCondition operator<=(const Traced& a, const Traced& b) { return {b, a, true}; }
inline TracedCondition operator>=(const Traced& a, const Traced& b) { return {a, b, true}; }
inline TracedCondition operator!(const TracedCondition& c) { return {c.a, c.b, !c.negated}; }
/// @}
/// Records x where the condition holds, else y.
inline Traced select(const TracedCondition& c, const Traced& x, const Traced& y) {
  return c.negated ? detail::trace(Operation::select_less, c.a, c.b, y, x) : detail::trace(Operation::select_less, c.a, c.b, x, y);
}
/// Combines conditions. Each selection in the combination is recorded.
/// @{
inline TracedCondition operator&(const TracedCondition& x, const TracedCondition& y) { return {0.5, select(x, select(y, 1, 0), 0)}; }
inline TracedCondition operator|(const TracedCondition& x, const TracedCondition& y) { return {0.5, select(x, 1, select(y, 1, 0))}; }
inline TracedCondition operator==(const Traced& a, const Traced& b) { return (a <= b) & (b <= a); }
inline TracedCondition both(const TracedCondition& x, const TracedCondition& y) { return x & y; }
/// @}
/// While a condition is traced its value is unknown: allOf() is false and anyOf() is true, so the general code must be correct.
/// @{
inline bool allOf(const TracedCondition&) { return false; }
inline bool anyOf(const TracedCondition&) { return true; }
/// @}

/// Traced values are not known yet.
template <>
inline constexpr bool is_symbolic<Traced> = true;

/// Constants in computations with traced scalars are doubles.
template <>
struct RealOf<Traced> {
  using type = double;             ///< number type of constants
  static constexpr int lanes = 1;  ///< numbers side by side
};

}  // namespace dyn
