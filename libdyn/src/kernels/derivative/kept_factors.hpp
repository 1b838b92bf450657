// SPDX-License-Identifier: BSD-2-Clause
// Factors of M^-1 = U^T D^-1 U that are kept between calls, and products with them. S is a number, or a pack of states.
//
// Row k holds 1 / D(k), then U(k, i) for the other degrees of freedom i of k's subtree. The rows follow one another. U(k, k) is -1.
#pragma once

#include "kernels/derivative/tree_factors.hpp"

namespace dyn::kernels {

/// How many numbers S the factors have.
inline std::size_t keptNumbers(const CompactImpl& m) {
  std::size_t count = 0;
  for (int k = 0; k < m.nvx; ++k) count += static_cast<std::size_t>(m.dof_end[static_cast<std::size_t>(k)] - k);
  return count;
}

template <class S>
void keepFactors(const CompactImpl& m, const TreeFactors<S>& factors, S* out) {
  for (int k = 0; k < m.nvx; ++k) {
    const int end = m.dof_end[static_cast<std::size_t>(k)];
    const S* const row = factors.U[k];
    *out++ = factors.inverse[k];
    for (int i = k + 1; i < end; ++i) *out++ = row[i];
  }
}

/// x = M^-1 x. Goes through the rows from first to last, then back. O(n depth).
template <class S>
void solveWithKept(const CompactImpl& m, const S* factors, S* x) {
  for (int k = 0; k < m.nvx; ++k) {
    const int others = m.dof_end[static_cast<std::size_t>(k)] - k - 1;
    const S* const row = factors + 1;
    const S* const below = x + k + 1;
    S sum = -x[k];
    for (int i = 0; i < others; ++i) sum += row[i] * below[i];
    x[k] = sum * factors[0];
    factors += 1 + others;
  }
  for (int k = m.nvx - 1; k >= 0; --k) {
    const int others = m.dof_end[static_cast<std::size_t>(k)] - k - 1;
    factors -= 1 + others;
    const S* const row = factors + 1;
    S* const below = x + k + 1;
    const S projection = x[k];
    for (int i = 0; i < others; ++i) below[i] += row[i] * projection;
    x[k] = -projection;
  }
}

}  // namespace dyn::kernels
