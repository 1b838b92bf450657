// Pivots of eliminations: which of them are no more than rounding.
#pragma once

#include <dyn/scalar/select.hpp>

#include <limits>

namespace dyn::kernels {

/// Where a pivot is not above `least`, or not finite, `where` is noted in its lane unless something is there already.
template <class S>
void noteSmall(const S& pivot, const S& least, int where, int* failed) {
  using T = Real<S>;
  if constexpr (is_symbolic<S>) return;
  if (allOf(both(pivot > least, pivot <= S(std::numeric_limits<T>::max())))) return;
  const T *p = reinterpret_cast<const T*>(&pivot), *l = reinterpret_cast<const T*>(&least);
  for (int i = 0; i < lanes_of<S>; ++i)
    if (!(p[i] > l[i] && p[i] <= std::numeric_limits<T>::max()) && failed[i] == 0) failed[i] = where;
}

}  // namespace dyn::kernels
