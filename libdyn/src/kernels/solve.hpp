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

/// X = D^-1 L^-T X of rows that are zero outside their subtrees.
template <class Wide, class S>
__attribute__((flatten)) void solveUpper(const TreeSystem<S> t, const Rows<S> X) {
  constexpr int width = Part<Wide, S>::width;
  const std::ptrdiff_t stride = X.stride;
  for (auto chain = t.m.chains.rbegin(); chain != t.m.chains.rend(); ++chain) {
    const int begin = chain->begin, end = chain->end;
    inPanels<Wide, S>(begin, t.end(begin), [&](auto packs, int first) {
      const auto subtract = [&]<int rows>(std::integral_constant<int, rows>, int row, bool own) {
        Tile<Wide, S, rows, packs> tile(X[row] + first, stride);
        const int from = own ? row + rows : begin;
        tile.subtract(X[from] + first, stride, end - from, t.L[row] + from, t.L.stride, 1);
        if (own)
          for (int k = rows - 1; k > 0; --k)
            for (int r = k - 1; r >= 0; --r) tile.subtractRow(r, k, t.L[row + r][row + k]);
        tile.store(X[row] + first, stride);
      };
      // Rows before `last` down to `row`, by twos.
      const auto subtractDown = [&](int last, int row, bool own) {
        for (; last - row >= 2; last -= 2) subtract(std::integral_constant<int, 2>(), last - 2, own);
        if (last > row) subtract(std::integral_constant<int, 1>(), row, own);
      };
      subtractDown(end, begin, true);
      for (int last = t.parent(begin); last >= 0;) {
        const int segment = t.m.dof_segment[static_cast<std::size_t>(last)];
        subtractDown(last + 1, segment, false);
        last = t.parent(segment);
      }
      for (int i = begin; i < end; ++i)
        for (int p = 0; p < packs; ++p) {
          S* x = X[i] + first + p * width;
          storePack(Wide(t.inverse[i]) * loadPack<Wide>(x), x);
        }
    });
  }
}

/// X = L^-1 X; where `upper`, only what stands right of the diagonal, and packs' ends.
template <class Wide, class S>
__attribute__((flatten)) void solveLower(const TreeSystem<S> t, const Rows<S> X, bool upper) {
  const std::ptrdiff_t stride = X.stride;
  inPanels<Wide, S>(0, t.n(), [&](auto packs, int first) {
    const int rows_end = upper ? std::min(t.n(), first + packs * Part<Wide, S>::width) : t.n();
    const auto solve = [&]<int rows>(std::integral_constant<int, rows>, const DofChain& chain, int row) {
      Tile<Wide, S, rows, packs> tile(X[row] + first, stride);
      for (int last = row - 1 >= chain.begin ? row - 1 : t.parent(chain.begin); last >= 0;) {
        const int segment = t.m.dof_segment[static_cast<std::size_t>(last)];
        tile.subtract(X[segment] + first, stride, last + 1 - segment, t.L[segment] + row, 1, t.L.stride);
        last = t.parent(segment);
      }
      for (int k = 0; k < rows; ++k)
        for (int r = k + 1; r < rows; ++r) tile.subtractRow(r, k, t.L[row + k][row + r]);
      tile.store(X[row] + first, stride);
    };
    for (const DofChain& chain : t.m.chains)
      byTwos(chain.begin, std::min(chain.end, rows_end), [&](int row, auto count) { solve(count, chain, row); });
  });
}

}  // namespace dyn::kernels
