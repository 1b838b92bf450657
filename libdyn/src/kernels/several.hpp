// A few packs as one scalar: recursions whose steps wait for one another go through more columns meanwhile.
#pragma once

#include <dyn/scalar/select.hpp>

namespace dyn {

template <class P, int N>
struct Several {
  using T = Real<P>;
  static constexpr int lanes = N * lanes_of<P>;
  P x[N];

  Several() = default;
  explicit Several(const T& s) {
    const P all(s);
    for (P& p : x) p = all;
  }

  static Several load(const T* from) {
    Several out;
    for (int i = 0; i < N; ++i) out.x[i] = P::load(from + i * lanes_of<P>);
    return out;
  }
  void store(T* to) const {
    for (int i = 0; i < N; ++i) x[i].store(to + i * lanes_of<P>);
  }

  template <class F>
  static Several each(F&& f) {
    Several out;
    for (int i = 0; i < N; ++i) out.x[i] = f(i);
    return out;
  }
  friend Several operator+(const Several& a, const Several& b) {
    return each([&](int i) { return a.x[i] + b.x[i]; });
  }
  friend Several operator-(const Several& a, const Several& b) {
    return each([&](int i) { return a.x[i] - b.x[i]; });
  }
  friend Several operator-(const Several& a) {
    return each([&](int i) { return -a.x[i]; });
  }
  friend Several operator*(const Several& a, const Several& b) {
    return each([&](int i) { return a.x[i] * b.x[i]; });
  }
  Several& operator+=(const Several& b) { return *this = *this + b; }
  Several& operator-=(const Several& b) { return *this = *this - b; }
};

template <class P, int N>
struct RealOf<Several<P, N>> {
  using type = Real<P>;
  static constexpr int lanes = Several<P, N>::lanes;
};

}  // namespace dyn
