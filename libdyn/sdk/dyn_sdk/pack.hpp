// SPDX-License-Identifier: BSD-2-Clause
// Packs: as many numbers as the processor works on at once, with the arithmetic of a single number. This is the only installed header that names a
// SIMD library. Without xsimd there are no packs, and everything is computed number by number.
//
// A pack type belongs to the instruction set that the source file is compiled for, and never crosses a boundary. Functions pass arrays of numbers
// instead, from which each side loads its own packs.
#pragma once

#include <dyn/scalar/select.hpp>

#include <cmath>
#include <cstddef>
#include <type_traits>

#if __has_include(<xsimd/xsimd.hpp>)
#define DYN_HAS_PACKS 1
#include <xsimd/xsimd.hpp>

namespace dyn {

/// Result of comparing packs: a condition for each lane.
template <class T, class Arch>
struct PackMask {
  xsimd::batch_bool<T, Arch> x;  ///< xsimd's mask
  /// Combine the conditions of each lane.
  /// @{
  friend PackMask operator&(const PackMask& a, const PackMask& b) { return {a.x & b.x}; }
  friend PackMask operator|(const PackMask& a, const PackMask& b) { return {a.x | b.x}; }
  friend PackMask operator!(const PackMask& a) { return {~a.x}; }
  friend PackMask both(const PackMask& a, const PackMask& b) { return a & b; }
  /// @}
  /// Return whether all lanes, or any, fulfil the condition.
  /// @{
  friend bool allOf(const PackMask& a) { return xsimd::all(a.x); }
  friend bool anyOf(const PackMask& a) { return xsimd::any(a.x); }
  /// @}
};

/// As many numbers T as a register of the instruction set Arch holds. Functions work lane by lane.
template <class T, class Arch = xsimd::default_arch>
struct Pack {
  using Batch = xsimd::batch<T, Arch>;                         ///< xsimd's pack
  using Mask = PackMask<T, Arch>;                              ///< result of comparisons
  static constexpr int lanes = static_cast<int>(Batch::size);  ///< how many numbers there are

  /// The compiler's own vector type. A store through it can change numbers of type T only. A store through xsimd's intrinsics may alias any object,
  /// so the compiler would have to read pointers and indices again after it.
  typedef T Native __attribute__((vector_size(sizeof(T) * static_cast<std::size_t>(lanes))));
  /// The same at any address of a T.
  typedef T Anywhere __attribute__((vector_size(sizeof(T) * static_cast<std::size_t>(lanes)), aligned(alignof(T))));

  Native x;  ///< the numbers

  /// Like a plain number, a pack is uninitialised unless written as Pack{}, which is zero.
  Pack() = default;
  /// Copies register by register. Trivial copies would move structs of packs as bytes, in blocks of other sizes than they were written in, which
  /// stalls the core; and the compiler would lose track of their contents.
  /// @{
  Pack(const Pack& other) : x(other.x) {}
  Pack& operator=(const Pack& other) {
    x = other.x;
    return *this;
  }
  /// @}
  /// Takes over numbers, or repeats one in all lanes.
  /// @{
  Pack(const Native& numbers) : x(numbers) {}      // NOLINT
  Pack(const Batch& numbers) : x(numbers.data) {}  // NOLINT
  template <class A>
    requires std::is_arithmetic_v<A>
  Pack(A s) : Pack(Batch(static_cast<T>(s))) {}  // NOLINT: a number is a constant pack
  /// @}
  Batch batch() const { return Batch(x); }  ///< as xsimd's pack

  /// Reads `lanes` numbers from any address of a T.
  static Pack load(const T* from) {
    const Native numbers = *reinterpret_cast<const Anywhere*>(from);  // a copy, since clang takes the cast for the misaligned numbers themselves
    return numbers;
  }
  /// Writes `lanes` numbers to any address of a T.
  void store(T* to) const { *reinterpret_cast<Anywhere*>(to) = x; }
  /// Return the address of the first lane.
  /// @{
  const T* begin() const { return reinterpret_cast<const T*>(this); }
  T* begin() { return reinterpret_cast<T*>(this); }

  /// @}
  /// Arithmetic, lane by lane.
  /// @{
  friend Pack operator+(const Pack& a, const Pack& b) { return Native(a.x + b.x); }
  friend Pack operator-(const Pack& a, const Pack& b) { return Native(a.x - b.x); }
  friend Pack operator-(const Pack& a) { return Native(-a.x); }
  friend Pack operator*(const Pack& a, const Pack& b) { return Native(a.x * b.x); }
  friend Pack operator/(const Pack& a, const Pack& b) { return Native(a.x / b.x); }
  Pack& operator+=(const Pack& b) { return *this = *this + b; }
  Pack& operator-=(const Pack& b) { return *this = *this - b; }
  Pack& operator*=(const Pack& b) { return *this = *this * b; }
  Pack& operator/=(const Pack& b) { return *this = *this / b; }

  /// @}
  /// Compare lane by lane.
  /// @{
  friend Mask operator<(const Pack& a, const Pack& b) { return {a.batch() < b.batch()}; }
  friend Mask operator>(const Pack& a, const Pack& b) { return {a.batch() > b.batch()}; }
  friend Mask operator==(const Pack& a, const Pack& b) { return {a.batch() == b.batch()}; }
  friend Mask operator<=(const Pack& a, const Pack& b) { return {a.batch() <= b.batch()}; }
  friend Mask operator>=(const Pack& a, const Pack& b) { return {a.batch() >= b.batch()}; }

  /// @}
  /// Return the square root or the absolute value of each lane.
  /// @{
  friend Pack sqrt(const Pack& a) { return xsimd::sqrt(a.batch()); }
  friend Pack abs(const Pack& a) { return xsimd::abs(a.batch()); }
  /// @}
  /// Return a function of each lane, which the C library computes number by number. Angles are in rad.
  /// @{
  friend Pack tan(const Pack& a) {
    return each([](T lane) { return std::tan(lane); }, a);
  }
  friend Pack exp(const Pack& a) {
    return each([](T lane) { return std::exp(lane); }, a);
  }
  friend Pack log(const Pack& a) {
    return each([](T lane) { return std::log(lane); }, a);
  }
  friend Pack atan2(const Pack& sine, const Pack& cosine) {
    return each([](T b, T a) { return std::atan2(b, a); }, sine, cosine);
  }
  /// @}
  /// Returns a where the condition holds, else b.
  friend Pack select(const Mask& condition, const Pack& a, const Pack& b) { return xsimd::select(condition.x, a.batch(), b.batch()); }

 private:
  template <class Function, class... Packs>
  static Pack each(const Function& function, const Packs&... packs) {
    Pack out;
    for (int k = 0; k < lanes; ++k) out.begin()[k] = function(packs.begin()[k]...);
    return out;
  }
};

/// The number type of packs.
template <class T, class Arch>
struct RealOf<Pack<T, Arch>> {
  using type = T;                                     ///< the type of a lane
  static constexpr int lanes = Pack<T, Arch>::lanes;  ///< the number of lanes
};

/// A pack of `lanes` lanes, if the instruction set has registers of that size.
template <class T, int lanes>
using SizedPack = Pack<T, typename xsimd::make_sized_batch_t<T, static_cast<std::size_t>(lanes)>::arch_type>;
inline constexpr std::size_t narrowest_pack = 16;  ///< size in bytes of the narrowest packs that are used

}  // namespace dyn

#include <dyn_sdk/sincos.hpp>

#else
#define DYN_HAS_PACKS 0
#endif
