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
  int end(int dof) const { return m.dof_end[static_cast<std::size_t>(dof)]; }
  int parent(int dof) const { return m.dof_parent[static_cast<std::size_t>(dof)]; }
  /// The first one of the same joint, and one past the last.
  int jointBegin(int dof) const { return joint(dof).idx_v; }
  int jointEnd(int dof) const { return joint(dof).idx_v + joint(dof).nv; }
  const BodyIndex& joint(int dof) const { return m.index[static_cast<std::size_t>(m.dof_body[static_cast<std::size_t>(dof)])]; }
};

/// One column, `column` of the matrix, in place, its first `rows` rows. order.goesUp(i), goesDown(i): told of each row that it comes to.
template <class S, class Order, class Begin>
void solveColumn(const TreeSystem<S>& t, const Order& order, const Begin& begin, int column, int rows, S* x) {
  alongPath(t.m, column, [&](int i) {
    if (begin(i) > column) return;
    order.goesUp(i);
    const S force = x[i];
    alongPath(t.m, t.parent(i), [&](int j) { x[j] -= t.L[j][i] * force; });
    x[i] = t.inverse[i] * force;
  });
  for (int i = 0; i < rows; ++i) {
    order.goesDown(i);
    S sum = x[i];
    alongPathParentLast(t.m, i, [&](int j) { sum -= t.L[j][i] * x[j]; });
    x[i] = sum;
  }
}

// Right-hand sides stand in rows, whose neighbours packs take together, or where a pack is one number of several states, in columns.

template <class S>
struct ByColumns {
  S* first = nullptr;
  std::ptrdiff_t stride = 0;
};
template <class S>
S* place(const Rows<S>& X, int row, std::ptrdiff_t column) {
  return X[row] + column;
}
template <class S>
S* place(const ByColumns<S>& X, int row, std::ptrdiff_t column) {
  return X.first + column * X.stride + row;
}
template <class S>
std::ptrdiff_t toNextRow(const Rows<S>& X) {
  return X.stride;
}
template <class S>
constexpr std::ptrdiff_t toNextRow(const ByColumns<S>&) {
  return 1;
}
/// From pack to pack of a row: of rows, what panels say.
template <class S, class Beside>
Beside toNextPack(const Rows<S>&, Beside beside) {
  return beside;
}
template <class S, class Beside>
std::ptrdiff_t toNextPack(const ByColumns<S>& X, Beside) {
  return X.stride;
}

/// Of rows, which have zeros where others have entries that are left alone.
inline constexpr auto wholeBlocks = [](int) { return 0; };

// Copies of the system: what packs are stored into might be anything, even the struct that says where.

/// X = D^-1 L^-T X of rows that are zero outside their subtrees. Of several matrices side by side, `apart` numbers from one to the next. Of what is
/// by columns, rows from endOf(column) on are left alone, be it the first of the column's joint or the one past its diagonal.
template <class Wide, int matrices = 1, class S, class Matrix, class End>
__attribute__((flatten)) void solveUpper(const TreeSystem<S> t, const Matrix X, std::ptrdiff_t apart, const End& endOf) {
  constexpr bool by_columns = std::is_same_v<Matrix, ByColumns<S>>;
  const auto solve = [&]<int rows, int packs>(int begin, std::ptrdiff_t first, auto beside) {
    const auto next = toNextPack(X, beside);
    Tile<Wide, S, rows, packs> own(place(X, begin, first), toNextRow(X), next);
#pragma GCC unroll 8
    for (int k = rows - 1; k > 0; --k)
#pragma GCC unroll 8
      for (int r = k - 1; r >= 0; --r) own.subtractRow(r, k, t.L[begin + r][begin + k]);
    alongPath(t.m, t.parent(begin), [&](int row) { own.subtractFrom(place(X, row, first), t.L[row] + begin, next); });
    own.scale(t.inverse + begin);
    own.store(place(X, begin, first), toNextRow(X), next);
  };
  for (auto chain = t.m.chains.rbegin(); chain != t.m.chains.rend(); ++chain)
    inBlocksBackward(chain->begin, chain->end, [&]<int rows>(std::integral_constant<int, rows>, int begin) {
      int first_whole = begin;
      if constexpr (by_columns)
        for (const int end = t.jointEnd(begin + rows - 1); first_whole < end; ++first_whole)
          withConstant<rows>(std::min(endOf(first_whole) - begin, rows),
                             [&](auto count) { solve.template operator()<count, 1>(begin, first_whole, 0); });
      inPanelsOf<Wide, S, packs_beside<Wide, rows>, matrices>(first_whole, t.end(begin), apart, [&](auto packs, std::ptrdiff_t first, auto beside) {
        solve.template operator()<rows, packs>(begin, first, beside);
      });
    });
}

/// X = L^-1 B of rows of `columns` numbers, or with the other sign; where `upper`, only what stands right of the diagonal, and packs' ends.
template <class Wide, bool minus = false, class S, class Matrix>
__attribute__((flatten)) void solveLower(const TreeSystem<S> t, const Matrix B, const Matrix X, int columns, bool upper) {
  constexpr std::ptrdiff_t width = Part<Wide, S>::width;
  for (const DofChain& chain : t.m.chains)
    inBlocks(chain.begin, chain.end, [&]<int rows>(std::integral_constant<int, rows>, int begin) {
      inPanels<Wide, S, packs_beside<Wide, rows>>(upper ? begin / width * width : 0, columns, [&](auto packs, int first) {
        const auto next = toNextPack(X, std::integral_constant<std::ptrdiff_t, width>());
        Tile<Wide, S, rows, packs> own(place(B, begin, first), toNextRow(B), next);
        if constexpr (minus) own.negate();
        alongPathParentLast(t.m, begin, [&](int row) { own.subtractOf(place(X, row, first), t.L[row] + begin, next); });
#pragma GCC unroll 8
        for (int k = 0; k < rows; ++k)
#pragma GCC unroll 8
          for (int r = k + 1; r < rows; ++r) own.subtractRow(r, k, t.L[begin + k][begin + r]);
        own.store(place(X, begin, first), toNextRow(X), next);
      });
    });
}

}  // namespace dyn::kernels
