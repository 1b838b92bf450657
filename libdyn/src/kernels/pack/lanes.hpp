// SPDX-License-Identifier: BSD-2-Clause
// Single lanes of packs of four: gathers, selections and sums.
#pragma once

#include "compile/lane_groups.hpp"

#include <dyn/spatial/vector3.hpp>

#include <array>

namespace dyn {

/// The compilers' own vector type, which names no instruction set.
typedef double Vec4d __attribute__((vector_size(32)));  // gcc 12 forgets the attribute of an alias

/// A scalar type whose Vec3 refers to numbers in place: in one lane of the packs that lane groups have written.
struct InOneLane {};
template <>
struct Vec3<InOneLane> {
  const double* first = nullptr;
};
}  // namespace dyn

namespace dyn::kernels {

/// Loads four numbers, from[index[0]] to from[index[3]]. Four loads are faster than the processor's gather instruction.
template <class S>
S gathered(const double* from, const std::int64_t* index) {
  static_assert(sizeof(Vec4d) == sizeof(S) && group_lanes == 4);
  return typename S::Batch(Vec4d{from[index[0]], from[index[1]], from[index[2]], from[index[3]]});
}

template <class S>
S sumInAll(const S& a) {
  const auto lanes = static_cast<Vec4d>(a.x);
  const Vec4d halves = lanes + __builtin_shufflevector(lanes, lanes, 2, 3, 0, 1);
  return typename S::Batch(halves + __builtin_shufflevector(halves, halves, 1, 0, 3, 2));
}

/// The number of packs S that a struct T consists of.
template <class S, class T>
constexpr std::size_t packs_in = sizeof(T) / sizeof(S);
/// Whether a T fits into registers together with everything that a joint needs.
template <class S, class T>
constexpr bool fits_registers = packs_in<S, T> <= 6;
template <class S, class T>
S* packsOf(T& x) {
  return reinterpret_cast<S*>(&x);
}
template <class S, class T>
const S* packsOf(const T& x) {
  return reinterpret_cast<const S*>(&x);
}

/// Gathers a struct for each lane. from[l] points at the first number for lane l; its numbers lie `stride` apart.
template <class S, class T, std::size_t stride = group_lanes>
T gatheredLanes(const double* const* from) {
  T out;
  for (std::size_t k = 0; k < packs_in<S, T>; ++k) {
    const std::size_t at = stride * k;
    packsOf<S>(out)[k] = typename S::Batch(Vec4d{from[0][at], from[1][at], from[2][at], from[3][at]});
  }
  return out;
}

/// The numbers in one lane of x, as a T.
template <class T, class S, class U>
T fromLane(const U& x, int lane) {
  T out;
  const double* numbers = reinterpret_cast<const double*>(&x) + lane;
  for (std::size_t k = 0; k < packs_in<S, U>; ++k) reinterpret_cast<double*>(&out)[k] = numbers[group_lanes * k];
  return out;
}
/// Copies the numbers in one lane of x to all lanes.
template <class S, class T>
T inAllLanes(const T& x, int lane) {
  T out;
  const double* numbers = reinterpret_cast<const double*>(&x) + lane;
  for (std::size_t k = 0; k < packs_in<S, T>; ++k) packsOf<S>(out)[k] = S(numbers[group_lanes * k]);
  return out;
}

/// The mask of the lanes whose bits are set in `bits`.
template <class S>
typename S::Mask lanes(unsigned bits) {
  alignas(64) static constexpr auto masks = [] {
    std::array<double, group_lanes << group_lanes> numbers{};
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = (i / group_lanes) >> (i % group_lanes) & 1 ? 1.0 : 0.0;
    return numbers;
  }();
  return S::load(masks.data() + group_lanes * bits) > S(0);
}

}  // namespace dyn::kernels
