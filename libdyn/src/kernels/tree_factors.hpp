// The factors of M^-1 = U^T D^-1 U as sweeps over subtrees write them, and the paths from degrees of freedom to the root.
#pragma once

#include "kernels/subtree.hpp"

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

/// Of the degrees of freedom on the path from the root to `dof`, and what else its joint has.
inline int pathLength(const CompactImpl& m, int dof) {
  auto last = static_cast<std::size_t>(dof);
  while (last + 1 < m.dof_body.size() && m.dof_body[last + 1] == m.dof_body[static_cast<std::size_t>(dof)]) ++last;
  return m.dof_depth[last] + 1;
}

/// M = L^T D L with a unit triangular L, whose entries stand where a path to the root leads, and U = -L^-T, whose do so too: entry (k, i) is the
/// force along degree of freedom k that a unit force along i of its subtree leaves, when all below k have given way.
template <class S>
struct TreeFactors {
  Rows<S> U;             ///< row k from its diagonal, which is -1, to the end of its subtree; other entries stay zero
  S* inverse = nullptr;  ///< 1 / D
};

template <class S>
void carve(TreeFactors<S>& c, int n, Arena& arena) {
  arena.take(c.U, n, n);
  arena.take(c.inverse, static_cast<std::size_t>(n));
}

}  // namespace dyn::kernels
