// SPDX-License-Identifier: BSD-2-Clause
// Sines and cosines of packs, each correct to rounding at every finite angle.
//
// The angle is reduced modulo pi / 2, with pi / 2 split into parts of so few digits that their multiples are exact (Cody and Waite 1980). Two numbers
// hold the remainder. The C library computes angles too large for this, and angles so near a multiple of pi / 2 that the remainder loses digits.
#pragma once

#include <dyn/scalar/dual.hpp>
#include <dyn_sdk/pack.hpp>

#include <array>
#include <cstdint>

namespace dyn {

namespace detail {

/// Constants of the reduction and of the polynomials.
/// Parts of pi / 2: each but the last is so short that its product with an n of at most 20 bits (floats: 12) is exact. A remainder r has all digits
/// if |r| >= least(n). For larger n least(n) exceeds every possible remainder, so this one comparison also detects angles that are too large.
/// Polynomials in z = r^2 for |r| <= pi / 4, lowest coefficient first: sine is (sin r / r - 1) / z, cosine is ((cos r - 1) / z + 1/2) / z. They come
/// from Remez' algorithm, with each coefficient rounded before the next ones are found. Their error is a thirtieth of a rounding in sin r / r, and
/// less in cos r.
template <class T>
struct Trigonometry;

template <>
struct Trigonometry<double> {
  static constexpr double round = 0x1.8p52;               ///< adding and subtracting it rounds to the nearest whole number
  static constexpr double part1 = 0x1.921fb544p+0;        ///< 33 bits
  static constexpr double part2 = 0x1.0b4611a6p-34;       ///< the next 33
  static constexpr double part3 = 0x1.3198a2e037073p-69;  ///< the rest
  template <class S>
  static S least(const S& n) {
    return n * (n * S(0x1p-40));
  }
  static constexpr std::array sine{-0x1.5555555555549p-3, 0x1.111111110f8a6p-7,   -0x1.a01a019c16198p-13,
                                   0x1.71de357b1b3e2p-19, -0x1.ae5e689e2ae1bp-26, 0x1.5d93a42040921p-33};
  static constexpr std::array cosine{0x1.555555555554cp-5,   -0x1.6c16c16c1521fp-10, 0x1.a01a019cbf62ap-16,
                                     -0x1.27e4f812b6826p-22, 0x1.1ee9f152a65bfp-29,  -0x1.8fb1310a37000p-37};
};

template <>
struct Trigonometry<float> {
  static constexpr float round = 0x1.8p23F;
  static constexpr float part1 = 0x1.92p+0F;
  static constexpr float part2 = 0x1.fb4p-12F;
  static constexpr float part3 = 0x1.4442d2p-24F;
  template <class S>
  static S least(const S& n) {
    using std::abs;
    return abs(n) * S(0x1p-12F);
  }
  static constexpr std::array sine{-0x1.555546p-3F, 0x1.11077ep-7F, -0x1.9956b6p-13F};
  static constexpr std::array cosine{0x1.55554ap-5F, -0x1.6c0c1ap-10F, 0x1.99e0eep-16F};
};

template <class T, class Arch>
struct SineAndCosine {
  Pack<T, Arch> sine, cosine;
};
/// Replaces x by the C library's results in the lanes whose angle is not n pi / 2 + r to rounding. Arguments are passed by value, so that the
/// caller's variables stay in registers.
template <class T, class Arch>
[[gnu::noinline, gnu::cold]] SineAndCosine<T, Arch> sincosBeyond(Pack<T, Arch> angle, Pack<T, Arch> n, Pack<T, Arch> r, SineAndCosine<T, Arch> x) {
  for (int i = 0; i < Pack<T, Arch>::lanes; ++i)
    if (!(std::fabs(r.begin()[i]) >= Trigonometry<T>::least(n.begin()[i]))) dyn::sincos(angle.begin()[i], x.sine.begin()[i], x.cosine.begin()[i]);
  return x;
}

/// Evaluates a polynomial by Estrin's scheme: pairs of coefficients, which do not depend on each other, form a polynomial in zz = z^2.
template <class P, class T, std::size_t n>
[[gnu::always_inline]] inline P polynomial(const std::array<T, n>& coefficients, const P& z, const P& zz) {
  const auto pair = [&](std::size_t k) { return k + 1 < n ? P(coefficients[k + 1]) * z + P(coefficients[k]) : P(coefficients[k]); };
  std::size_t k = (n - 1) / 2 * 2;
  P sum = pair(k);
  for (; k > 0; k -= 2) sum = sum * zz + pair(k - 2);
  return sum;
}

/// Turns the angle by n quarter turns, where n is in the last bits of `whole`. It works on bits, in the compiler's own vectors, since comparisons of
/// numbers would occupy units that multiplications wait for.
template <class T, class Arch>
[[gnu::always_inline]] inline void turnByQuarters(const Pack<T, Arch>& whole, Pack<T, Arch>& sine, Pack<T, Arch>& cosine) {
  using Whole = std::conditional_t<sizeof(T) == 8, std::int64_t, std::int32_t>;
  typedef Whole Bits __attribute__((vector_size(sizeof(Pack<T, Arch>))));
  constexpr int sign_from_second = 8 * sizeof(T) - 2;
  const auto bits = [](const Pack<T, Arch>& x) { return (Bits)x.x; };
  const auto numbers = [](const Bits& x) -> Pack<T, Arch> { return (typename Pack<T, Arch>::Native)x; };
  const Bits n = bits(whole), s = bits(sine), c = bits(cosine);
  const Bits exchanged = (s ^ c) & -(n & 1);
  sine = numbers(s ^ exchanged ^ ((n & 2) << sign_from_second));
  cosine = numbers(c ^ exchanged ^ (((n + 1) & 2) << sign_from_second));
}

}  // namespace detail

/// Computes sine and cosine, each correct to rounding at every finite angle [rad]. The function is always inlined: one pack's computation is mostly a
/// chain of dependent operations, and the next pack's can begin meanwhile.
template <class T, class Arch>
[[gnu::always_inline]] inline void sincos(const Pack<T, Arch>& angle, Pack<T, Arch>& sine, Pack<T, Arch>& cosine) {
  using P = Pack<T, Arch>;
  using K = detail::Trigonometry<T>;
  const P whole = angle * P(T(0.63661977236758134308)) + P(K::round), n = whole - P(K::round);
  // angle = n pi / 2 + r + e. The subtraction of each part is exact, or e takes its error.
  const P a = angle - n * P(K::part1), b = n * P(K::part2);
  const P r0 = a - b;
  const P e0 = ((a - r0) - b) - n * P(K::part3);
  const P r = r0 + e0, e = (r0 - r) + e0;
  // The terms after the leading ones need only the first digits of r, which are ready sooner.
  const P early = r0 - n * P(K::part3), z = early * early, zz = z * z;
  const P s = detail::polynomial(K::sine, z, zz), c = detail::polynomial(K::cosine, z, zz);

  // sin(r + e) = r + (r z s + e cos r), cos(r + e) = 1 - r^2/2 + (z^2 c - r e).
  const P half = P(T(0.5)) * (r * r), top = P(T(1)) - half;
  sine = r + (r * z * s + e * top);
  cosine = top + (((P(T(1)) - top) - half) + (zz * c - r * e));
  detail::turnByQuarters(whole, sine, cosine);

  if (allOf(abs(r) >= K::least(n))) return;
  const auto right = detail::sincosBeyond<T, Arch>(angle, n, r, {sine, cosine});
  sine = right.sine;
  cosine = right.cosine;
}

/// Return the sine and the cosine, from sincos().
/// @{
template <class T, class Arch>
Pack<T, Arch> sin(const Pack<T, Arch>& angle) {
  Pack<T, Arch> s, c;
  sincos(angle, s, c);
  return s;
}
template <class T, class Arch>
Pack<T, Arch> cos(const Pack<T, Arch>& angle) {
  Pack<T, Arch> s, c;
  sincos(angle, s, c);
  return c;
}
/// @}

}  // namespace dyn
