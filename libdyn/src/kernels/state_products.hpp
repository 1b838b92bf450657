// Products with the factors of M^-1 = U^T D^-1 U of many states at once, a pack of states being a number: what has come up the tree goes down again.
#pragma once

#include "kernels/tile.hpp"
#include "kernels/tree_factors.hpp"

namespace dyn::kernels {

/// Columns that are written together: beside as many sums as are four numbers of each, a number of U and the columns' factors fit into registers.
template <class S>
constexpr int columns_abreast = sizeof(S) == 64 ? 6 : 3;

/// For so many columns and the path to the root of the last one's degree of freedom, root first: of each k there right(k, j) / D(k), and k.
template <class S>
struct ProductScratch {
  S* shares;
  int* path;

  void carve(const CompactImpl& m, Arena& arena) {
    arena.take(shares, static_cast<std::size_t>(columns_abreast<S> * m.path_room));
    arena.take(path, static_cast<std::size_t>(m.path_room));
  }
};

/// What columns from j on begin with, at row `first` and the next ones: zeros.
template <int columns, int rows, class S>
void beginWithZeros(S (&sum)[columns][rows]) {
#pragma GCC unroll 6
  for (int c = 0; c < columns; ++c)
#pragma GCC unroll 4
    for (int r = 0; r < rows; ++r) sum[c][r] = S(0);
}
/// The other sign of what `below` has: its row j for degree of freedom j's subtree, with that of its whole joint. Before those, rows have something
/// else's entries.
template <int columns, int rows, class S>
void beginWithMinus(const CompactImpl& m, const Rows<S>& below, int j, int first, S (&sum)[columns][rows]) {
  const auto beginOf = [&](int dof) { return m.index[static_cast<std::size_t>(m.dof_body[static_cast<std::size_t>(dof)])].idx_v; };
  if (first + rows <= beginOf(j) || first >= m.dof_end[static_cast<std::size_t>(j)]) return beginWithZeros(sum);
  const S* row = below[j] + first;
#pragma GCC unroll 6
  for (int c = 0; c < columns; ++c, row += below.stride) {
#pragma GCC unroll 4
    for (int r = 0; r < rows; ++r) sum[c][r] = -row[r];
  }
  if (first >= beginOf(j + columns - 1)) return;
#pragma GCC unroll 6
  for (int c = 0; c < columns; ++c) {
    const int begin = beginOf(j + c) - first;
#pragma GCC unroll 4
    for (int r = 0; r < rows; ++r)
      if (r < begin) sum[c][r] = S(0);
  }
}

/// Some columns of a product, from j on. `right` is zero left of its diagonal.
template <class S, int columns>
class StateColumns {
 public:
  [[gnu::flatten]] StateColumns(const CompactImpl& m, const TreeFactors<S> f, const ProductScratch<S>& scratch, const Rows<S> right, int j)
      : dof_end_(m.dof_end.data()),
        U_(f.U),
        path_(scratch.path),
        shares_(scratch.shares),
        length_(m.dof_depth[static_cast<std::size_t>(j)] + columns) {
    int* number = path_ + length_;
    S* share = shares_ + length_ * columns;
    alongPath(m, j + columns - 1, [&](int k) {
      *--number = k;
      share -= columns;
      const S* const factor = right[k] + j;
#pragma GCC unroll 6
      for (int c = 0; c < columns; ++c) share[c] = f.inverse[k] * factor[c];
    });
  }

  /// Rows from `first` on and before `end`: start(sum, first) says what they begin with.
  template <class Start>
  [[gnu::flatten]] void write(int first, int end, const Rows<S> out, const Start& start) {
    inPanels<S, S>(first, end, [&](auto rows, int at) { writePanel<rows>(at, out, start); });
  }

 private:
  template <int rows, class Start>
  void writePanel(int first, const Rows<S> out, const Start& start) {
    // Subtrees on the way contain one another: those with a part of the panel are the first ones.
    const auto reaches = [&](int t) { return path_[t] < first + rows && first < dof_end_[path_[t]]; };
    while (reaching_ < length_ && reaches(reaching_)) ++reaching_;
    while (reaching_ > 0 && !reaches(reaching_ - 1)) --reaching_;

    S sum[columns][rows];
    start(sum, first);
    const S* share = shares_;
    for (int t = 0; t < reaching_; ++t, share += columns) {
      const S* const U = U_[path_[t]] + first;
#pragma GCC unroll 4
      for (int r = 0; r < rows; ++r)
#pragma GCC unroll 6
        for (int c = 0; c < columns; ++c) sum[c][r] += share[c] * U[r];
    }
    S* to = out.first + first;
#pragma GCC unroll 6
    for (int c = 0; c < columns; ++c, to += out.stride)
#pragma GCC unroll 4
      for (int r = 0; r < rows; ++r) to[r] = sum[c][r];
  }

  const int* dof_end_;
  const Rows<S> U_;
  int* path_;
  S* shares_;
  int length_, reaching_ = 0;
};

/// Column j of a product, for each degree of freedom j: what start(sum, j, first) says, and with it, for each k whose subtree has both i and j,
/// U(k, i) / D(k) right(k, j) at i. Of `upper` columns only i >= j. put(j, count, write): some columns, which write(place) writes.
/// O(n^2 depth) at most.
template <bool upper, class S, class Start, class Put>
void downTheTree(const CompactImpl& m, const TreeFactors<S>& f, const ProductScratch<S>& scratch, const Rows<S>& right, const Start& start,
                 Put&& put) {
  for (const DofChain& chain : m.chains)
    inBlocks<columns_abreast<S>>(chain.begin, chain.end, [&]<int columns>(std::integral_constant<int, columns>, int j) {
      StateColumns<S, columns> block(m, f, scratch, right, j);
      put(j, columns, [&](const Rows<S>& out) { block.write(upper ? j : 0, m.nvx, out, [&](auto& sum, int first) { start(sum, j, first); }); });
    });
}

}  // namespace dyn::kernels
