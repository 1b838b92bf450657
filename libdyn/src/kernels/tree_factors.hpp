// The factors of M = L^T D L by columns, as sweeps over subtrees write them, and the paths from degrees of freedom to the root.
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

/// The same but `dof` itself; its parent, which is often the last to be known, comes last.
template <class Use>
void alongPathParentLast(const CompactImpl& m, int dof, Use&& use) {
  const int parent = m.dof_parent[static_cast<std::size_t>(dof)];
  if (parent < 0) return;
  alongPath(m, m.dof_parent[static_cast<std::size_t>(parent)], use);
  use(parent);
}

template <class S>
struct TreeFactors {
  Rows<S> L;             ///< row j: column j of L, below the diagonal; kept as PathMatrix::below is
  S* inverse = nullptr;  ///< 1 / D
};

template <class S>
void carve(TreeFactors<S>& c, int n, Arena& arena) {
  arena.take(c.L, n, n);
  arena.take(c.inverse, static_cast<std::size_t>(n));
}

}  // namespace dyn::kernels
