// Lanes of packs of four, one by one: gathered, chosen, summed.
#pragma once

#include "compile/strips.hpp"

#include <dyn/spatial/vector3.hpp>

#include <array>

namespace dyn {

/// The compilers' own vectors, which name no instruction set.
typedef double Four __attribute__((vector_size(32)));  // gcc 12 forgets the attribute of an alias

/// A scalar whose vectors stay where they are, in one lane of the packs that strips have written.
struct Seated {};
template <>
struct Vec3<Seated> {
  const double* first = nullptr;
};
}  // namespace dyn

namespace dyn::kernels {

/// Four numbers from where `index` says. Four loads are sooner done than the processor's own gathering.
template <class S>
S gathered(const double* from, const std::int64_t* index) {
  static_assert(sizeof(Four) == sizeof(S) && strip_lanes == 4);
  return typename S::Batch(Four{from[index[0]], from[index[1]], from[index[2]], from[index[3]]});
}

template <class S>
S sumInAll(const S& a) {
  const auto lanes = static_cast<Four>(a.x);
  const Four halves = lanes + __builtin_shufflevector(lanes, lanes, 2, 3, 0, 1);
  return typename S::Batch(halves + __builtin_shufflevector(halves, halves, 1, 0, 3, 2));
}

/// Struct T as the packs it is made of.
template <class S, class T>
constexpr std::size_t packs_in = sizeof(T) / sizeof(S);
/// Whether one has its place in registers beside all that a joint takes.
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

/// Each lane's numbers of a struct of its own, in a lane of its own: from[l] is the first of them, `stride` apart.
template <class S, class T, std::size_t stride = strip_lanes>
T gatheredLanes(const double* const* from) {
  T out;
  for (std::size_t k = 0; k < packs_in<S, T>; ++k) {
    const std::size_t at = stride * k;
    packsOf<S>(out)[k] = typename S::Batch(Four{from[0][at], from[1][at], from[2][at], from[3][at]});
  }
  return out;
}

/// The numbers of one lane of U's, as T.
template <class T, class S, class U>
T fromLane(const U& x, int lane) {
  T out;
  const double* numbers = reinterpret_cast<const double*>(&x) + lane;
  for (std::size_t k = 0; k < packs_in<S, U>; ++k) reinterpret_cast<double*>(&out)[k] = numbers[strip_lanes * k];
  return out;
}
/// What one lane has, in all.
template <class S, class T>
T inAllLanes(const T& x, int lane) {
  T out;
  const double* numbers = reinterpret_cast<const double*>(&x) + lane;
  for (std::size_t k = 0; k < packs_in<S, T>; ++k) packsOf<S>(out)[k] = S(numbers[strip_lanes * k]);
  return out;
}

/// Those of `bits`.
template <class S>
typename S::Mask lanes(unsigned bits) {
  alignas(64) static constexpr auto masks = [] {
    std::array<double, strip_lanes << strip_lanes> numbers{};
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = (i / strip_lanes) >> (i % strip_lanes) & 1 ? 1.0 : 0.0;
    return numbers;
  }();
  return S::load(masks.data() + strip_lanes * bits) > S(0);
}

}  // namespace dyn::kernels
