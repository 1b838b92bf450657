// SPDX-License-Identifier: BSD-2-Clause
// Decisions for one number or for many at once. Packs of numbers bring their own overloads, with a mask as condition.
#pragma once

namespace dyn {

/// Tells whether all numbers or any number of a pack meet a condition. A single number has a single condition, which is returned.
/// @{
inline bool allOf(bool condition) { return condition; }
inline bool anyOf(bool condition) { return condition; }
/// @}
/// Returns the conjunction of two conditions, for each number of a pack separately. Both are evaluated.
inline bool both(bool a, bool b) { return a && b; }

/// Returns condition ? a : b, for each number of a pack separately.
template <class T>
T select(bool condition, const T& a, const T& b) {
  return condition ? a : b;
}

/// The number type of constants in computations with scalars S: S itself, or the type of one lane of a pack.
template <class S>
struct RealOf {
  using type = S;                  ///< number type of constants
  static constexpr int lanes = 1;  ///< numbers that an S holds side by side
};
/// The number type of constants in computations with S (RealOf::type).
template <class S>
using Real = typename RealOf<S>::type;
/// How many numbers an S holds side by side (RealOf::lanes).
template <class S>
inline constexpr int lanes_of = RealOf<S>::lanes;

/// True if values are not known yet, as in tracing. Code with special cases for very large or small numbers then assumes ordinary numbers.
template <class S>
inline constexpr bool is_symbolic = false;

}  // namespace dyn
