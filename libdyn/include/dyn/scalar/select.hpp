// Decisions that hold for one number or for many at once: packs of numbers bring their own overloads, with a mask for the condition.
#pragma once

namespace dyn {

inline bool allOf(bool condition) { return condition; }
inline bool anyOf(bool condition) { return condition; }
inline bool both(bool a, bool b) { return a && b; }

/// condition ? a : b, number by number.
template <class T>
T select(bool condition, const T& a, const T& b) {
  return condition ? a : b;
}

/// The number type that constants have beside scalars S: S itself, or the type of one lane of a pack.
template <class S>
struct RealOf {
  using type = S;
  static constexpr int lanes = 1;
};
template <class S>
using Real = typename RealOf<S>::type;
template <class S>
inline constexpr int lanes_of = RealOf<S>::lanes;

/// Whether values are not known yet: code for numbers of every size then takes those of ordinary size for granted.
template <class S>
inline constexpr bool is_symbolic = false;

}  // namespace dyn
