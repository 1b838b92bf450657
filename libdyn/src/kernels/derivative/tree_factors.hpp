// SPDX-License-Identifier: BSD-2-Clause
// The factors of M^-1 = U^T D^-1 U as sweeps over subtrees write them, what is kept of them between calls, and the root paths of degrees of freedom.
#pragma once

#include "kernels/order/subtree.hpp"

namespace dyn::kernels {

/// Calls use(j) for each degree of freedom on the path from `dof` to the root, itself included.
template <class Use>
void alongPath(const CompactImpl& m, int dof, Use&& use) {
  while (dof >= 0) {
    const int begin = m.dof_segment[static_cast<std::size_t>(dof)];
    for (int j = dof; j >= begin; --j) use(j);
    dof = m.dof_parent[static_cast<std::size_t>(begin)];
  }
}

/// The number of degrees of freedom on the path from the root to `dof`, including all of its own joint.
inline int pathLength(const CompactImpl& m, int dof) {
  auto last = static_cast<std::size_t>(dof);
  while (last + 1 < m.dof_body.size() && m.dof_body[last + 1] == m.dof_body[static_cast<std::size_t>(dof)]) ++last;
  return m.dof_depth[last] + 1;
}

/// M = L^T D L with a unit triangular L, and U = -L^-T. Both have entries only for degrees of freedom on one root path. Entry (k, i) of U, for i in
/// the subtree of k, is the projection on k of a unit force along i, after all degrees of freedom below k have been projected out.
template <class S>
struct TreeFactors {
  Rows<S> U;             ///< row k from its diagonal, which is -1, to the end of its subtree; other entries stay zero
  S* inverse = nullptr;  ///< 1 / D
};

template <class S>
void layOut(TreeFactors<S>& c, int n, Arena& arena) {
  arena.take(c.U, n, n);
  arena.take(c.inverse, static_cast<std::size_t>(n));
}

// Factors that are kept between calls: row k holds 1 / D(k), then U(k, i) for the other degrees of freedom i of k's subtree. The rows follow one
// another.

/// How many numbers the kept factors have.
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
