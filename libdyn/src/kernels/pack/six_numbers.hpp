// SPDX-License-Identifier: BSD-2-Clause
// Forces as six consecutive numbers.
#pragma once

#include "kernels/pack/columns.hpp"
#include "kernels/pack/vectored.hpp"

namespace dyn::kernels {

/// Writes six numbers, linear part first.
template <class S>
void putSix(const Force<S>& f, S* to) {
  for (int k = 0; k < 3; ++k) {
    to[k] = f.linear[k];
    to[3 + k] = f.angular[k];
  }
}
inline void putSix(const Force<Vectored>& f, Vectored* to) {
  const auto put = [&](const Vec4d& numbers, int at) { *reinterpret_cast<Square<double, 4>::Unaligned*>(to + at) = numbers; };
  put(f.linear.a, 0);
  put(__builtin_shufflevector(f.linear.a, f.angular.a, 2, 4, 5, 6), 2);
}

}  // namespace dyn::kernels
