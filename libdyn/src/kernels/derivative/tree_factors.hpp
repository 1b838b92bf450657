// SPDX-License-Identifier: BSD-2-Clause
// The factors of M^-1 = U^T D^-1 U as sweeps over subtrees write them, and the root paths of degrees of freedom.
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

}  // namespace dyn::kernels
