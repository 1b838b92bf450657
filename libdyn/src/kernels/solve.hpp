// Solving with the factors M = L^T D L for the columns of an n x n matrix, of which each has entries for its own degree of freedom's path
// and subtree: L^T from the leaves, D, then L from the root, which fills the matrix.
#pragma once

#include "kernels/tile.hpp"
#include "kernels/tree_factors.hpp"

namespace dyn::kernels {

/// `begin(i)`: of row i, columns from there to the end of i's subtree have entries that L^T and D are still to be solved for; the row's
/// other entries are solved for already.
template <class S>
struct TreeSystem {
  const CompactImpl& m;
  Rows<S> L;
  const S* inverse;
  int n() const { return m.nvx; }
  int end(int dof) const { return m.dof_end[static_cast<std::size_t>(dof)]; }
  int parent(int dof) const { return m.dof_parent[static_cast<std::size_t>(dof)]; }
  /// One past the last one of the same joint.
  int jointEnd(int dof) const {
    const BodyIndex& x = m.index[static_cast<std::size_t>(m.dof_body[static_cast<std::size_t>(dof)])];
    return x.idx_v + x.nv;
  }
};

/// One column, `column` of the matrix, in place, its first `rows` rows.
template <class S, class Begin>
void solveColumn(const TreeSystem<S>& t, const Begin& begin, int column, int rows, S* x) {
  alongPath(t.m, column, [&](int i) {
    if (begin(i) > column) return;
    const S force = x[i];
    alongPath(t.m, t.parent(i), [&](int j) { x[j] -= t.L[j][i] * force; });
    x[i] = t.inverse[i] * force;
  });
  for (int i = 0; i < rows; ++i) {
    S sum = x[i];
    alongPathParentLast(t.m, i, [&](int j) { sum -= t.L[j][i] * x[j]; });
    x[i] = sum;
  }
}

// Copies of the system: what packs are stored into might be anything, even the struct that says where.

/// X = D^-1 L^-T X of rows that are zero outside their subtrees.
template <class Wide, class S>
__attribute__((flatten)) void solveUpper(const TreeSystem<S> t, const Rows<S> X) {
  for (auto chain = t.m.chains.rbegin(); chain != t.m.chains.rend(); ++chain)
    inBlocksBackward(chain->begin, chain->end, [&]<int rows>(std::integral_constant<int, rows>, int begin) {
      inPanels<Wide, S, packs_beside<Wide, rows>>(begin, t.end(begin), [&](auto packs, int first) {
        Tile<Wide, S, rows, packs> own(X[begin] + first, X.stride);
#pragma GCC unroll 8
        for (int k = rows - 1; k > 0; --k)
#pragma GCC unroll 8
          for (int r = k - 1; r >= 0; --r) own.subtractRow(r, k, t.L[begin + r][begin + k]);
        alongPath(t.m, t.parent(begin), [&](int row) { own.subtractFrom(X[row] + first, t.L[row] + begin); });
        own.scale(t.inverse + begin);
        own.store(X[begin] + first, X.stride);
      });
    });
}

/// X = L^-1 X; where `upper`, only what stands right of the diagonal, and packs' ends.
template <class Wide, class S>
__attribute__((flatten)) void solveLower(const TreeSystem<S> t, const Rows<S> X, bool upper) {
  constexpr int width = Part<Wide, S>::width;
  for (const DofChain& chain : t.m.chains)
    inBlocks(chain.begin, chain.end, [&]<int rows>(std::integral_constant<int, rows>, int begin) {
      inPanels<Wide, S, packs_beside<Wide, rows>>(upper ? begin / width * width : 0, t.n(), [&](auto packs, int first) {
        Tile<Wide, S, rows, packs> own(X[begin] + first, X.stride);
        alongPathParentLast(t.m, begin, [&](int row) { own.subtractOf(X[row] + first, t.L[row] + begin); });
#pragma GCC unroll 8
        for (int k = 0; k < rows; ++k)
#pragma GCC unroll 8
          for (int r = k + 1; r < rows; ++r) own.subtractRow(r, k, t.L[begin + k][begin + r]);
        own.store(X[begin] + first, X.stride);
      });
    });
}

}  // namespace dyn::kernels
