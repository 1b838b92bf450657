// Factors of the mass matrix of models with couplings, which connect distant joints: M is taken as dense. S: a number, or a pack of states.
#pragma once

#include "compile/compact_impl.hpp"
#include "kernels/pivots.hpp"
#include "kernels/subtree.hpp"

#include <algorithm>
#include <limits>

namespace dyn::kernels {

/// In place, square-root-free from the leaves to the root (Featherstone 2008, ch. 8), the inverses of pivots on the diagonal. `diagonal`: scratch
/// of nv numbers. failed, by lane: the body of a pivot that is of the rounding of its diagonal's size, or not finite.
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

/// x = M^-1 x by these factors.
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
