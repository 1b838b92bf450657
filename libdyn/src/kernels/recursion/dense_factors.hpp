// SPDX-License-Identifier: BSD-2-Clause
// Factors of the mass matrix of models with couplings. A coupling connects distant joints, so M is treated as dense.
#pragma once

#include "compile/compact_impl.hpp"
#include "kernels/order/subtree.hpp"
#include "kernels/pack/pivots.hpp"

#include <algorithm>
#include <limits>

namespace dyn::kernels {

/// Factors M in place, without square roots, from the leaves to the root (Featherstone 2008, ch. 8). The diagonal receives the inverses of the
/// pivots. `diagonal` is scratch of nv numbers. Notes in `failed` a body whose pivot is no larger than the rounding error of its diagonal entry, or
/// is not finite.
template <class S>
void factorDense(const CompactImpl& m, S* M, S* diagonal, int* failed) {
  const std::ptrdiff_t n = m.nv;
  for (std::ptrdiff_t k = 0; k < n; ++k) diagonal[k] = M[k * n + k];
  for (std::ptrdiff_t k = n - 1; k >= 0; --k) {
    S& pivot = M[k * n + k];
    const S least = S(8 * std::numeric_limits<Real<S>>::epsilon()) * diagonal[k];
    noteSmall(pivot, least, m.dof_body[static_cast<std::size_t>(m.v_of_user[static_cast<std::size_t>(k)])], failed);
    pivot = S(1) / pivot;
    for (std::ptrdiff_t i = 0; i < k; ++i) {
      const S l = M[k * n + i] * pivot;
      for (std::ptrdiff_t j = 0; j <= i; ++j) M[i * n + j] -= l * M[k * n + j];
    }
  }
}

/// x = M^-1 x, with these factors.
template <class S>
void solveDense(const CompactImpl& m, const S* factors, S* x) {
  const std::ptrdiff_t n = m.nv;
  for (std::ptrdiff_t k = n - 1; k >= 0; --k) {
    const S share = factors[k * n + k] * x[k];
    for (std::ptrdiff_t i = 0; i < k; ++i) x[i] -= factors[k * n + i] * share;
  }
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    S sum = x[k];
    for (std::ptrdiff_t i = 0; i < k; ++i) sum -= factors[k * n + i] * x[i];
    x[k] = sum * factors[k * n + k];
  }
}

/// M^-1, nv x nv, symmetric to the last bit.
template <class S>
void invertDense(const CompactImpl& m, const S* factors, S* inverse) {
  const std::ptrdiff_t n = m.nv;
  std::fill_n(inverse, n * n, S(0));
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    inverse[(n + 1) * k] = S(1);
    solveDense(m, factors, inverse + n * k);
  }
  mirrorUpper<S>(Rows<S>{inverse, n}, m.nv);
}

}  // namespace dyn::kernels
