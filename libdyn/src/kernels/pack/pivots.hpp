// SPDX-License-Identifier: BSD-2-Clause
// Detects elimination pivots that are no larger than rounding errors.
#pragma once

#include <dyn/scalar/select.hpp>

#include <limits>

namespace dyn::kernels {

/// Sets failed[lane] = where in each lane where the pivot is not above `least` or not finite. An earlier entry stays.
template <class S>
void noteSmall(const S& pivot, const S& least, int where, int* failed) {
  using T = Real<S>;
  if constexpr (is_symbolic<S>) return;
  if (allOf(both(pivot > least, pivot <= S(std::numeric_limits<T>::max())))) return;
  const T *p = reinterpret_cast<const T*>(&pivot), *l = reinterpret_cast<const T*>(&least);
  for (int i = 0; i < lanes_of<S>; ++i)
    if (!(p[i] > l[i] && p[i] <= std::numeric_limits<T>::max()) && failed[i] == 0) failed[i] = where;
}

/// Notes `where` if a pivot is not above the rounding errors of the subtractions that gave it. `inertia` is the inertia left in this and other
/// directions of the same body, so the bound scales with the model's units.
template <class S>
void noteVanishing(const S& pivot, const S& inertia, int where, int* failed) {
  noteSmall(pivot, S(4 * std::numeric_limits<Real<S>>::epsilon()) * inertia, where, failed);
}

}  // namespace dyn::kernels
