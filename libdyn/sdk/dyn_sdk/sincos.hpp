// Sines and cosines of packs, each right to rounding at every finite angle.
//
// The angle is taken modulo pi / 2 with pi / 2 in parts of so few digits that their multiples are exact (Cody and Waite 1980), and what is
// left is carried in two numbers. Angles too large for that, and those so near a multiple that its digits run out, go to the C library.
#pragma once

#include <dyn/scalar/dual.hpp>
#include <dyn_sdk/pack.hpp>

namespace dyn {

namespace detail {

/// Parts of pi / 2, each but the last so short that n of at most `limit` times it is exact; Taylor coefficients up to what rounding leaves.
template <class T>
struct Trigonometry;

template <>
struct Trigonometry<double> {
  static constexpr double limit = 1e6;                    ///< largest |n|, 20 bits
  static constexpr double least = 0x1p-30;                ///< of what is left of an angle, relative to the digits of the parts
  static constexpr double round = 0x1.8p52;               ///< added and taken away: the nearest whole number
  static constexpr double part1 = 0x1.921fb544p+0;        ///< 33 bits
  static constexpr double part2 = 0x1.0b4611a6p-34;       ///< the next 33
  static constexpr double part3 = 0x1.3198a2e037073p-69;  ///< the rest
  static constexpr int terms = 8;
};

template <>
struct Trigonometry<float> {
  static constexpr float limit = 4000;  // 12 bits
  static constexpr float least = 0x1p-11F;
  static constexpr float round = 0x1.8p23F;
  static constexpr float part1 = 0x1.92p+0F;
  static constexpr float part2 = 0x1.fb4p-12F;
  static constexpr float part3 = 0x1.4442d2p-24F;
  static constexpr int terms = 5;
};

/// By the C library, in the lanes whose angle n pi / 2 + r is too large, or too near n pi / 2.
template <class T, class Arch>
[[gnu::noinline, gnu::cold]] void sincosBeyond(const Pack<T, Arch>& angle, const Pack<T, Arch>& n, const Pack<T, Arch>& r, Pack<T, Arch>& sine,
                                               Pack<T, Arch>& cosine) {
  using K = Trigonometry<T>;
  for (int i = 0; i < Pack<T, Arch>::lanes; ++i) {
    const T t = angle.begin()[i], m = n.begin()[i], left = r.begin()[i];
    if (std::fabs(m) < K::limit && (std::fabs(left) > K::least || m == 0)) continue;
    dyn::sincos(t, sine.begin()[i], cosine.begin()[i]);
  }
}

}  // namespace detail

// Inlined, since what it computes of one pack waits for itself most of the time: the next pack's begins meanwhile.
template <class T, class Arch>
[[gnu::always_inline]] inline void sincos(const Pack<T, Arch>& angle, Pack<T, Arch>& sine, Pack<T, Arch>& cosine) {
  using P = Pack<T, Arch>;
  using K = detail::Trigonometry<T>;
  const P n = (angle * P(T(0.63661977236758134308)) + P(K::round)) - P(K::round);
  // angle = n pi / 2 + r + e: the subtraction of each part is exact or its error is kept.
  const P a = angle - n * P(K::part1), b = n * P(K::part2);
  const P r0 = a - b;
  const P e0 = ((a - r0) - b) - n * P(K::part3);
  const P r = r0 + e0, e = (r0 - r) + e0;
  // What follows the leading terms needs r to few digits only, and these are ready sooner.
  const P early = r0 - n * P(K::part3), z = early * early, zz = z * z;

  // sin(r + e) = r + (r^3 (-1/3! + z/5! - ...) + e cos r), cos(r + e) = 1 - r^2/2 + (z^2 (1/4! - ...) - r e).
  T factorial = 1;
  T sine_terms[K::terms], cosine_terms[K::terms];
  for (int k = 0; k < K::terms; ++k) {
    factorial *= static_cast<T>((2 * k + 1) * (2 * k + 2));
    cosine_terms[k] = (k % 2 == 0 ? T(-1) : T(1)) / factorial;
    sine_terms[k] = cosine_terms[k] / static_cast<T>(2 * k + 3);
  }
  P s(sine_terms[K::terms - 1]), c(cosine_terms[K::terms - 1]);
  for (int k = K::terms - 2; k >= 0; --k) s = s * z + P(sine_terms[k]);
  for (int k = K::terms - 2; k >= 1; --k) c = c * z + P(cosine_terms[k]);
  const P half = P(T(0.5)) * (r * r), top = P(T(1)) - half;
  const P sin_r = r + (r * z * s + e * top);
  const P cos_r = top + (((P(T(1)) - top) - half) + (zz * c - r * e));

  // n modulo 4 says which of the two, with which sign.
  const P quarter = n - P(T(4)) * ((n * P(T(0.25)) - P(T(0.375)) + P(K::round)) - P(K::round));
  const auto odd = abs(quarter - P(T(2))) == P(T(1));
  const P s_ = select(odd, cos_r, sin_r), c_ = select(odd, sin_r, cos_r);
  sine = select(quarter >= P(T(1.5)), -s_, s_);
  cosine = select(abs(quarter - P(T(1.5))) < P(T(1)), -c_, c_);

  const auto beyond = !((abs(n) < P(K::limit)) & ((abs(r) > P(K::least)) | (abs(n) < P(T(0.5)))));
  if (anyOf(beyond)) detail::sincosBeyond(angle, n, r, sine, cosine);
}

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

}  // namespace dyn
